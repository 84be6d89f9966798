"""Loads of a rock mass as forces on nodes: pressures on sides and openings, point forces, and what
an excavation takes from the walls of openings."""

from __future__ import annotations

import numpy as np

from jointwave.cases.loads import velocity_of
from jointwave.cases.material.quiet_sides import base_traction, medium_impedances
from jointwave.cases.partition.parts import covered
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.sources import PlaneLoad
from jointwave.continuum.mesh.description import Side
from jointwave.continuum.plane.discrete import stress_of
from jointwave.continuum.plane.drive import Push
from jointwave.continuum.plane.sides import outward, points_on
from jointwave.continuum.space import basix_versions
from jointwave.continuum.space.body import Body
from jointwave.continuum.space.evaluation import cells_at, on_freedoms, places_in


def pushes(scene: RockMass, body: Body) -> list[Push]:
    """Return the loads of a scene that are forces."""
    of_kind = {"pressure": _pressure, "force": _force, "base": _base}
    return [
        Push(of_kind[one.kind](body, one, scene), velocity_of(one, one.amplitude))
        for one in scene.pushes
    ]


def _base(body: Body, load: PlaneLoad, scene: RockMass) -> np.ndarray:
    """Return the share of every freedom in the force on a compliant base for each m/s."""
    assert load.side is not None and load.direction is not None
    points, share = points_on(body, [load.side]), np.zeros(body.mass.size)
    impedance = medium_impedances(scene, points.normal, points.region)
    force = points.weight[:, None] * base_traction(points.normal, impedance, load.direction)
    np.add.at(share, body.freedom(points.node[:, None], np.arange(2)), force)
    return share


def _force(body: Body, load: PlaneLoad, scene: RockMass) -> np.ndarray:
    """Return the share of every freedom in a force of 1 N/m at a point."""
    assert load.at is not None and load.direction is not None
    _, cell = cells_at(body, np.array([load.at]))
    here = places_in(body, cell, np.tile(load.at, (cell.size, 1)))
    weights = here.basis[None, :, :, None] * np.array(load.direction) / cell.size
    return on_freedoms(body, cell, weights)[0]


def _pressure(body: Body, load: PlaneLoad, scene: RockMass) -> np.ndarray:
    """Return the share of every freedom in a pressure of 1 Pa on a side or in an opening."""
    side = body.mesh.sides[load.side or f"opening {load.opening}"]
    part = covered(scene.domain, load, side.corners[:, 0], side.corners[:, 1])
    return on_side(body, side, -outward(body, side), part)


def released(scene: RockMass, body: Body) -> np.ndarray | None:
    """Return the force (N/m) on every freedom by which the walls of openings lose the prestress
    that what is excavated bore there; None where there is none."""
    walls = [side for name, side in body.mesh.sides.items() if name.startswith("opening")]
    if not scene.excavated:
        return None
    xx, yy, xy = stress_of(scene)
    tensor = np.array([[xx, xy], [xy, yy]])
    return sum((on_side(body, one, outward(body, one) @ tensor) for one in walls), body.mass * 0)


def on_side(
    body: Body, side: Side, traction: np.ndarray, part: np.ndarray | None = None
) -> np.ndarray:
    """Return the force (N/m) on every freedom of a traction [facets, 2] (Pa) on the facets of a
    side; part : from where to where along each, of its length [facets, 2], None: all of it."""
    low, high = (part if part is not None else np.tile([0.0, 1.0], (len(side.cell), 1))).T
    at, weight = basix_versions.quadrature("interval", 2 * body.order)
    place = low[:, None] + (high - low)[:, None] * at[:, 0]
    along = side.corners[:, 1] - side.corners[:, 0]
    x = (side.corners[:, :1] + place[..., None] * along[:, None]).reshape(-1, 2)
    length = (np.linalg.norm(along, axis=1) * (high - low))[:, None] * weight
    cell = np.repeat(side.cell, len(at))
    push = np.repeat(traction, len(at), axis=0) * length.reshape(-1, 1)
    basis = places_in(body, cell, x).basis
    return on_freedoms(body, cell, np.einsum("qk,qc->qkc", basis, push)[None])[0]
