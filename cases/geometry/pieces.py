"""Cells that make a convex one with a neighbour, and are joined to it."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.cell_complex import Complex
from jointwave.cases.geometry.measure import cell_moments, facet_moments
from jointwave.cases.geometry.relations import groups


class Contact(NamedTuple):
    """What two cells share: its area, m^(d-1), its normal [d] out of the first, and whether a joint
    lies there that is kept where another contact will do."""

    area: float
    normal: np.ndarray
    joint: bool


class Piece(NamedTuple):
    """A convex cell: its vertices [n, d], m; outward normals [f, d] and distances [f] (m) from the
    origin of the planes that bound it; its volume over its surface, m; and, by their numbers, the
    cells beside it that it may be joined to."""

    vertices: np.ndarray
    normals: np.ndarray
    places: np.ndarray
    thickness: float
    beside: dict[int, Contact]

    def near(self) -> list[int]:
        """Return the cells beside it, that across the largest face first, but those beyond joints
        that are kept last."""
        return sorted(self.beside, key=lambda k: (self.beside[k].joint, -self.beside[k].area, k))

    def without(self, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the normals and places of the planes but those with a given normal."""
        kept = (self.normals != normal).any(axis=1)
        return self.normals[kept], self.places[kept]


def pieces_of(
    body: Complex, cells: np.ndarray, across: np.ndarray, kept: int = 0
) -> dict[int, Piece]:
    """Return some cells (bool array [count]) by their numbers.

    across : of which facets the cells may be joined, bool array [f]. kept : joint sets, the first
    ones, that are kept where that is possible.
    """
    half, found = body.beside(cells), dict[int, Piece]()
    moments, place, corners = facet_moments(body, half.facet), body.places(half), body.corners(half)
    area, volume = moments.size, cell_moments(body, half, moments).size
    joint = (body.joint_set >= 0) & (body.joint_set < kept)
    first = np.searchsorted(corners[:, 0], np.arange(body.count + 1))
    for own in groups(half.cell):
        cell, beside = int(half.cell[own[0]]), dict[int, Contact]()
        for k in own[across[half.facet[own]]]:
            shared = Contact(float(area[k]), half.outward[k], bool(joint[half.facet[k]]))
            _add(beside, int(half.across[k]), shared)
        x = body.vertices[corners[first[cell] : first[cell + 1], 1]]
        thickness = float(volume[cell] / area[own].sum())
        found[cell] = Piece(x, half.outward[own], place[own], thickness, beside)
    return found


def _add(beside: dict[int, Contact], other: int, more: Contact) -> None:
    area, _, joint = beside.get(other, (0.0, None, False))
    beside[other] = Contact(area + more.area, more.normal, joint or more.joint)


def fitting(
    pieces: dict[int, Piece], cell: int, near: Iterable[int], tolerance: float
) -> int | None:
    """Return the first of some cells beside another that make a convex one with it, each within the
    other's planes but the one between them; None where there is none."""
    one = pieces[cell]
    for k in near:
        other, normal = pieces[k], one.beside[k].normal
        for piece, (normals, places) in (
            (other, one.without(normal)),
            (one, other.without(-normal)),
        ):
            if (piece.vertices @ normals.T > places + tolerance).any():
                break
        else:
            return k
    return None


def joined(
    body: Complex, pieces: dict[int, Piece], order: Iterable[int], tolerance: float
) -> tuple[Complex | None, list[int]]:
    """Return a complex with some cells, in order, joined to the first one beside them that they
    fit; None where none fits any. And the cells that fit none. Changes the pieces."""
    root, stuck, count = np.arange(body.count), list[int](), len(pieces)
    for cell in order:
        if cell not in pieces:
            continue
        other = fitting(pieces, cell, pieces[cell].near(), tolerance)
        if other is None:
            stuck.append(cell)
        else:
            root[other] = cell
            _unite(pieces, cell, other)
    while (root[root] != root).any():
        root = root[root]
    return body.joined(root) if len(pieces) < count else None, stuck


def _unite(pieces: dict[int, Piece], cell: int, gone: int) -> None:
    """Make a piece one with another, which it fits."""
    one, other = pieces[cell], pieces.pop(gone)
    normal = one.beside.pop(gone).normal
    (normals, places), (others, further) = one.without(normal), other.without(-normal)
    pieces[cell] = one._replace(
        vertices=np.concatenate([one.vertices, other.vertices]),
        normals=np.concatenate([normals, others]),
        places=np.concatenate([places, further]),
    )
    for third, contact in other.beside.items():
        if third != cell:
            _add(one.beside, third, contact)
        if third in pieces and third != cell:
            _add(pieces[third].beside, cell, pieces[third].beside.pop(gone))


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
