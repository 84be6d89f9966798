"""Receivers of a body: motion and stress at points, tractions, gap and slip of joints.

Stress is compression positive. A point on a joint has the mean of both sides. Joint values are
interpolated between the joint's points, at the place nearest to the receiver.
"""

import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix, kron

from jointwave.cases.geometry.locate import contact_at
from jointwave.cases.geometry.measure import upwards
from jointwave.cases.geometry.relations import joined
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.scene import SceneBody
from jointwave.continuum.space import compat
from jointwave.continuum.space.evaluation import (
    Places,
    at_reference,
    matrix_of,
    nodes_of_cells,
    places_in,
    tabulate,
)
from jointwave.continuum.space.model import Body, JumpOperator
from jointwave.continuum.stepping.problem import Readings
from jointwave.results.stress import stress_components

LEAST = 1.5  # least number of points for each coefficient of a polynomial
#: The weight of a point at a distance s, over the size of the element, is exp(-FALL s^2 / 2).
FALL = 4.0
WHOLE = 1e-6  # tolerance of the sum of weights of points around a place
LEVEL = 1e-6  # tolerance of coplanar points: of 1 - cosine, and of the distance over the extent


def readings_of(scene: RockMass, found: SceneBody, stress: np.ndarray | None) -> Readings:
    """Return the readings of a rock mass's receivers, at points and on joints; stress : at u = 0
    [d, d], Pa, compression positive."""
    body, dim, (points, joints) = found.body, found.body.components, scene.places.values()
    (at, share, motion), pairs = read_at(body, points), stress_components(dim).values()
    constant, carried = np.zeros((len(points), len(pairs))), np.zeros((len(joints), dim))
    read, area = csr_matrix((0, 0)), np.zeros(0)
    if len(body.joints.weight):
        area, each = np.repeat(body.joints.weight, dim), np.arange(len(body.joints.weight) + 1)
        turned = bsr_matrix((upwards(body.joints.frame).swapaxes(1, 2), each[:-1], each))
        nearest = csr_matrix(nearest_points(found, body.joints, joints))
        read = csr_matrix(kron(nearest, np.eye(dim)) @ turned).sorted_indices()
        read.eliminate_zeros()
    if stress is not None:
        constant[:] = [stress[i, j] for i, j in pairs]
        carried = read @ body.joints.carried(stress)
    recovered, viscous = _recovered(found, points, at, share)
    return Readings(
        motion=motion,
        stress=recovered,
        constant=constant.ravel(),
        traction=csr_matrix(
            (read.data / area[read.indices], read.indices, read.indptr), read.shape
        ),
        carried=carried.ravel(),
        jump=read,
        viscous=viscous,
    )


def read_at(body: Body, x: np.ndarray) -> tuple[Places, np.ndarray, csr_matrix]:
    """Return the cells of points [m, d], m, the share of each cell in a point's mean, and the
    matrix of the motion there [m d, freedoms]. Pieces of rock that meet at a point have equal
    shares, however many cells they have."""
    at = places_in(body, x)
    piece = pieces_of(body)[at.cell]
    pieces = 1 + piece.max(initial=0)
    key = at.point * pieces + piece
    side, of_cell, cells = np.unique(key, return_inverse=True, return_counts=True)
    share = 1 / (np.bincount(side // pieces)[at.point] * cells[of_cell.ravel()])
    weights = np.einsum("nk,ac->nakc", share[:, None] * at.basis, np.eye(body.components))
    return at, share, matrix_of(body, at.point, at.cell, weights, len(x))


def pieces_of(body: Body) -> np.ndarray:
    """Return the number of the connected piece of the body of each cell [cells]."""
    nodes = nodes_of_cells(body)
    first = np.broadcast_to(nodes[:, :1], nodes.shape)
    return joined(np.stack([first.ravel(), nodes.ravel()], axis=1), len(body.x))[nodes[:, 0]]


def _recovered(
    found: SceneBody, x: np.ndarray, at: Places, share: np.ndarray
) -> tuple[csr_matrix, csr_matrix]:
    """Return the matrices of stress at points x [m, d], [m components, freedoms], from displacement
    and, for dashpots of the rock, from velocity.

    Stress from displacements of order p converges as h^(p + 1) at the Gauss points of cells
    (Barlow, Int. J. Numer. Meth. Eng. 10, 1976). A polynomial of order p + 1, fitted to them in the
    cells around a point with weights that fall with distance, has this order everywhere
    (Zienkiewicz & Zhu, Int. J. Numer. Meth. Eng. 33, 1992). Cells beyond a joint or of other rock
    are left out; with too few points the stress is that of the cell at the point.
    """
    body, moduli, lag = found.body, found.of_cells("stiffness"), found.of_cells("time_constant")
    nodes, corners = nodes_of_cells(body), compat.cell_corners(body.mesh)
    none, dim = np.zeros(0, np.int64), body.components
    parts = [(none, none, np.zeros((0, dim)), np.zeros(0))]
    for point, cell, own in zip(at.point, at.cell, share, strict=True):
        near = np.flatnonzero(np.isin(nodes, nodes[cell]).any(axis=1))
        near = near[(moduli[near] == moduli[cell]).all(axis=(1, 2))]
        some, local, shares = _patch(body, corners, near, cell, x[point])
        parts.append((np.full(len(some), point), some, local, own * shares))
    row, cells, places, weights = map(np.concatenate, zip(*parts, strict=True))
    of_stress = found.moduli(stress_components(dim).values())[found.of_cell[cells]]
    gradient = at_reference(body, row, cells, places).gradient
    entries = -np.einsum("nscj,nkj,n->nskc", of_stress, gradient, weights)
    viscous = matrix_of(body, row, cells, lag[cells, None, None, None] * entries, len(x))
    return matrix_of(body, row, cells, entries, len(x)), viscous


def _patch(
    body: Body, corners: np.ndarray, near: np.ndarray, own: int, place: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return cells [n], local places [n, d] and weights [n] of the stresses whose sum is the stress
    at a place in the cell `own`."""
    kind, order = body.cell.kind, body.cell.order
    simplex = kind in ("triangle", "tetrahedron")
    rule = compat.quadrature(kind, max(2 * order - 2, 1) if simplex else 2 * order - 1)[0]
    cells, at = np.repeat(near, len(rule)), np.tile(rule, (len(near), 1))
    basis = tabulate(compat.reference(kind, 1), at)[0]
    x = np.einsum("nv,nvd->nd", basis, corners[cells])
    size = np.ptp(corners[own], axis=0).prod() ** (1 / body.components)
    s = (x - place) / size
    powers = np.indices([order + 2] * body.components).reshape(body.components, -1).T
    powers = powers[powers.sum(axis=1) <= order + 1]
    powers = powers[np.argsort(powers.sum(axis=1), kind="stable")]
    if len(x) < LEAST * len(powers):
        here = places_in(body, place[None])
        local = here.local[here.cell == own]
        return np.array([own]), local, np.ones(1)
    weight = np.exp(-FALL * (s**2).sum(axis=1) / 2)
    terms = weight[:, None] * np.prod(s[:, None] ** powers, axis=2)
    return cells, at, np.linalg.pinv(terms)[0] * weight


def nearest_points(found: SceneBody, joints: JumpOperator, places: np.ndarray) -> np.ndarray:
    """Return the weights of joint points [r, points] at the places on joints nearest to these."""
    body, shares = found.body, list[np.ndarray]()
    nodes, before = nodes_of_cells(body), joints.node[:, 0]  # on the side behind the normal
    contacts = contact_at(found.blocks, places, len(found.scene.joint_sets))
    for place, contact in zip(places, contacts, strict=True):
        away = np.linalg.norm(joints.place - place, axis=1)
        away[joints.column != contact] += found.scene.reach  # a contact may have no points
        nearest = int(away.argmin())
        normal, share = joints.frame[nearest, 0], np.zeros(len(joints.weight))
        off = (joints.place - joints.place[nearest]) @ normal
        level = (np.abs(joints.frame[:, 0] @ normal) > 1 - LEVEL) & (
            np.abs(off) < LEVEL * np.ptp(joints.place, axis=0).max()
        )
        at = places_in(body, (place - (place - joints.place[nearest]) @ normal * normal)[None])
        for cell, basis in zip(at.cell, at.basis, strict=True):
            here = np.zeros_like(share)
            for node, value in zip(nodes[cell], basis, strict=True):
                own = level & (before == node)
                here[own] = value / max(1, own.sum())
            share += here if abs(here.sum() - 1) < WHOLE else 0.0
        if not share.any():
            share[nearest] = 1.0
        shares.append(share / share.sum())
    return np.array(shares).reshape(len(places), len(joints.weight))
