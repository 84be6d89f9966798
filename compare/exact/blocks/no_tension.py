"""The chain of rigid blocks with tension-free joints, from event to event.

The equations of `chain`, exact between the openings and closings of its joints and these found as
roots (`events`); it shares no code with the engines' joint laws. The effect of round-off is
measured: a second solution is perturbed at every step by NOISE units of round-off, and the
difference of the two bounds the error (`linear`). Rattling of blocks is chaotic: the solution is
unknown from the time on at which the two differ by PARTED of the motion (`known_until`).

Valid for any load or shaken base, soft layers, dashpots, mass-proportional damping, ends, gravity
along the axis and prestress, if no tension-free joint would be pulled at rest.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.blocks.chain import Chain, chain, contact_forces, receivers, split
from jointwave.compare.exact.blocks.events import ChainMotion, integrate
from jointwave.compare.exact.blocks.lattice import HELD, at_rest
from jointwave.compare.exact.conditions import drive, holds
from jointwave.compare.exact.linear import errors
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset, scene_hash

MOST_BLOCKS = 2000
MANY = f"more than {MOST_BLOCKS:,} blocks: too many events"
NOISE = 1024.0
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
    if answer and _pulled(scene):
        return Answer("a no-tension joint is in tension at rest")
    return answer


def _pulled(scene: Scene) -> bool:
    """Return whether the static state without a load opens a tension-free joint."""
    model = chain(scene)
    elastic = replace(model, tension=np.ones_like(model.tension))
    forces, _ = contact_forces(elastic, at_rest(scene, model))
    return bool((forces[1:-1][~model.tension] < 0).any())


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement of the scene's rigid-block chain."""
    model, signal, times = chain(scene), drive(scene), sample_times(scene)
    rest, driven = at_rest(scene, model), signal.value(times) * model.gain
    own, other = _motions(scene)
    found, twin = (
        [field.T for field in receivers(scene, model, rest + m.states, driven)]
        for m in (own, other)
    )
    known = _known(model, own.states, other.states)
    bounds = errors([x[:, :known] for x in found], [x[:, :known] for x in twin])
    until: dict[str, Any] = {} if known == len(times) else {"known_until": float(times[known - 1])}
    return dataset(
        scene,
        SOLVER.name,
        times,
        *found,
        errors=bounds,
        events=own.events,
        **until,
    )


def _motions(scene: Scene) -> list[ChainMotion]:
    """Return the chain's motion and the perturbed one, as long as none of another chain is asked
    for: they are the same wherever the receivers are."""
    record = scene.record.model_copy(update={"stress": [], "velocity": [], "fields": None})
    key = scene_hash(scene.model_copy(update={"record": record}))
    if key not in _last:
        model, signal, times = chain(scene), drive(scene), sample_times(scene)
        rest, period = at_rest(scene, model), scene.load.time_scale
        _last.clear()
        _last[key] = [
            integrate(model, signal, times, rest, period, noise) for noise in (0.0, NOISE)
        ]
    return _last[key]


_last: dict[str, list[ChainMotion]] = {}


def _known(model: Chain, states: np.ndarray, other: np.ndarray) -> int:
    """Return the number of samples before two solutions [n, size] diverge."""

    def motion(x: np.ndarray) -> np.ndarray:
        u, v, _ = split(model, x)
        return np.concatenate([model.rate * np.diff(u, axis=1), v], axis=1)

    apart = np.linalg.norm(motion(other - states), axis=1)
    lost = apart > PARTED * np.linalg.norm(motion(states), axis=1).max()
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
