"""Convex pieces that make a convex one, and pieces that are joined as long as they do."""

from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.cell_complex import OUTSIDE, Complex
from jointwave.cases.geometry.measure import cell_moments, facet_moments


class Piece(NamedTuple):
    """A convex piece: vertices [n, d], m; outward normals [f, d] and distances [f] (m) from the
    origin of the planes that bound it; volume, m^d, and surface, m^(d-1)."""

    vertices: np.ndarray
    normals: np.ndarray
    places: np.ndarray
    volume: float
    surface: float

    def without(self, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the normals and places of the planes but the one with a given normal."""
        kept = (self.normals != normal).any(axis=1)
        return self.normals[kept], self.places[kept]


def fits(one: Piece, other: Piece, normal: np.ndarray, tolerance: float) -> bool:
    """Return whether two pieces that touch at a plane make a convex one: each lies within the
    other's other planes. normal : of the plane, out of the first."""
    for piece, beyond, out in ((one, other, normal), (other, one, -normal)):
        normals, places = piece.without(out)
        if (beyond.vertices @ normals.T > places + tolerance).any():
            return False
    return True


def united(one: Piece, other: Piece, normal: np.ndarray, area: float) -> Piece:
    """Return two pieces that fit as one; normal, area : of the plane between them."""
    (normals, places), (others, further) = one.without(normal), other.without(-normal)
    return Piece(
        np.concatenate([one.vertices, other.vertices]),
        np.concatenate([normals, others]),
        np.concatenate([places, further]),
        one.volume + other.volume,
        one.surface + other.surface - 2 * area,
    )


class Contact(NamedTuple):
    """What two cells share: its area, m^(d-1), and its normal [d], out of the first."""

    area: float
    normal: np.ndarray


Beside = dict[int, dict[int, Contact]]


def pieces_of(body: Complex, cells: np.ndarray) -> tuple[dict[int, Piece], Beside]:
    """Return some cells (bool array [count]) as pieces by their numbers, and the cells beside each
    with what they share."""
    half = body.beside(cells)
    moments = facet_moments(body, half.facet)
    area = moments.size
    place = (body.origins(half) * half.outward).sum(axis=1)
    volume = cell_moments(body, half, moments).size
    corners = body.corners(half)
    first = np.searchsorted(corners[:, 0], np.arange(body.count + 1))
    found: dict[int, Piece] = {}
    beside: Beside = {int(cell): {} for cell in np.flatnonzero(cells)}
    order = np.argsort(half.cell, kind="stable")
    for own in np.split(order, np.flatnonzero(np.diff(half.cell[order])) + 1):
        cell = int(half.cell[own[0]])
        x = body.vertices[corners[first[cell] : first[cell + 1], 1]]
        found[cell] = Piece(
            x, half.outward[own], place[own], float(volume[cell]), float(area[own].sum())
        )
        for k in own[half.across[own] != OUTSIDE]:
            other = int(half.across[k])
            before = beside[cell].get(other)
            shared = float(area[k]) + (before.area if before else 0.0)
            beside[cell][other] = Contact(shared, half.outward[k])
    return found, beside


class Joiner:
    """Pieces that touch each other, joined if the result is convex.

    pieces : by their cells. beside : of each, the pieces that it may be joined to.
    """

    def __init__(self, pieces: dict[int, Piece], beside: Beside, tolerance: float) -> None:
        self.pieces, self.beside, self.tolerance = pieces, beside, tolerance
        self.root = {cell: cell for cell in pieces}

    def joined(self, count: int) -> np.ndarray:
        """Join pieces, the thinnest first, each across the largest face that can be; return the
        cell that each of `count` cells has become a part of."""
        while any([self._join(cell) for cell in sorted(self.pieces, key=self._thinness)]):
            pass
        root = np.arange(count)
        for cell in self.root:
            root[cell] = self._root_of(cell)
        return root

    def _thinness(self, cell: int) -> tuple[float, int]:
        return self.pieces[cell].volume / self.pieces[cell].surface, cell

    def _join(self, cell: int) -> bool:
        """Join a piece to a neighbour and return whether there is one that it fits."""
        if cell not in self.pieces:
            return False
        near = self.beside[cell]
        for other in sorted(near, key=lambda piece: (-near[piece].area, piece)):
            if fits(self.pieces[cell], self.pieces[other], near[other].normal, self.tolerance):
                self._absorb(cell, other)
                return True
        return False

    def _absorb(self, one: int, other: int) -> None:
        shared = self.beside[one].pop(other)
        piece = self.pieces.pop(other)
        self.pieces[one] = united(self.pieces[one], piece, shared.normal, shared.area)
        self.root[other] = one
        for third, contact in self.beside.pop(other).items():
            if third != one:
                del self.beside[third][other]
                before = self.beside[one].get(third)
                area = contact.area + (before.area if before else 0.0)
                self.beside[one][third] = Contact(area, contact.normal)
                self.beside[third][one] = Contact(area, -contact.normal)

    def _root_of(self, cell: int) -> int:
        while self.root[cell] != cell:
            cell = self.root[cell]
        return cell


def clipped(corners: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Return the corners of the part of a convex polygon or segment, in any dimension, where s, of
    each corner, is not negative."""
    after, ahead = np.roll(corners, -1, axis=0), np.roll(s, -1)
    crosses = s * ahead < 0
    if len(corners) == 2:
        crosses[1] = False  # no way back
    t = np.where(crosses, s / np.where(crosses, s - ahead, 1.0), 0.0)[:, None]
    pairs = np.stack([corners, corners + t * (after - corners)], axis=1)
    return pairs.reshape(-1, corners.shape[1])[np.stack([s >= 0, crosses], axis=1).ravel()]
