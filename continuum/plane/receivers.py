"""Receivers of a rock mass: motion and stress at points, tractions, gap and slip of joints.

Stress is compression positive. On a joint points read the mean of both sides. A joint is read at
the place nearest to its receiver, between the quadrature points of the facet there; its tangent
is its normal, from the contact's block i to its block j, turned to the left.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, vstack

from cases.partition.locate import contact_at
from continuum.model import Receivers
from continuum.plane.recovery import recovered_stress
from continuum.plane.rock import stress_of
from continuum.space.evaluation import cells_at, matrix_of, places_in
from continuum.space.receivers import per_component, shares_of_pieces

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass
    from continuum.plane.rock import PlaneDiscrete


class JointReaders(NamedTuple):
    """How joints are read, matrices of r receivers: traction [2 r, 2 q], from the joints' forces
    (N) to Pa, normal and shear; jump [2 r, freedoms], gap and slip, m."""

    traction: csr_matrix
    jump: csr_matrix


def receivers(scene: RockMass, discrete: PlaneDiscrete) -> Receivers:
    """Return how the receivers of a rock mass read its state.

    Rows of stress: xx, yy, xy of all points, each together, then normal and shear tractions.
    """
    body, material = discrete.body, discrete.materials[0]
    x = np.array(scene.record.points, dtype=float).reshape(-1, 2)
    which, cell = cells_at(body, x)
    at = places_in(body, cell, x[which])
    share = shares_of_pieces(which, body.piece[cell])
    motion = per_component(share[:, None] * at.basis, np.arange(2))
    elastic = recovered_stress(body, material, x, which, cell)
    joints = _joints(scene, discrete) if scene.record.joints and discrete.joints else None
    rows = 0 if joints is None else joints.traction.shape[0]
    whole = csr_matrix(vstack([elastic, csr_matrix((rows, body.mass.size))]))
    constant = np.concatenate([np.repeat(stress_of(scene), len(x)), _carried(discrete, joints)])
    return Receivers(
        point=matrix_of(body, which, cell, motion, len(x)),
        turn=None if joints is None else joints.jump,
        elastic=whole,
        viscous=material.time_constant * whole if material.time_constant else None,
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
    if joints is None or own is None:
        return np.zeros(0)
    if own.prestress is None:
        return np.zeros(joints.traction.shape[0])
    return joints.traction @ (own.prestress * own.area).ravel()


def _joints(scene: RockMass, discrete: PlaneDiscrete) -> JointReaders:
    """Return how the joints nearest to the places of [record] are read."""
    joints, across = discrete.joints, discrete.jumps
    assert joints is not None and across is not None
    places = np.array(scene.record.joints, dtype=float)
    contact = contact_at(discrete.partition, places)
    own, q = discrete.partition.contacts, joints.area.size
    start, along = own.start[contact], own.end[contact] - own.start[contact]
    share = ((places - start) * along).sum(axis=1) / (along**2).sum(axis=1)
    foot = start + np.clip(share, 0, 1)[:, None] * along
    row, point, weight = [], [], []
    for r, one in enumerate(contact):
        on = np.flatnonzero(across.joint == one)
        s = (across.x[on] - start[r]) @ along[r] / own.length[one]
        on, s = on[np.argsort(s)], np.sort(s)
        near = _facet(s, (foot[r] - start[r]) @ along[r] / own.length[one], discrete.body.order)
        weight.append(lagrange(s[near], (foot[r] - start[r]) @ along[r] / own.length[one]))
        point.append(on[near])
        row.append(np.full(near.size, r))
    read = csr_matrix(
        (np.concatenate(weight), (np.concatenate(row), np.concatenate(point))), (len(places), q)
    )
    # The second direction of jumps is to the right of the normal.
    per_area = read.multiply(1 / joints.area)
    none = csr_matrix(read.shape)
    traction = vstack([_beside(per_area, none), _beside(none, -per_area)])
    normal, right = across.matrices
    return JointReaders(csr_matrix(traction), csr_matrix(vstack([read @ normal, -(read @ right)])))


def _beside(left: csr_matrix, right: csr_matrix) -> csr_matrix:
    from scipy.sparse import hstack

    return csr_matrix(hstack([left, right]))


def _facet(s: np.ndarray, place: float, order: int) -> np.ndarray:
    """Return the points of the facet that a place is on, of sorted points s that neighbouring
    facets share."""
    facet = int(np.clip((np.searchsorted(s, place) - 1) // order, 0, (s.size - 1) // order - 1))
    return np.arange(facet * order, facet * order + order + 1)


def lagrange(nodes: np.ndarray, place: float) -> np.ndarray:
    """Return the Lagrange polynomials of nodes [n] at a place."""
    apart = nodes[:, None] - nodes
    np.fill_diagonal(apart, 1.0)
    missing = np.tile(place - nodes, (nodes.size, 1))
    np.fill_diagonal(missing, 1.0)
    return (missing / apart).prod(axis=1)
