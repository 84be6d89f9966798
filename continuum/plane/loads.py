"""Loads of a rock mass as forces on nodes: pressures on sides and openings, point forces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cases.loads import history_of
from cases.partition.parts import covered
from continuum.plane.drive import Push
from continuum.plane.sides import outward
from continuum.space import compat
from continuum.space.evaluation import cells_at, on_freedoms, places_in

if TYPE_CHECKING:
    from cases.schema.domain import Domain
    from cases.schema.rock_mass import RockMass
    from cases.schema.sources import PlaneLoad
    from continuum.space.body import Body


def pushes(scene: RockMass, body: Body) -> list[Push]:
    """Return the loads of a scene, but for a shaken base."""
    of_kind = {"pressure": _pressure, "force": _force}
    return [
        Push(of_kind[one.kind](body, one, scene.domain), history_of(one, one.amplitude))
        for one in scene.loads
        if one.kind != "base"
    ]


def _force(body: Body, load: PlaneLoad, domain: Domain) -> np.ndarray:
    """Return the share of every freedom in a force of 1 N/m at a point."""
    assert load.at is not None and load.direction is not None
    _, cell = cells_at(body, np.array([load.at]))
    here = places_in(body, cell, np.tile(load.at, (cell.size, 1)))
    weights = here.basis[None, :, :, None] * np.array(load.direction) / cell.size
    return on_freedoms(body, cell, weights)[0]


def _pressure(body: Body, load: PlaneLoad, domain: Domain) -> np.ndarray:
    """Return the share of every freedom in a pressure of 1 Pa on a side or in an opening."""
    name = load.side or f"opening {load.opening}"
    side = body.mesh.sides[name]
    low, high = covered(domain, load, side.corners[:, 0], side.corners[:, 1]).T
    at, weight = compat.quadrature("interval", 2 * body.order)
    place = low[:, None] + (high - low)[:, None] * at[:, 0]
    along = side.corners[:, 1] - side.corners[:, 0]
    x = (side.corners[:, :1] + place[..., None] * along[:, None]).reshape(-1, 2)
    length = (np.linalg.norm(along, axis=1) * (high - low))[:, None] * weight
    cell = np.repeat(side.cell, len(at))
    push = -np.repeat(outward(body, side), len(at), axis=0) * length.reshape(-1, 1)
    basis = places_in(body, cell, x).basis
    return on_freedoms(body, cell, np.einsum("qk,qc->qkc", basis, push)[None])[0]
