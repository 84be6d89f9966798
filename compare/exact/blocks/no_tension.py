"""The chain of rigid blocks with tension-free joints, from event to event.

The equations of `system`, exact between the openings and closings of its joints and these found as
roots (`events`); it shares no code with the engines' joint laws. The effect of round-off is
measured: a second solution is perturbed at every step by NOISE units of round-off, and the
difference of the two bounds the error (`linear`). Rattling of blocks is chaotic: the solution is
unknown from the time on at which the two differ by PARTED of the motion (`known_until`).

Valid for any load or shaken base, soft layers, dashpots, mass-proportional damping, ends, gravity
along the axis and prestress, if no tension-free joint would be pulled at rest.
"""

import numpy as np
import xarray as xr

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.blocks.events import NOISE, Motion, integrate
from jointwave.compare.exact.blocks.row_of_blocks import HELD, receivers, result, system_of
from jointwave.compare.exact.blocks.system import BlockSystem
from jointwave.compare.exact.conditions import drive, holds
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.dataset import scene_hash

MOST_BLOCKS = 2000
MANY = f"more than {MOST_BLOCKS:,} blocks: too many events"
PARTED = 1e-6


def applies(scene: Scene) -> Answer:
    """Return whether the chain has a tension-free joint and is not too long."""
    carried = bool(calibrate(scene).tension.all())
    answer = holds(
        scene,
        (*HELD, "no tension"),
        (carried, "every joint carries tension: see lattice"),
        (scene.block_count > MOST_BLOCKS, MANY),
    )
    if answer and (one := system_of(scene)).initial[one.one_sided].min() < 0:
        return Answer("a no-tension joint is in tension at rest")
    return answer


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement of the scene's rigid-block chain."""
    model, times = system_of(scene), sample_times(scene)
    own, other = _motions(scene)
    found, twin = (receivers(scene, model, one.states) for one in (own, other))
    known = _known(model, own.states, other.states)
    until = {"known_until": float(times[known - 1])} if known < len(times) else {}
    return result(scene, SOLVER.name, found, twin, known, events=own.events, **until)


def _motions(scene: Scene) -> list[Motion]:
    """Return the chain's motion and the perturbed one, as long as none of another chain is asked
    for: they are the same wherever the receivers are."""
    record = scene.record.model_copy(update={"stress": [], "velocity": [], "fields": None})
    key = scene_hash(scene.model_copy(update={"record": record}))
    if key not in _last:
        model, signal, times = system_of(scene), drive(scene), sample_times(scene)
        period = scene.load.time_scale
        _last.clear()
        _last[key] = [integrate(model, signal, times, period, noise) for noise in (0.0, NOISE)]
    return _last[key]


_last: dict[str, list[Motion]] = {}


def _known(model: BlockSystem, states: np.ndarray, other: np.ndarray) -> int:
    """Return the number of samples before two solutions [n, m] diverge."""
    rate = model.matrix[0, len(model.rest)]  # of scaled displacements per velocity, rad/s

    def size(x: np.ndarray) -> np.ndarray:
        strained = rate * np.diff(x @ model.displacement.T, axis=1)
        return np.linalg.norm(np.concatenate([strained, x @ model.velocity.T], axis=1), axis=1)

    lost = size(other - states) > PARTED * size(states).max()
    return max(1, int(np.argmax(lost))) if lost.any() else len(states)


SOLVER = Solver(
    name="no-tension-chain",
    rock=Rock.RIGID_BLOCKS,
    label="no-tension chain, exact",
    line=thin("#00349a", 9, (0, 9)),
    applies=applies,
    run=solve,
    distances={Kind.NUMERICAL: {"dem": "time stepping of the rigid blocks that open and close"}},
)
