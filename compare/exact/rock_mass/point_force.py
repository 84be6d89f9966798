"""Scenes of forces at points of rock without joints (`plane.point_force`); line forces in the
plane.

Valid for continuous forces, in undamped rock without joints and openings, with any conditions at
the sides: the rock acts as unbounded up to `known_until`, when the first P wave reflected from a
side reaches a receiver.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.histories import Gabor, LoadHistory, Recorded, Ricker, Sine, Step
from jointwave.cases.loads import history_of
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.exact.plane.point_force import motion
from jointwave.compare.exact.plane.waves import PlaneMotion
from jointwave.compare.exact.rock_mass.conditions import holds, prestress_of
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

#: Pieces of a Ricker wavelet, each smooth enough for the points of one quadrature.
PARTS = 8
IN_PLANE = "is for a rock mass in space, not for one in the plane"


def applies(scene: RockMass) -> Answer:
    """Return whether only forces act, on rock without joints, and arrive before any echo."""
    answer = holds(
        scene,
        ("no waves", "loads", "openings", "prestress"),
        (bool(scene.joint_sets), "there are joints"),
        (not scene.loads, "no force acts"),
        (any(one.kind != "force" for one in scene.loads), "a load other than a force acts"),
        (bool(shape_of(scene.domain).solids), "the domain is not convex, or has openings"),
        (bool(scene.boundaries.sides("periodic")), "a side is periodic"),
        (not scene.record.points, "no point is recorded"),
    )
    if not answer:
        return answer
    points, jumps = scene.places["points"], any(_jumps(one) for one in _histories(scene))
    reach = min(np.linalg.norm(points - one.at, axis=1).min() for one in scene.loads)
    late = known_until(scene) <= reach / float(elastic_rock(scene.rock).p_speed)
    return Answer.unless(
        (jumps, "a force jumps, so that velocities at its arrivals are unbounded"),
        (not reach > 0, "a receiver lies on a force"),
        (late, "a side reflects before any receiver is reached"),
    )


def solve(scene: RockMass) -> xr.Dataset:
    """Return velocity, displacement and stress at the points of a scene."""
    rock, times = elastic_rock(scene.rock), sample_times(scene)
    points, total = scene.places["points"], []
    for load, history in zip(scene.loads, _histories(scene), strict=True):
        assert isinstance(history, Sine | Ricker | Gabor | Recorded)
        offsets, breaks = points - np.array(load.at), _breaks(history)
        direction = np.array(load.direction)
        total.append(motion(rock, direction, history.value, history.rate, breaks, offsets, times))
    found = PlaneMotion(*(np.sum(parts, axis=0) for parts in zip(*total, strict=True)))
    values = {
        "velocity": found.velocity.swapaxes(1, 2),
        "displacement": found.displacement.swapaxes(1, 2),
        "stress": prestress_of(scene) - found.stress.swapaxes(1, 2),
    }
    errors = {name: getattr(found, f"{name}_error") for name in values}
    known = known_until(scene)
    until: dict[str, Any] = {"known_until": known} if known < times[-1] else {}
    name = (POINT if scene.in_space else LINE).name
    return dataset(scene, name, times, values, errors=errors, **until)


def known_until(scene: RockMass) -> float:
    """Return the earliest arrival of a side's reflection at a receiver, from mirror images, s."""
    shape, points, first = shape_of(scene.domain), scene.places["points"], np.inf
    for corners, normal in (face for side in shape.normals() for face in shape.faces_of(side)):
        for load in scene.loads:
            at = np.array(load.at)
            image = at + 2 * ((corners[0] - at) @ normal) * normal
            first = min(first, np.linalg.norm(points - image, axis=1).min())
    return float(first / elastic_rock(scene.rock).p_speed)


def _histories(scene: RockMass) -> list[LoadHistory]:
    return [history_of(one, one.amplitude) for one in scene.loads]


def _jumps(history: LoadHistory) -> bool:
    recorded = isinstance(history, Recorded) and bool(history.stress[[0, -1]].any())
    return recorded or isinstance(history, Step)


def _breaks(history: Sine | Ricker | Gabor | Recorded) -> list[float]:
    """Return times between which a history is smooth, at most half a cycle apart."""
    if isinstance(history, Recorded):
        return history.breaks
    if isinstance(history, Sine):
        return [*np.linspace(0, history.end, round(2 * history.cycles) + 1)]
    parts = round(PARTS * history.end / (3 * history.period))
    return [*np.linspace(0, history.end, parts + 1), np.inf]


LINE = Solver(
    name="line-force",
    rock=Rock.JOINTED,
    kinds=("rock mass",),
    dimension=2,
    label="line force, exact",
    line=thin("#a83200", 8, (4.5, 8.5)),
    applies=applies,
    run=solve,
    distances={
        Kind.NUMERICAL: {"continuum-jointed": "elements and time stepping of the rock"},
        Kind.MODELLING: {"dem": "rigid instead of deformable blocks"},
    },
)
POINT = replace(
    LINE,
    name="point-force",
    in_space=True,
    label="point force, exact",
    applies=lambda scene: applies(scene) if scene.in_space else Answer(IN_PLANE),
)
