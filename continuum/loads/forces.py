"""Forces on a body: gravity, pressures, point forces, compliant bases, excavations, and waves that
enter through quiet sides."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.histories import LoadHistory
from jointwave.cases.incident import FaceTractions, FreeField, IncidentField, free_field, tractions
from jointwave.cases.loads import load_history, step_means, velocity_of
from jointwave.cases.material.quiet_sides import base_traction
from jointwave.cases.partition.shape import BESIDE, loaded_lines, shape_of
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import PlaneLoad, shortest_period
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.loads.ends import end_force
from jointwave.continuum.loads.sides import facets_on, impedances_of, inside
from jointwave.continuum.receivers.points import motion_at, pieces_of, shares_of_pieces
from jointwave.continuum.space.evaluation import matrix_of, places_in
from jointwave.continuum.space.model import Body, Facets, directions, forces_on

IN_A_PERIOD = 100  # samples of a field that is not evaluated at every step
AT_ONCE = 500_000  # numbers: forces that are in memory at a time for their impulse
GAUSS = 6  # points between two nodes: exact for elements of the highest order


class Push(NamedTuple):
    """A load: share [freedoms] times the mean of its history over a step, N."""

    share: np.ndarray
    history: LoadHistory


def pull_of(scene: AnyScene, body: Body) -> np.ndarray:
    """Return the acceleration of gravity of every freedom, m/s2."""
    assert scene.gravity is not None
    pull = np.array(scene.gravity.direction, dtype=float) * scene.gravity.acceleration
    return np.tile(pull[directions(body)], len(body.x))


def weight_of(scene: AnyScene, body: Body) -> np.ndarray | None:
    """Return the weight on every freedom, N; None without gravity."""
    if scene.gravity is None:
        return None
    return body.mass * pull_of(scene, body)


def released(scene: AnyScene, body: Body) -> np.ndarray | None:
    """Return the force on every freedom by which walls of openings lose the prestress that what is
    excavated bore there, N; None where nothing is."""
    if not scene.excavated:
        return None
    assert scene.prestress is not None
    walls = facets_on(body, [name for name in body.sides if name.startswith("opening")])
    return forces_on(body, walls, walls.normal @ scene.prestress.tensor)


def pushes(scene: AnyScene, body: Body) -> list[Push]:
    """Return the loads of a scene that are forces."""
    if scene.is_column:
        return [Push(end_force(scene, body, one), load_history(scene)) for one in scene.pushes]
    of_kind = {"pressure": _pressure, "force": _force, "base": _base}
    return [
        Push(of_kind[one.kind](scene, body, one), velocity_of(one, one.amplitude))
        for one in scene.pushes
    ]


def _base(scene: RockMass, body: Body, load: PlaneLoad) -> np.ndarray:
    """Return the force on a compliant base for each m/s that comes up."""
    assert load.side is not None and load.direction is not None
    facets = facets_on(body, [load.side])
    impedance = impedances_of(scene, body, facets)
    return forces_on(body, facets, base_traction(impedance, load.direction))


def _force(scene: RockMass, body: Body, load: PlaneLoad) -> np.ndarray:
    """Return a force of 1 N at a point, on the sides of a joint there alike."""
    assert load.at is not None and load.direction is not None
    here = places_in(body, np.array([load.at]))
    share = shares_of_pieces(here.point, pieces_of(body)[here.cell])
    return motion_at(body, here, share, 1).T @ np.array(load.direction)


def _pressure(scene: RockMass, body: Body, load: PlaneLoad) -> np.ndarray:
    """Return a pressure of 1 Pa on a side or in an opening, or on a part of it."""
    facets = facets_on(body, [load.side or f"opening {load.opening}"])
    if load.between is None:
        return forces_on(body, facets, -facets.normal)
    parts = [_on_line(body, facets, *line) for line in loaded_lines(shape_of(scene.domain), load)]
    return np.sum(parts, axis=0)


def _on_line(body: Body, facets: Facets, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return a pressure of 1 Pa on a straight part of the boundary in the plane: by Gauss points
    between the nodes there."""
    start, end = sorted((start, end), key=tuple)  # from either end to the last bit
    length = float(np.linalg.norm(end - start))
    along = (end - start) / length
    s = (facets.place - start) @ along
    off = np.linalg.norm(facets.place - start - s[:, None] * along, axis=1)
    level = np.abs(facets.normal @ along) < BESIDE
    on = (off < BESIDE * length) & level
    breaks = np.unique(np.append(s[on & (s > 0) & (s < length)], [0.0, length]))
    at, weight = np.polynomial.legendre.leggauss(GAUSS)
    half = np.diff(breaks)[:, None] / 2
    place = (breaks[:-1, None] + half * (1 + at)).ravel()
    here = places_in(body, start + place[:, None] * along)
    normal = facets.normal[on].mean(axis=0)
    pushed = -(half * weight).ravel() / np.bincount(here.point)
    weights = (pushed[here.point, None] * here.basis)[:, None, :, None] * normal
    row = np.zeros(len(here.point), np.int64)
    return matrix_of(body, row, here.cell, weights, 1).toarray()[0]


class Loads:
    """All forces that are known before a run.

    Attributes
    ----------
    freedom : int array [k], on which any acts.
    """

    def __init__(self, size: int, dt: float, pushes: list[Push], waves: "Waves | None") -> None:
        shares = np.array([push.share for push in pushes]).reshape(len(pushes), size)
        acts = (shares != 0).any(axis=0)
        if waves is not None:
            acts[waves.freedom] = True
        self.freedom, self.dt, self.waves = np.flatnonzero(acts), dt, waves
        self.pushes = [push._replace(share=push.share[self.freedom]) for push in pushes]
        if waves is not None:
            place = np.searchsorted(self.freedom, waves.freedom)
            entries = np.arange(len(place)), place
            shape = len(place), len(self.freedom)
            self._onto = csr_matrix((np.ones(len(place)), entries), shape)

    def at(self, first: int, last: int, stride: int = 1) -> np.ndarray:
        """Return the forces of steps first .. last - 1, one in `stride`, [steps, k], N."""
        steps = np.arange(first, last, stride)
        found = np.zeros((steps.size, self.freedom.size))
        for push in self.pushes:
            mean = step_means(push.history, self.dt, steps.size, first, stride)
            found += mean[:, None] * push.share
        if self.waves is not None and steps.size:
            found += self.waves.at(self.dt * steps) @ self._onto
        return found

    def impulse(self, mass: np.ndarray, steps: int, stride: int) -> float:
        """Return about the integral of |F| over all steps in the norm of 1 / m, sqrt(J): of one
        step in `stride`."""
        felt, own = 0.0, mass[self.freedom]
        many = stride * max(1, AT_ONCE // max(1, own.size))
        for first in range(0, steps, many):
            force = self.at(first, min(first + many, steps), stride)
            felt += float(np.sqrt((force**2 / own).sum(axis=1)).sum())
        return self.dt * stride * felt


class Waves:
    """Waves that enter through quiet sides.

    Attributes
    ----------
    freedom : int array [points * d].
    """

    def __init__(self, scene: RockMass, body: Body, field: IncidentField) -> None:
        self.facets = facets_on(body, scene.boundaries.sides("quiet"))
        self.field, self.places = field, inside(body, self.facets)
        self.impedance = impedances_of(scene, body, self.facets)
        self.freedom = (
            body.components * self.facets.node[:, None] + np.arange(body.components)
        ).ravel()
        self.sampled: FaceTractions | None = None
        if not isinstance(field, FreeField):
            period = shortest_period(scene.waves) or scene.time.duration
            apart = min(scene.interval, period / IN_A_PERIOD)
            times = apart * np.arange(int(np.ceil(scene.time.duration / apart)) + 8)
            self.sampled = self._tractions(times)

    def _tractions(self, times: np.ndarray) -> FaceTractions:
        return tractions(self.field, self.places, self.facets.normal, self.impedance, times)

    def at(self, times: np.ndarray) -> np.ndarray:
        """Return the forces at equally spaced times [n, points * d], N."""
        found = self._tractions(times).values if self.sampled is None else self.sampled.at(times)
        return (self.facets.weight[:, None] * found).reshape(len(times), -1)


def waves_of(scene: AnyScene, body: Body, incident: IncidentField | None) -> Waves | None:
    """Return the waves of a scene; incident : their field, in intact rock where absent."""
    if not scene.waves or not scene.boundaries.sides("quiet"):
        return None
    return Waves(scene, body, incident or free_field(scene))
