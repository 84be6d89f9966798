"""Forces on a body: gravity, pressures, point forces, compliant bases, excavations, waves."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import ufl
from scipy.sparse import csr_matrix

from jointwave.cases.histories import LoadHistory
from jointwave.cases.incident import FaceTractions, FreeField, IncidentField, free_field, tractions
from jointwave.cases.loads import late_load, step_means, velocity_of
from jointwave.cases.material.quiet_sides import base_traction
from jointwave.cases.partition.shape import BESIDE, loaded_lines, shape_of
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import Load, PlaneLoad, shortest_period
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.loads.sides import facets_on, impedances_of, inside
from jointwave.continuum.receivers.points import read_at
from jointwave.continuum.space import compat
from jointwave.continuum.space.evaluation import matrix_of, places_in
from jointwave.continuum.space.fenicsx import dolfinx
from jointwave.continuum.space.model import Body, Facets, directions, forces_on

mesh = dolfinx.mesh
IN_A_PERIOD = 100  # samples per period of a field that is not evaluated at every step
AT_ONCE = 500_000  # force components in memory at a time for their impulse
NEAR = 1e-9  # distance from an end of a pillar, over its length, that counts as zero
GAUSS = 6  # points between two nodes: exact for elements of the highest order

#: Waves that enter through quiet sides: the freedoms there [points d], and a function of equally
#: spaced times [n], s, that returns the forces on them [n, points d], N.
Waves = tuple[np.ndarray, Callable[[np.ndarray], np.ndarray]]


class Push(NamedTuple):
    """A load: `share` [freedoms] times the mean of its history over a step is the force, N."""

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
    """Return the force on every freedom that releases the walls of openings from the prestress of
    the excavated rock, N; None without an excavation."""
    if not scene.excavated:
        return None
    assert scene.prestress is not None
    walls = facets_on(body, [name for name in body.sides if name.startswith("opening")])
    return forces_on(body, walls, walls.normal @ scene.prestress.tensor)


def pushes(scene: Any, body: Body, model: str) -> list[Push]:
    """Return the loads of a scene that are forces; model : "jointed" or "equivalent"."""
    of_kind: Any = {"pressure": _pressure, "force": _force, "base": _base, "load": end_force}

    def history(load: Any) -> LoadHistory:
        return late_load(scene, model) if load.kind == "load" else velocity_of(load, load.amplitude)

    return [Push(of_kind[one.kind](scene, body, one), history(one)) for one in scene.pushes]


def _base(scene: RockMass, body: Body, load: PlaneLoad) -> np.ndarray:
    """Return the force on a compliant base per velocity of the incoming wave, N s/m."""
    assert load.side is not None and load.direction is not None
    facets = facets_on(body, [load.side])
    impedance = impedances_of(scene, body, facets)
    return forces_on(body, facets, base_traction(impedance, load.direction))


def _force(scene: RockMass, body: Body, load: PlaneLoad) -> np.ndarray:
    """Return a force of 1 N at a point, in equal parts on both sides of a joint there."""
    assert load.at is not None and load.direction is not None
    return read_at(body, np.array([load.at]))[2].T @ np.array(load.direction)


def _pressure(scene: RockMass, body: Body, load: PlaneLoad) -> np.ndarray:
    """Return the force of a pressure of 1 Pa on a side or opening, or on a part of it."""
    facets = facets_on(body, [load.side or f"opening {load.opening}"])
    if load.between is None:
        return forces_on(body, facets, -facets.normal)
    parts = [_on_line(body, facets, *line) for line in loaded_lines(shape_of(scene.domain), load)]
    return np.sum(parts, axis=0)


def _on_line(body: Body, facets: Facets, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return the force of a pressure of 1 Pa on a straight part of the boundary in the plane, by
    Gauss points between its nodes."""
    start, end = sorted((start, end), key=tuple)  # bit for bit the same in both directions
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


def end_force(scene: Scene, body: Body, load: Load) -> np.ndarray:
    """Return the force on every freedom of an end stress of 1 Pa, N."""
    facets, axes = body.sides[load.side], directions(body)
    force, moment = force_and_moment(load)
    share = forces_on(body, facets, np.tile(force[axes], (len(facets.node), 1)))
    if not moment.any() or body.mesh.geometry.dim == 1 or body.tied is not None:
        return share
    # The mass matrix of the end face turns nodal tractions into forces.
    domain, y = body.mesh, float(facets.place[0, 1])
    near, dim = NEAR * float(np.ptp(body.x[:, 1])), domain.topology.dim - 1
    own = mesh.locate_entities_boundary(domain, dim, lambda x: np.abs(x[1] - y) <= near)
    tags = mesh.meshtags(domain, dim, np.sort(own), np.ones(len(own), np.int32))
    ds = ufl.Measure("ds", domain=domain, subdomain_data=tags, subdomain_id=1)
    on_end = ufl.inner(ufl.TrialFunction(body.space), ufl.TestFunction(body.space)) * ds
    bent = spread(scene.pillar.side, moment, body.x)[:, axes]
    return share + compat.matrix(on_end) @ bent.ravel()


def force_and_moment(load: Load) -> tuple[np.ndarray, np.ndarray]:
    """Return the force over area, and the moment over area (m) at the centre of the end, of an end
    stress of 1 Pa, along x, y, z."""
    direction = np.array(load.direction, dtype=float)
    if load.arm is not None:
        return np.zeros(3), load.arm * direction
    return direction, np.cross([load.at[0], 0.0, load.at[1]], direction)


def spread(side: float, moment: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the tractions [n, 3] of a moment at points [n, d], linear in x and z as in a long
    column: axial in bending (Navier), and in torsion tangential to circles about the axis."""
    across = np.zeros((len(x), 2))
    across[:, : x.shape[1] - 1] = x[:, [0, 2][: x.shape[1] - 1]]
    bent, twisted = 12 / side**2, 6 / side**2
    along = bent * (moment[2] * across[:, 0] - moment[0] * across[:, 1])
    around = twisted * moment[1] * across
    return np.column_stack([around[:, 1], along, -around[:, 0]])


class Loads:
    """All forces with a given history.

    freedom : the loaded freedoms [k].
    """

    def __init__(self, size: int, dt: float, pushes: list[Push], waves: Waves | None) -> None:
        shares = np.array([push.share for push in pushes]).reshape(len(pushes), size)
        acts = (shares != 0).any(axis=0)
        there = np.zeros(0, np.int64) if waves is None else waves[0]
        self._pulled = None if waves is None else waves[1]
        acts[there] = True
        self.freedom, self.dt = np.flatnonzero(acts), dt
        self.pushes = [push._replace(share=push.share[self.freedom]) for push in pushes]
        entries = np.arange(len(there)), np.searchsorted(self.freedom, there)
        shape = len(there), len(self.freedom)
        self._onto = csr_matrix((np.ones(len(there)), entries), shape)

    def at(self, first: int, last: int, stride: int = 1) -> np.ndarray:
        """Return the forces of every `stride`-th of the steps first .. last - 1 [steps, k], N."""
        steps = np.arange(first, last, stride)
        found = np.zeros((steps.size, self.freedom.size))
        for push in self.pushes:
            mean = step_means(push.history, self.dt, steps)
            found += mean[:, None] * push.share
        if self._pulled is not None and steps.size:
            found += self._pulled(self.dt * steps) @ self._onto
        return found

    def impulse(self, mass: np.ndarray, steps: int, stride: int) -> float:
        """Estimate the time integral of |F| in the norm of 1 / m, sqrt(J), from some steps, with
        both ends: a wave has no force at t = 0."""
        felt, own = 0.0, mass[self.freedom]
        many = stride * max(1, AT_ONCE // max(1, own.size))
        for first in range(0, steps + stride, many):
            force = self.at(first, min(first + many, steps + stride), stride)
            felt += float(np.sqrt((force**2 / own).sum(axis=1)).sum())
        return self.dt * stride * felt


def waves_of(scene: AnyScene, body: Body, incident: IncidentField | None) -> Waves | None:
    """Return the waves of a scene; incident : their field; absent: that in unjointed rock."""
    if not scene.waves:
        return None
    facets = facets_on(body, scene.boundaries.sides("quiet"))
    if not len(facets.node):
        return None
    field, places = incident or free_field(scene), inside(body, facets)
    impedance = impedances_of(scene, body, facets)

    def pulled(times: np.ndarray) -> FaceTractions:
        return tractions(field, places, facets.normal, impedance, times)

    sampled = None
    if not isinstance(field, FreeField):
        period = shortest_period(scene.waves) or scene.time.duration
        apart = min(scene.interval, period / IN_A_PERIOD)
        sampled = pulled(apart * np.arange(int(np.ceil(scene.time.duration / apart)) + 8))

    def forces(times: np.ndarray) -> np.ndarray:
        found = pulled(times).values if sampled is None else sampled.at(times)
        return (facets.weight[:, None] * found).reshape(len(times), -1)

    freedom = body.components * facets.node[:, None] + np.arange(body.components)
    return freedom.ravel(), forces
