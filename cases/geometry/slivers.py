"""Slivers: blocks too thin or too pointed, joined to a neighbour or refused."""

from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.cell_complex import Complex, Sliver
from jointwave.cases.geometry.cut import cut, one_plane
from jointwave.cases.geometry.measure import least_angles, widths
from jointwave.cases.geometry.pieces import Beside, Piece, fits, pieces_of

#: Cuts of a sliver, at most: parts that made slivers of neighbours could pass round for ever.
PARTS = 4
NO_FIT = ", and joining it to a neighbour leaves no convex block"


class Limits(NamedTuple):
    """Least width, m, and least angle between faces, degrees, of a block."""

    width: float
    angle: float


def without_slivers(
    body: Complex, limits: Limits, joins: bool, tolerance: float, kept: int = 0
) -> Complex:
    """Return a complex without blocks thinner or more pointed than the limits.

    joins : each is joined to the neighbour across its largest face with which it is convex, or part
    by part, cut where the faces of neighbours end at it; else, and where nothing fits, it is
    refused. kept : joint sets, the first ones, that a sliver is joined across only where it fits no
    other neighbour. Raises Sliver.
    """
    most = 0
    while True:
        half = body.halves()
        width, angle = widths(body, half), least_angles(body, half)
        thin = np.flatnonzero((width < limits.width) | (angle < limits.angle))
        if not len(thin):
            return body
        thin = thin[np.argsort(width[thin], kind="stable")]
        most = most or body.count + PARTS * len(thin)

        if not joins or body.count > most:
            raise _refusal(body, limits, int(thin[0]), NO_FIT if joins else "")
        found = _joined_to_neighbours(body, thin.tolist(), tolerance, kept)
        if isinstance(found, int):
            raise _refusal(body, limits, found, NO_FIT)
        body = found


def _refusal(body: Complex, limits: Limits, cell: int, more: str) -> Sliver:
    half = body.beside(np.arange(body.count) == cell)
    width, angle = widths(body, half)[cell], least_angles(body, half)[cell]
    cause = (
        f"a block is {width:.3g} m wide with an angle of {angle:.3g} degrees, less than "
        f"domain.least_width = {limits.width:.3g} m or domain.least_angle = {limits.angle:g}{more}"
    )
    return Sliver(body.centres(half)[cell], cause)


def _joined_to_neighbours(
    body: Complex, thin: list[int], tolerance: float, kept: int
) -> Complex | int:
    """Return a complex with slivers joined, of those that touch only one at a time; where none can
    be, with a part of one of them joined; else the first that fits nowhere."""
    chosen = np.zeros(body.count + 1, bool)
    chosen[thin] = True
    chosen[body.sides[chosen[body.sides].any(axis=1)].ravel()] = True
    pieces, beside = pieces_of(body, chosen[:-1])
    order = _by_preference(body, beside, thin, kept)
    root, used, stuck = np.arange(body.count), np.zeros(body.count, bool), []
    for cell in thin:
        near = order[cell]
        if used[cell] or used[near].any():
            continue
        other = _fitting(pieces, cell, near, beside, tolerance)
        if other is None:
            stuck.append(cell)
            continue
        root[cell], used[cell] = other, True
        used[near] = True
    if used.any():
        return body.joined(root)
    slivers = set(thin)
    for cell in stuck:
        near = [other for other in order[cell] if other not in slivers]
        parted = _parted(body, cell, near, tolerance)
        if parted is not None:
            return parted
    return stuck[0]


def _by_preference(
    body: Complex, beside: Beside, thin: list[int], kept: int
) -> dict[int, list[int]]:
    """Return the cells of the same rock beside each of some, that across the largest face first,
    but those beyond joints of the first `kept` sets last."""
    joint = body.sides[(body.joint_set >= 0) & (body.joint_set < kept)]
    beyond = {frozenset(pair) for pair in joint.tolist()}
    return {
        cell: sorted(
            (other for other in beside[cell] if body.region[other] == body.region[cell]),
            key=lambda other: (
                frozenset((cell, other)) in beyond,
                -beside[cell][other].area,
                other,
            ),
        )
        for cell in thin
    }


def _fitting(
    pieces: dict[int, Piece], cell: int, near: list[int], beside: Beside, tolerance: float
) -> int | None:
    """Return the first of some cells beside another that make a convex one with it."""
    for other in near:
        if fits(pieces[cell], pieces[other], beside[cell][other].normal, tolerance):
            return other
    return None


def _parted(body: Complex, cell: int, near: list[int], tolerance: float) -> Complex | None:
    """Return a complex with a sliver cut along a face of a neighbour that ends at it, and a part
    joined to a neighbour; None where no such cut leaves one that fits."""
    chosen = np.zeros(body.count, bool)
    chosen[near] = True
    half = body.beside(chosen)
    own = body.vertices[body.corners(body.beside(np.arange(body.count) == cell))[:, 1]]
    for k in np.flatnonzero(half.across != cell):
        s = (own - body.origins(half)[k]) @ half.outward[k]
        if s.min() > -tolerance or s.max() < tolerance:
            continue
        plane = one_plane(half.outward[k], body.origins(half)[k], np.arange(body.count) == cell)
        split = cut(body, plane, tolerance).body
        touched = np.append(chosen, False)
        touched[cell] = touched[-1] = True
        pieces, beside = pieces_of(split, touched)
        for part in (cell, body.count):
            ends = sorted(
                (other for other in beside[part] if other in near),
                key=lambda other: -beside[part][other].area,
            )
            other = _fitting(pieces, part, ends, beside, tolerance)
            if other is not None:
                root = np.arange(split.count)
                root[part] = other
                return split.joined(root)
    return None
