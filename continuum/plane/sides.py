"""The sides of a rock mass: where they are in its elements, and what holds or absorbs there.

Quiet sides carry dashpots of rho a along their normal and rho b along themselves (Lysmer &
Kuhlemeyer, J. Eng. Mech. Div. ASCE 95, 1969) at the nodes, of the effective medium of the joint
sets that have a spacing: both models of the rock are as stiff there to long waves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cases.material.quiet_sides import medium_impedances
from continuum.model import Dashpots, Fixed
from continuum.space.evaluation import places_in
from continuum.space.interface import facet_points

if TYPE_CHECKING:
    from cases.sampling import Clock
    from cases.schema.rock_mass import RockMass
    from continuum.mesh.description import Side
    from continuum.space.body import Body

INSIDE = 1e-7  # of a cell: how far inside it a field is asked for, lest it is beyond a joint


class SidePoints(NamedTuple):
    """Nodes on sides, once for each direction that a side has there.

    node : int array [n]. normal : out of the rock [n, 2]. weight : the length that each stands
    for [n], m. x : just inside the rock [n, 2], m.
    """

    node: np.ndarray
    normal: np.ndarray
    weight: np.ndarray
    x: np.ndarray


def held(scene: RockMass, name: str) -> str:
    """Return what holds a side of a partition; openings are free."""
    return getattr(scene.boundaries, name, "free")


def sides_that_are(scene: RockMass, body: Body, kind: str) -> list[str]:
    """Return the names of the sides that are "quiet", "fixed" or "free"."""
    return [name for name in body.mesh.sides if held(scene, name) == kind]


def outward(body: Body, side: Side) -> np.ndarray:
    """Return the unit normals out of the rock of the facets of a side [facets, 2]."""
    along = side.corners[:, 1] - side.corners[:, 0]
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    away = side.corners.mean(axis=1) - body.corners[side.cell].mean(axis=1)
    return normal * np.sign((normal * away).sum(axis=1))[:, None]


def points_on(body: Body, names: list[str]) -> SidePoints:
    """Return the nodes on sides, with the weights of the facets' Lobatto points."""
    found = []
    for side in (body.mesh.sides[name] for name in names):
        points = facet_points(body, side.corners)
        cell = side.cell[points.facet]
        basis = places_in(body, cell, points.x).basis
        node = body.cells[cell, np.abs(basis).argmax(axis=1)]
        centre = body.corners[cell].mean(axis=1)
        x = points.x + INSIDE * (centre - points.x)
        found.append((node, outward(body, side)[points.facet], points.weight, x))
    if not found:
        return SidePoints(
            np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros(0), np.zeros((0, 2))
        )
    node, normal, weight, x = (np.concatenate(parts) for parts in zip(*found, strict=True))
    key = np.column_stack([node, np.rint(1e9 * normal)])
    _, first, group = np.unique(key, axis=0, return_index=True, return_inverse=True)
    return SidePoints(node[first], normal[first], np.bincount(group.ravel(), weight), x[first])


def dashpots_on(
    scene: RockMass, body: Body, points: SidePoints, fixed: Fixed | None, dt: float
) -> Dashpots | None:
    """Return the dashpots of the quiet sides, but where the rock is fixed; None without any."""
    nodes, own = np.unique(points.node, return_inverse=True)
    n, Z = points.normal, points.weight[:, None] * medium_impedances(scene, points.normal)
    along = np.einsum("qi,qj->qij", n, n)
    of_point = Z[:, 0, None, None] * along + Z[:, 1, None, None] * (np.eye(2) - along)
    whole = np.zeros((nodes.size, 2, 2))
    np.add.at(whole, own, of_point)
    freedom = body.freedom(nodes[:, None], np.arange(2))
    if fixed is not None:
        free = ~np.isin(freedom, fixed.freedom).any(axis=1)
        freedom, whole = freedom[free], whole[free]
    if not freedom.size:
        return None
    viscosity = np.stack([whole[:, 0, 0], whole[:, 1, 1], whole[:, 0, 1]], axis=1)
    braked = 1 + (scene.damping.alpha or 0.0) * dt / 2  # as in the step over the mass
    beta = viscosity * dt / (2 * braked * body.mass[freedom[:, :1]])
    return Dashpots(freedom, viscosity, beta)


def fixed_sides(scene: RockMass, body: Body, time: Clock | None = None) -> Fixed | None:
    """Return the freedoms of the fixed sides, with the motion of one that is shaken; None
    without."""
    from cases.loads import base_motion

    names = sides_that_are(scene, body, "fixed")
    if not names:
        return None
    base = next(iter(scene.bases), None)
    direction = np.full(body.mass.size, np.nan)
    for name in names:
        nodes = points_on(body, [name]).node
        shaken = base is not None and base.side == name
        given = np.array(base.direction) if shaken and base is not None else np.zeros(2)
        for c in range(2):
            of = body.freedom(nodes, c)
            direction[of] = np.where(np.isnan(direction[of]) | shaken, given[c], direction[of])
    freedom, step = np.flatnonzero(~np.isnan(direction)), None
    if base is not None and time is not None:
        step = base_motion(base, time.dt, time.steps + 1)
    return Fixed(freedom, direction[freedom], step)
