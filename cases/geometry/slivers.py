"""Slivers: blocks too thin or too pointed, joined to a neighbour or refused."""

from collections.abc import Sequence

import numpy as np

from jointwave.cases.geometry.cell_complex import Complex, Sliver
from jointwave.cases.geometry.cut import cut, one_plane
from jointwave.cases.geometry.measure import least_angles, widths
from jointwave.cases.geometry.pieces import Pieces

#: Cuts of a sliver, at most: parts that made slivers of neighbours could pass round for ever.
PARTS = 4
NO_FIT = ", and joining it to a neighbour leaves no convex block"


def without_slivers(
    body: Complex,
    least_width: float,
    least_angle: float,
    joins: bool,
    tolerance: float,
    kept: int = 0,
) -> Complex:
    """Return a complex without blocks thinner (m) or more pointed (degrees) than the limits.

    joins : each is joined to the neighbour across its largest face with which it is convex, or part
    by part, cut where the faces of neighbours end at it; else, and where nothing fits, it is
    refused. kept : joint sets, the first ones, that a sliver is joined across only where it fits no
    other neighbour. Raises Sliver.
    """
    most = 0
    while True:
        half = body.halves()
        width, angle = widths(body, half), least_angles(body, half)
        thin = np.flatnonzero((width < least_width) | (angle < least_angle))
        if not len(thin):
            return body
        thin = thin[np.argsort(width[thin], kind="stable")]
        most = most or body.count + PARTS * len(thin)
        found, wrong = None, int(thin[0])
        if joins and body.count <= most:
            found, wrong = _joined(body, thin.tolist(), tolerance, kept)
        if found is None:
            cause = (
                f"a block is {width[wrong]:.3g} m wide with an angle of {angle[wrong]:.3g} degrees,"
                f" less than domain.least_width = {least_width:.3g} m or domain.least_angle = "
                f"{least_angle:g}{NO_FIT if joins else ''}"
            )
            raise Sliver(body.centres(half)[wrong], cause)
        body = found


def _joined(
    body: Complex, thin: list[int], tolerance: float, kept: int
) -> tuple[Complex | None, int]:
    """Return a complex with slivers joined to neighbours; where none can be, with a part of one of
    them joined. None, and the first that fits nowhere, where no part can be."""
    chosen = np.zeros(body.count + 1, bool)
    chosen[thin] = True
    chosen[body.sides[chosen[body.sides].any(axis=1)].ravel()] = True
    pieces = Pieces(body, chosen[:-1], body.in_rock, kept)
    found, stuck = pieces.joined(thin, tolerance)
    for cell in stuck if found is None else ():
        near = [other for other in pieces.near(cell) if other not in thin]
        if (found := _parted(body, cell, near, tolerance)) is not None:
            break
    return found, (stuck or thin)[0]


def _parted(body: Complex, cell: int, near: Sequence[int], tolerance: float) -> Complex | None:
    """Return a complex with a sliver cut along a face of a neighbour that ends at it, and a part
    joined to a neighbour; None where no such cut leaves one that fits."""
    alone, chosen = np.arange(body.count) == cell, np.isin(np.arange(body.count + 1), near)
    half = body.beside(chosen[:-1])
    own = body.vertices[body.corners(body.beside(alone))[:, 1]]
    place = body.places(half)
    for k in np.flatnonzero(half.across != cell):
        s = own @ half.outward[k] - place[k]
        if s.min() > -tolerance or s.max() < tolerance:
            continue
        split = cut(body, one_plane(half.outward[k], place[k], alone), tolerance).body
        parts = cell, body.count
        cells = chosen | np.isin(np.arange(split.count), parts)
        pieces = Pieces(split, cells, split.in_rock)
        for part in parts:
            ends = [other for other in pieces.near(part) if other in near]
            if (other := pieces.fitting(part, ends, tolerance)) is not None:
                root = np.arange(split.count)
                root[part] = other
                return split.joined(root)
    return None
