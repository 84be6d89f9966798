"""Receivers of a rock mass: motion and stress at points, tractions, gap and slip of joints.

Stress is compression positive. On a joint points read the mean of both sides. A joint is read at
the place nearest to its receiver, between the quadrature points of the facet there; its tangent
is its normal, from the contact's block i to its block j, turned to the left.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import block_diag, csr_matrix, vstack

from jointwave.cases.geometry.locate import contact_at
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.model import Receivers
from jointwave.continuum.plane.discrete import PlaneDiscrete, stress_of
from jointwave.continuum.plane.recovery import recovered_stress
from jointwave.continuum.space.evaluation import cells_at, matrix_of, places_in
from jointwave.continuum.space.interface import facet_points
from jointwave.continuum.space.receivers import per_component, shares_of_pieces


class JointReaders(NamedTuple):
    """How joints are read, matrices of r receivers: traction [2 r, 2 q], from the joints' forces
    (N) to Pa, normal and shear; jump [2 r, freedoms], gap and slip, m."""

    traction: csr_matrix
    jump: csr_matrix


def receivers(scene: RockMass, discrete: PlaneDiscrete) -> Receivers:
    """Return how the receivers of a rock mass read its state.

    Rows of stress: xx, yy, xy of all points, each together, then normal and shear tractions.
    """
    body, materials = discrete.body, discrete.materials
    x = np.array(scene.record.points, dtype=float).reshape(-1, 2)
    which, cell = cells_at(body, x)
    at = places_in(body, cell, x[which])
    share = shares_of_pieces(which, body.piece[cell])
    motion = per_component(share[:, None] * at.basis, np.arange(2))
    elastic = recovered_stress(body, materials, discrete.vertex, x, which, cell)
    joints = _joints(scene, discrete)
    rows = 0 if joints is None else joints.traction.shape[0]
    whole = csr_matrix(vstack([elastic, csr_matrix((rows, body.mass.size))]))
    carried = np.repeat(stress_of(scene), len(x)) * (body.communicator.rank == 0)
    constant = np.concatenate([carried, _carried(discrete, joints)])
    return Receivers(
        point=matrix_of(body, which, cell, motion, len(x)),
        turn=None if joints is None else joints.jump,
        elastic=whole,
        viscous=materials[0].time_constant * whole if materials[0].time_constant else None,
        inertia=csr_matrix(whole.shape),
        contact=None if joints is None else _below(joints.traction, elastic.shape[0]),
        constant=constant if constant.any() else None,
    )


def _below(matrix: csr_matrix, rows: int) -> csr_matrix:
    """Return a matrix below so many empty rows."""
    return csr_matrix(vstack([csr_matrix((rows, matrix.shape[1])), matrix]))


def _carried(discrete: PlaneDiscrete, joints: JointReaders | None) -> np.ndarray:
    """Return what the tractions of receivers are at the start, Pa."""
    own = discrete.joints
    if joints is None:
        return np.zeros(0)
    if own is None or own.prestress is None:
        return np.zeros(joints.traction.shape[0])
    return joints.traction @ (own.prestress * own.area).ravel()


def _joints(scene: RockMass, discrete: PlaneDiscrete) -> JointReaders | None:
    """Return how the joints nearest to the places of [record] are read; None without any."""
    joints, across, body = discrete.joints, discrete.jumps, discrete.body
    facets, places = body.mesh.joints, np.array(scene.record.joints, dtype=float).reshape(-1, 2)
    if not len(places) or not facets.joint.size:
        return None
    if joints is None or across is None:  # they are those of other processes
        return JointReaders(
            csr_matrix((2 * len(places), 0)), csr_matrix((2 * len(places), body.mass.size))
        )
    mine = body.cells[facets.left, 0] >= 0
    row, point, weight = [], [], []
    blocks, sets = discrete.partition.blocks, len(discrete.partition.joint_sets)
    for r, one in enumerate(contact_at(blocks, places, sets)):
        on = np.flatnonzero(facets.joint == one)
        at = _along(facets.corners[on], places[r])
        nearest = np.abs(at - 0.5).argmin()
        if mine[on[nearest]]:
            points = across.of_facet[mine[: on[nearest]].sum()]
            corners = facets.corners[on[nearest]]
            nodes = _along(corners, facet_points(body, corners[None]).x)
            weight.append(lagrange(nodes, np.clip(at[nearest], 0, 1)))
            point.append(points)
            row.append(np.full(points.size, r))
    none = np.zeros(0, dtype=np.int64)
    entries = np.concatenate([none, *row]), np.concatenate([none, *point])
    read = csr_matrix(
        (np.concatenate([np.zeros(0), *weight]), entries), (len(places), joints.area.size)
    )
    # The second direction of jumps is to the right of the normal.
    per_area = read.multiply(1 / joints.area)
    traction = csr_matrix(block_diag([per_area, -per_area]))
    normal, right = across.matrices
    return JointReaders(traction, csr_matrix(vstack([read @ normal, -(read @ right)])))


def _along(corners: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Return how far points [..., 2] are along facets with these ends [..., 2, 2]: 0 to 1."""
    start, along = corners[..., 0, :], corners[..., 1, :] - corners[..., 0, :]
    return ((x - start) * along).sum(axis=-1) / (along**2).sum(axis=-1)


def lagrange(nodes: np.ndarray, place: float) -> np.ndarray:
    """Return the Lagrange polynomials of nodes [n] at a place."""
    apart = nodes[:, None] - nodes
    np.fill_diagonal(apart, 1.0)
    missing = np.tile(place - nodes, (nodes.size, 1))
    np.fill_diagonal(missing, 1.0)
    return (missing / apart).prod(axis=1)
