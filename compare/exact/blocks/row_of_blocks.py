"""Rows of rigid blocks, exact in time: the equations of the rigid-block engine.

A pillar's blocks (`pillar`) move in one dimension, or in three if they move across its axis or
rotate.

Without dashpots and with free ends the axial modes are omega_n = 2 sqrt(k/m) sin(n pi / 2N) with
shape cos(n pi (j - 1/2) / N), j = 1..N; Kelvin-Voigt dashpots are proportional and damp each mode
at the rate eta omega_n^2 / 2 (Brillouin, Wave Propagation in Periodic Structures, 1946).

Linear rows are solved by matrix exponentials (`linear`), chains with no-tension joints from event
to event (`events`). The only error is round-off, bounded by the difference from a twin that is
perturbed at every step. Rattling of blocks is chaotic: such a chain is known only up to
`known_until`, when the two differ by PARTED of the motion.

Valid for loads of any direction, eccentricity or couple, shaken bases, soft layers, segments,
dashpots, mass-proportional damping, any ends, gravity and prestress; no joint slips or softens, and
no-tension joints belong to a chain and are not in tension at rest.
"""

from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.histories import Step
from jointwave.cases.loads import late_load, with_walls
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.blocks.events import NOISE, integrate
from jointwave.compare.exact.blocks.pillar import own_freedoms, system_of
from jointwave.compare.exact.blocks.system import BlockSystem
from jointwave.compare.exact.conditions import DAMPED, LAYERS, holds
from jointwave.compare.exact.linear import bound, twins
from jointwave.compare.solvers.record import Answer, Kind, Line, Rock, Solver, thin
from jointwave.results.dataset import dataset

Waves = dict[str, np.ndarray]
DENSE, EVENTS = "the matrix exponential is dense", "too many events"
PARTED = 1e-6
HELD = (
    "reversed load",
    "segments",
    "scatter",
    "gravity",
    "prestress",
    "mass damping",
    "fixed start",
    *DAMPED,
    *LAYERS,
)


def applies(scene: Scene) -> Answer:
    """Return whether the scene's chain of rigid blocks is linear and not too long."""
    return holds(scene, HELD, _too_many(scene, 2000, DENSE))


def applies_without_tension(scene: Scene) -> Answer:
    """Return whether the chain has a no-tension joint and is not too long."""
    carried = bool(calibrate(scene).tension.all()), "every joint carries tension: see lattice"
    answer = holds(scene, (*HELD, "no tension"), carried, _too_many(scene, 2000, EVENTS))
    if answer and (one := system_of(scene)).initial[one.one_sided].min() < 0:
        return Answer("a no-tension joint is in tension at rest")
    return answer


def applies_in_space(scene: Scene) -> Answer:
    """Return whether the scene's row of blocks is spatial, linear and not too long."""
    p = calibrate(scene)
    if not scene.is_spatial:
        return Answer("the motion is axial: see lattice")
    return holds(
        scene,
        ("spatial motion", *HELD),
        (p.friction is not None or p.cohesion is not None, "a joint can slip"),
        (scene.motion.rotation == "finite", "rotations are finite"),
        _too_many(scene, 500, DENSE),
    )


def _too_many(scene: Scene, most: int, why: str) -> tuple[bool, str]:
    return scene.block_count > most, f"more than {most:,} blocks: {why}"


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement of the scene's row of blocks; in space also shear
    and rotation: responses to drive and sudden gravity, plus the initial state."""
    one, times = system_of(scene), sample_times(scene)
    about: dict[str, Any] = {}
    name, known = (IN_SPACE if scene.is_spatial else AXIAL).name, len(times)
    if len(one.one_sided):
        of = one, late_load(scene), times, scene.load.time_scale
        motions = [integrate(*of, noise) for noise in (0.0, NOISE)]
        states = [motion.states for motion in motions]
        name, known, about["events"] = NO_TENSION.name, _known(one, *states), motions[0].events
    else:
        driven = twins(one.matrix, one.load, late_load(scene), times)
        states = [*(driven + twins(one.matrix, one.steady, Step(1.0), times))]
    if known < len(times):
        about["known_until"] = float(times[known - 1])
    found, twin = (receivers(scene, one, x) for x in states)
    errors = {key: bound(x[..., :known], twin[key][..., :known]) for key, x in found.items()}
    waves = {key: x if x.ndim == 2 else x.swapaxes(1, 2) for key, x in found.items()}
    return dataset(scene, name, times, with_walls(waves, scene, times), errors=errors, **about)


def _known(one: BlockSystem, states: np.ndarray, other: np.ndarray) -> int:
    """Return the number of samples before two solutions [n, m] diverge."""
    rate = one.matrix[0, len(one.rest)]  # rate of scaled displacement per scaled velocity, rad/s

    def size(x: np.ndarray) -> np.ndarray:
        strained = rate * np.diff(x @ one.displacement.T, axis=1)
        return np.linalg.norm(np.concatenate([strained, x @ one.velocity.T], axis=1), axis=1)

    lost = size(other - states) > PARTED * size(states).max()
    return max(1, int(np.argmax(lost))) if lost.any() else len(states)


def contact_forces(
    one: BlockSystem, states: np.ndarray, drive: np.ndarray | float = 0.0
) -> np.ndarray:
    """Return contact forces [..., k] in states [..., m] under a drive [...], N and N m, compression
    positive."""
    strains, count, own = states @ one.strains.T, len(one.initial), one.one_sided
    forces = strains @ one.resists.T + np.multiply.outer(drive, one.direct) + one.initial
    springs = strains[..., :count] @ one.resists[own, :count].T + one.initial[own]
    forces[..., own] = np.where(springs < 0, 0.0, np.maximum(forces[..., own], 0.0))
    return forces


def receivers(scene: Scene, one: BlockSystem, states: np.ndarray) -> Waves:
    """Return stress (Pa), velocity (m/s) and displacement (m) [receivers, n] of a row in states [n,
    m]; in space each along the axes [receivers, 3, n], with shear and rotation (rad).

    Stress is interpolated between the start, the contacts and the end; velocity and displacement
    between the block centres, and constant beyond the outermost.
    """
    (sections, points), c = reads(scene), len(own_freedoms(scene))
    forces = contact_forces(one, states, late_load(scene).value(sample_times(scene)))
    forces, rate, moved = (
        (matrix @ x.reshape(len(x), -1, c)[:, : matrix.shape[1]]).transpose(1, 2, 0)
        for matrix, x in (
            (sections, forces),
            (points, states @ one.velocity.T),
            (points, states @ one.displacement.T + one.rest),
        )
    )
    if c == 1:
        return {"stress": forces[:, 0], "velocity": rate[:, 0], "displacement": moved[:, 0]}
    turned = moved[:, 3:] if c == 6 else 0 * moved
    along = {"velocity": rate[:, :3], "displacement": moved[:, :3], "rotation": turned}
    return {"stress": forces[:, 1], "shear": forces[:, [0, 2]], **along}


def reads(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return the interpolation matrices from contact forces to tractions in sections [s, N + 1],
    and from block motion to motion of points [p, N]."""
    p, record = calibrate(scene), scene.record
    sections, points = (
        np.stack([np.interp(places, nodes, one) for one in np.eye(len(nodes))], axis=1)
        for nodes, places in ((p.contact_y, record.stress), (p.centre_y, record.velocity))
    )
    return sections / p.area, points


def _solver(name: str, label: str, line: Line, does: str, **about: Any) -> Solver:
    distances = {Kind.NUMERICAL: {"dem": f"time stepping of the rigid blocks{does}"}}
    return Solver(name, Rock.RIGID_BLOCKS, label, line, run=solve, distances=distances, **about)


AXIAL = _solver("lattice", "rigid blocks, exact", thin("#00349a", 9, (0, 4)), "", applies=applies)
NO_TENSION = _solver(
    "no-tension-chain",
    "no-tension chain, exact",
    thin("#00349a", 9, (0, 9)),
    " that open and close",
    applies=applies_without_tension,
)
IN_SPACE = _solver(
    "spatial-lattice",
    "blocks in space, exact",
    thin("#00349a", 9, (0, 9)),
    " in space",
    applies=applies_in_space,
    dimension=3,
)
