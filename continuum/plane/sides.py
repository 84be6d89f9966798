"""The sides of a rock mass: where they are in its elements, and what holds or absorbs there.

Quiet sides carry dashpots of rho a along their normal and rho b along themselves (Lysmer &
Kuhlemeyer, J. Eng. Mech. Div. ASCE 95, 1969) at the nodes, of the effective medium of the joint
sets that have a spacing: both models of the rock are as stiff there to long waves.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.loads import base_steps
from jointwave.cases.material.quiet_sides import borne, medium_impedances
from jointwave.cases.sampling import Clock
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.mesh.description import Side
from jointwave.continuum.model import Dashpots, Fixed
from jointwave.continuum.space.body import Body
from jointwave.continuum.space.evaluation import places_in
from jointwave.continuum.space.interface import facet_points

INSIDE = 1e-7  # of a cell: how far inside it a field is asked for, lest it is beyond a joint


class SidePoints(NamedTuple):
    """Nodes on sides, once for each direction that a side has there, and each region of rock.

    node : int array [n]. normal : out of the rock [n, 2]. weight : the length that each stands
    for [n], m. x : just inside the rock [n, 2], m. region : int array [n], -1 of none.
    """

    node: np.ndarray
    normal: np.ndarray
    weight: np.ndarray
    x: np.ndarray
    region: np.ndarray


def sides_that_are(scene: RockMass, body: Body, kind: str) -> list[str]:
    """Return the sides that are "quiet", "fixed" or "roller"."""
    return [name for name in scene.boundaries.sides(kind) if name in body.mesh.sides]


def outward(body: Body, side: Side) -> np.ndarray:
    """Return the unit normals out of the rock of the facets of a side [facets, 2]."""
    along = side.corners[:, 1] - side.corners[:, 0]
    normal = np.stack([along[:, 1], -along[:, 0]], axis=1)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    away = side.corners.mean(axis=1) - body.corners[side.cell].mean(axis=1)
    return normal * np.sign((normal * away).sum(axis=1))[:, None]


def points_on(body: Body, names: list[str]) -> SidePoints:
    """Return the nodes on sides, with the weights of the facets' Lobatto points; of the facets of
    this process alone."""
    found = []
    for side in (body.mesh.sides[name] for name in names):
        own = body.cells[side.cell, 0] >= 0
        side = Side(side.cell[own], side.corners[own])
        points = facet_points(body, side.corners)
        cell = side.cell[points.facet]
        basis = places_in(body, cell, points.x).basis
        node = body.cells[cell, np.abs(basis).argmax(axis=1)]
        centre = body.corners[cell].mean(axis=1)
        x = points.x + INSIDE * (centre - points.x)
        region = body.material[cell] - 1
        found.append((node, outward(body, side)[points.facet], points.weight, x, region))
    if not found:
        none = np.zeros(0, dtype=np.int64)
        found = [(none, np.zeros((0, 2)), np.zeros(0), np.zeros((0, 2)), none)]
    node, normal, weight, x, region = (np.concatenate(one) for one in zip(*found, strict=True))
    key = np.column_stack([node, np.rint(1e9 * normal), region])
    _, first, group = np.unique(key, axis=0, return_index=True, return_inverse=True)
    weights = np.bincount(group.ravel(), weight)
    places = _mean(body, node, weight, x)[first]
    return SidePoints(node[first], normal[first], weights, places, region[first])


def _mean(body: Body, node: np.ndarray, weight: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return the mean place [n, 2] of all points on each node: the same on all processes."""
    freedom = body.freedom(node[:, None], np.arange(2))
    share = np.zeros((2, body.mass.size))
    np.add.at(share[0], freedom, weight[:, None])
    np.add.at(share[1], freedom, weight[:, None] * x)
    whole, moment = body.communicator.total(share)
    return moment[freedom] / whole[freedom]


def dashpots_on(
    scene: RockMass,
    body: Body,
    points: SidePoints,
    fixed: Fixed | None,
    dt: float,
    mass: np.ndarray,
) -> Dashpots | None:
    """Return the dashpots of the quiet sides, but where the rock is fixed; None without any.

    mass : of all processes together [freedoms], kg.
    """
    n, weight = points.normal, points.weight[:, None]
    Z = weight * medium_impedances(scene, n, points.region)
    along = np.einsum("qi,qj->qij", n, n)
    of_point = Z[:, 0, None, None] * along + Z[:, 1, None, None] * (np.eye(2) - along)
    own, share = body.freedom(points.node[:, None], np.arange(2)), np.zeros((2, body.mass.size))
    np.add.at(share[0], own, of_point[:, [0, 1], [0, 1]])
    np.add.at(share[1], own[:, 0], of_point[:, 0, 1])
    whole, freedom = body.communicator.total(share), np.unique(freedoms_of(body), axis=0)
    moves = ~np.isin(freedom, [] if fixed is None else fixed.freedom)
    chosen = (whole[0, freedom] > 0).all(axis=1) & moves.any(axis=1)
    freedom, moves = freedom[chosen], moves[chosen]
    if not freedom.size:
        return None
    (x, y), moves = freedom.T, np.column_stack([moves, moves.all(axis=1)])  # one slides on rollers
    viscosity, every = (
        moves * np.stack([part[0, x], part[0, y], part[1, x]], axis=1) for part in (share, whole)
    )
    braked = 1 + (scene.damping.alpha or 0.0) * dt / 2  # as in the step over the mass
    return Dashpots(freedom, viscosity, every * dt / (2 * braked * mass[x, None]))


def borne_sides(scene: RockMass, body: Body) -> csr_matrix | None:
    """Return the lengths [freedoms, freedoms] (m) of quiet sides that bear the weight beside their
    dashpots, along their normal and along themselves; None without."""
    points = points_on(body, sides_that_are(scene, body, "quiet"))
    bears = points.weight[:, None] * borne(scene, points.normal)
    if not body.communicator.any(bool(bears.any())):
        return None
    along = np.einsum("qi,qj->qij", points.normal, points.normal)
    of_point = bears[:, 0, None, None] * along + bears[:, 1, None, None] * (np.eye(2) - along)
    own = body.freedom(points.node[:, None], np.arange(2))
    row, column = np.repeat(own, 2, axis=1), np.tile(own, 2)
    shape = body.mass.size, body.mass.size
    return csr_matrix((of_point.ravel(), (row.ravel(), column.ravel())), shape)


def freedoms_of(body: Body) -> np.ndarray:
    """Return the freedoms of all nodes, int array [nodes, (x, y)]."""
    return body.freedom(np.arange(len(body.x))[:, None], np.arange(2))


def fixed_sides(scene: RockMass, body: Body, time: Clock | None = None) -> Fixed | None:
    """Return the freedoms of the fixed sides, with the motion of one that is shaken, and those
    normal to roller sides; None without."""
    names = [*sides_that_are(scene, body, "fixed"), *sides_that_are(scene, body, "roller")]
    if not names:
        return None
    base = next(iter(scene.bases), None)
    direction = np.full(body.mass.size, np.nan)
    for name in names:
        touched, every = np.zeros(body.mass.size), freedoms_of(body)
        touched[every[points_on(body, [name]).node]] = 1.0
        # The facet of a node may be another process's.
        nodes = np.flatnonzero(body.communicator.total(touched)[every[:, 0]])
        shaken = base is not None and base.side == name
        given = np.array(base.direction) if shaken and base is not None else np.zeros(2)
        rolls = getattr(scene.boundaries, name) == "roller"
        for c in [int(name in ("bottom", "top"))] if rolls else range(2):
            of = body.freedom(nodes, c)
            direction[of] = np.where(np.isnan(direction[of]) | shaken, given[c], direction[of])
    freedom, step = np.flatnonzero(~np.isnan(direction)), None
    if base is not None and time is not None:
        step = base_steps(base, time.dt, time.steps + 1)
    return Fixed(freedom, direction[freedom], step)
