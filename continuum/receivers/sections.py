"""Receivers of a pillar: motion on its axis, and the force over sections, along y, then x and z.

The force at a section within a layer of cells follows from the momentum balance of the rock before
it. A test motion w, 1 up to the near face of the layer and falling to 0 within it, gives the force
at that face, w (K u + C u' + M u''); the inertia of the rock from there to the section adds to it.
This is as accurate as displacements, whose derivative would lose an order (Wheeler, SIAM J. Numer.
Anal. 11, 1974, for the flux at a node). At either end it is the applied force. On a joint it is the
joint's traction; in a mesh without layers it is the integral of the stress.
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial import polynomial as poly
from scipy.sparse import csr_matrix, diags, kron, vstack

from jointwave.cases.schema.scene import Scene
from jointwave.continuum.loads.forces import pull_of
from jointwave.continuum.mesh.conforming import SIMPLEX
from jointwave.continuum.receivers.points import pieces_of, read_at
from jointwave.continuum.scene import SceneBody
from jointwave.continuum.space import compat
from jointwave.continuum.space.evaluation import matrix_of, nodes_of_cells, places_in, tabulate
from jointwave.continuum.space.model import Body
from jointwave.continuum.stepping.problem import Readings

NEAR = 1e-9  # distance, over the pillar's length, at which a section is on a joint
COVERS = 1e-6  # fraction of a section that joints may leave uncovered
PER_SIDE = 8  # Gauss points along each axis of a section in a mesh without layers
CURL = np.array([[[0, 0, 0], [0, 0, 1], [0, -1, 0]], [[0, 0, -1], [0, 0, 0], [1, 0, 0]],
                 [[0, 1, 0], [-1, 0, 0], [0, 0, 0]]])  # fmt: skip


def readings_of_pillar(scene: Scene, found: SceneBody, stress: np.ndarray | None) -> Readings:
    """Return the readings of a pillar's receivers: motion, then rotation; stress at sections, in
    rock as stress and on joints as traction. stress : at u = 0 [d, d], Pa, compression positive."""
    body, force, axes = found.body, sections(found, scene.record.stress), along_first(found.body)
    area, constant = (
        scene.pillar.area / scene.left_out(body.x.shape[1]),
        np.zeros(force.elastic.shape[0]),
    )
    if stress is not None:
        constant += np.tile(stress[axes[0], axes], len(scene.record.stress))
    if scene.gravity is not None:
        constant -= force.inertia @ pull_of(scene, body) / area
    return Readings(
        motion=points_on_axis(body, scene.record.velocity),
        stress=force.elastic / area,
        constant=constant,
        traction=force.contact / area,
        carried=np.zeros(force.contact.shape[0]),
        jump=csr_matrix((0, force.contact.shape[1])),
        viscous=force.viscous / area,
        inertia=force.inertia / area,
    )


class Sections(NamedTuple):
    """Forces over sections, N: elastic u + viscous u' + inertia u'', each [sections d, freedoms],
    plus contact [sections d, points d] times the forces of joints."""

    elastic: csr_matrix
    viscous: csr_matrix
    inertia: csr_matrix
    contact: csr_matrix


def along_first(body: Body) -> list[int]:
    """Return the indices of the components along y, then x, then z."""
    return [0] if body.components == 1 else [1, 0, 2][: body.components]


def axis_of(body: Body) -> int:
    """Return the index of the coordinate along the pillar."""
    return body.x.shape[1] // 2


def points_on_axis(body: Body, places: list[float]) -> csr_matrix:
    """Return the matrix of the motion at places on the axis [m d, freedoms] and, beyond one
    dimension, of the rotation, half the curl [m 3, freedoms]; means of both sides on a joint."""
    x = np.zeros((len(places), body.x.shape[1]))
    x[:, axis_of(body)] = places
    at, share, motion = read_at(body, x)
    if x.shape[1] == 1:
        return motion
    dim = body.components
    curl = 0.5 * CURL[:, :dim, :dim]
    weights = np.einsum("aic,n,nki->ankc", curl, share, at.gradient).swapaxes(0, 1)
    return csr_matrix(vstack([motion, matrix_of(body, at.point, at.cell, weights, len(x))]))


def sections(found: SceneBody, places: list[float]) -> Sections:
    """Return the sections at places along the pillar, m."""
    body = found.body
    none = 3 * (csr_matrix((body.components, body.mass.size)),)
    parts = [tuple(one[:0] for one in (*none, _contact(body, on_joint(body, np.inf))))]
    for y in places:
        rock, on, layer = none, on_joint(body, y), _layer(body, y)
        if not on.any():
            rock = _by_stress(found, y) if layer is None else _by_momentum(found, layer, y)
        parts.append((*rock, _contact(body, on)))
    return Sections(*(csr_matrix(vstack(part)) for part in zip(*parts, strict=True)))


def on_joint(body: Body, y: float) -> np.ndarray:
    """Return which points of joints lie on a section at y, bool [points]; none if they do not cover
    it, as for an inclined joint."""
    along, extent = axis_of(body), np.ptp(compat.cell_corners(body.mesh), axis=(0, 1))
    on = np.abs(body.joints.place[:, along] - y) <= NEAR * extent[along]
    covered = body.joints.weight[on].sum() / np.delete(extent, along).prod()
    return on & (covered > 1 - COVERS)


def _contact(body: Body, on: np.ndarray) -> csr_matrix:
    """Return the matrix that sums forces of joint points `on`, along y, x and z [d, points d]."""
    size = body.components
    turned = body.joints.frame.transpose(0, 2, 1)[:, along_first(body)]
    weights = on[:, None, None] * turned
    return csr_matrix(weights.transpose(1, 0, 2).reshape(size, -1))


def _layer(body: Body, y: float) -> np.ndarray | None:
    """Return the cells of the layer that contains a section (of two layers the first); None if
    their faces do not lie across the pillar."""
    corners = compat.cell_corners(body.mesh)[:, :, axis_of(body)]
    low, high = corners.min(axis=1), corners.max(axis=1)
    slack = NEAR * float(np.ptp(corners))
    here = np.flatnonzero((low <= y + slack) & (y <= high + slack))
    layer = here[np.abs(low[here] - low[here].min()) <= slack]
    own, bottom, top = corners[layer], low[layer[0]], high[layer[0]]
    away = np.minimum(np.abs(own - bottom), np.abs(own - top)).max()
    if body.cell.kind in SIMPLEX or away > slack or y > top + slack:
        return None
    return layer


def _by_momentum(found: SceneBody, layer: np.ndarray, y: float) -> tuple[csr_matrix, ...]:
    """Return a section's force from the momentum balance of the rock before it."""
    body = found.body
    kind, along, order = body.cell.kind, axis_of(body), body.cell.order
    corners = compat.cell_corners(body.mesh)[layer]
    near, thickness = corners[:, :, along].min(), np.ptp(corners[:, :, along])
    nodes, x, piece = nodes_of_cells(body), body.x[:, along], pieces_of(body)
    moves, strained = np.zeros((2, len(x)))
    moves[nodes[piece == piece[layer[0]]]] = 1.0
    moves[x > near + NEAR * float(np.ptp(x))] = 0.0
    strained[nodes[layer]] = 1.0
    directions = np.eye(body.components)[along_first(body)]
    w, in_layer = kron(csr_matrix(moves), directions), diags(np.repeat(strained, body.components))
    elastic, viscous = (csr_matrix(w @ one @ in_layer) for one in (body.stiffness, body.damping))

    levels = np.sort(compat.reference("interval", order).points[:, 0])
    running = poly.polyint(poly.polyfit(levels, np.eye(levels.size), order))
    whole = poly.polyval(1.0, running)
    share = -poly.polyval((y - near) / thickness, running)
    share[0] += whole[0]
    at, weight = compat.quadrature(kind, 2 * order - 1)
    volumes = weight @ tabulate(body.cell.element, at)[0]
    density = found.of_cells("density")[layer]
    size = np.ptp(corners, axis=1).prod(axis=1)
    own = nodes[layer]
    level = np.abs((x[own] - near)[:, :, None] / thickness - levels).argmin(axis=2)
    mass = (density * size)[:, None] * volumes * (share / whole)[level]
    inertia = np.bincount(own.ravel(), mass.ravel(), len(x))
    return elastic, viscous, csr_matrix(kron(csr_matrix(inertia), directions))


def _by_stress(found: SceneBody, y: float) -> tuple[csr_matrix, ...]:
    """Return a section's force as the integral of the stress, by Gauss points."""
    body = found.body
    at, weight = np.polynomial.legendre.leggauss(PER_SIDE)
    low, high = body.x.min(axis=0), body.x.max(axis=0)
    across = [k for k in range(len(low)) if k != axis_of(body)]
    grids = np.meshgrid(*[(low[k] + high[k] + (high[k] - low[k]) * at) / 2 for k in across])
    x = np.full((grids[0].size, len(low)), float(y))
    x[:, across] = np.column_stack([one.ravel() for one in grids])
    shares = np.meshgrid(*[weight * (high[k] - low[k]) / 2 for k in across])
    area = np.prod([one.ravel() for one in shares], axis=0)
    here = places_in(body, x)
    pairs = [(i, axis_of(body)) for i in along_first(body)]
    own, eta = found.moduli(pairs)[found.of_cell], found.of_cells("time_constant")
    each = (area / np.bincount(here.point))[here.point]
    entries = -np.einsum("ndcj,nkj,n->ndkc", own[here.cell], here.gradient, each)
    row = np.zeros(len(here.cell), np.int64)
    elastic, viscous = (
        matrix_of(body, row, here.cell, values, 1)
        for values in (entries, eta[here.cell, None, None, None] * entries)
    )
    return elastic, viscous, csr_matrix(elastic.shape)
