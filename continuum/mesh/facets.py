"""The facets of a mesh: those on the outside, on the end faces, and in pairs at joints."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from jointwave.continuum.mesh.cells import FACETS
from jointwave.continuum.mesh.description import Joints, Part, Side

#: Tolerated distance between coincident facets, relative to that from a facet to the middle of its
#: cell.
APART = 1e-4


class Facets(NamedTuple):
    """Facets of a mesh, each with one of its cells.

    cell : int array [facets], cell numbers as in `Side`.
    corners : float array [facets, facet corners, dim], m.
    inside : float array [facets, dim], the middle of the cell, m.
    """

    cell: np.ndarray
    corners: np.ndarray
    inside: np.ndarray

    @property
    def middle(self) -> np.ndarray:
        """Mean of the corners, float array [facets, dim], m."""
        return self.corners.mean(axis=1)

    @property
    def along(self) -> int:
        """The axis along the pillar: y is the first in dim 1, else the second."""
        return min(1, self.corners.shape[2] - 1)

    @property
    def y(self) -> np.ndarray:
        """Place along the pillar, float array [facets], m."""
        return self.middle[:, self.along]

    def chosen(self, choice: np.ndarray) -> "Facets":
        """Return a selection of the facets, by mask or indices."""
        return Facets(*(field[choice] for field in self))

    def side(self, choice: np.ndarray) -> Side:
        """Return a selection of the facets as a `Side`."""
        return Side(self.cell[choice], self.corners[choice])


def facet_numbers(kind: str, cells: np.ndarray) -> np.ndarray:
    """Return a number for each facet of each cell, int array [cells * facets], cell by cell.

    Facets with the same vertices, in any order, have the same number.
    """
    table = FACETS[kind]
    return row_numbers(np.sort(cells[:, table].reshape(-1, table.shape[1]), axis=1))


def row_numbers(rows: np.ndarray) -> np.ndarray:
    """Return a number for each row [n, m], the same for equal rows, int array [n]."""
    order = np.lexsort(rows.T)
    differs = (rows[order[1:]] != rows[order[:-1]]).any(axis=1)
    number = np.empty(len(rows), dtype=np.int64)
    number[order] = np.r_[0, np.cumsum(differs)]
    return number


def shared_facets(kind: str, cells: np.ndarray) -> np.ndarray:
    """Return the pairs of facets shared by two cells, int array [2, pairs], in the order of
    `facet_numbers`."""
    number = facet_numbers(kind, cells)
    order = np.argsort(number, kind="stable")
    shared = number[order[1:]] == number[order[:-1]]
    return np.stack([order[:-1][shared], order[1:][shared]])


def outer(kind: str, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return cell and local number of the facets that belong to only one cell, int arrays."""
    number = facet_numbers(kind, cells)
    alone = np.flatnonzero(np.bincount(number)[number] == 1)
    return np.divmod(alone, len(FACETS[kind]))


def facet_vertices(kind: str, cells: np.ndarray, cell: np.ndarray, facet: np.ndarray) -> np.ndarray:
    """Return the vertices of some cells' facets, int array [facets, facet corners]."""
    return np.take_along_axis(cells[cell], FACETS[kind][facet], axis=1)


def outer_facets(kind: str, parts: tuple[Part, ...]) -> Facets:
    """Return the facets on the outside of all copies of all parts."""
    found, first = [], 0
    for part in parts:
        found.append(on_copies(kind, part, *outer(kind, part.cells), first))
        first += len(part.cells) * part.copies
    return Facets(*(np.concatenate(fields) for fields in zip(*found, strict=True)))


def on_copies(kind: str, part: Part, cell: np.ndarray, facet: np.ndarray, first: int = 0) -> Facets:
    """Return facets of a part's cells on all its copies; its cells are numbered from `first`."""
    corners = part.x[facet_vertices(kind, part.cells, cell, facet)]
    inside = part.x[part.cells[cell]].mean(axis=1)
    copy = first + len(part.cells) * np.arange(part.copies)
    shift = part.shifts[:, None]
    return Facets(
        (copy[:, None] + cell).ravel(),
        (shift[:, None] + corners).reshape(-1, *corners.shape[1:]),
        (shift + inside).reshape(-1, inside.shape[1]),
    )


def lies_at(facets: Facets, y: float, tolerance: float) -> np.ndarray:
    """Return which facets lie across the pillar at y (m), all corners within the tolerance (m)."""
    return (np.abs(facets.corners[..., facets.along] - y) <= tolerance).all(axis=1)


def lies_across(facets: Facets, tolerance: float) -> np.ndarray:
    """Return which facets lie across the pillar anywhere, within the tolerance (m)."""
    return np.ptp(facets.corners[..., facets.along], axis=1) <= tolerance


def pairs(facets: Facets) -> np.ndarray:
    """Return the pairs of facets at the same place, of different cells, int array [pairs, 2]."""
    middle = facets.middle
    apart = APART * np.linalg.norm(facets.inside - middle, axis=1).min(initial=np.inf)
    if not np.isfinite(apart):
        return np.empty((0, 2), dtype=np.int64)
    found = cKDTree(middle).query_pairs(apart, output_type="ndarray")
    one, other = (facets.corners[found[:, i]] for i in (0, 1))
    distance = np.linalg.norm(one[:, :, None] - other[:, None], axis=-1)
    same = (distance.min(axis=2) <= apart).all(axis=1)
    return found[same & (facets.cell[found[:, 0]] != facets.cell[found[:, 1]])]


def joints(facets: Facets, pair: np.ndarray, number: np.ndarray) -> Joints:
    """Return facet pairs as joints, sorted by the joint's number (int array [pairs])."""
    swapped = ~is_left(facets.chosen(pair[:, 0]))
    left, right = np.where(swapped[:, None], pair[:, ::-1], pair).T
    order = np.lexsort((facets.cell[left], number))
    left, right = left[order], right[order]
    return Joints(number[order], facets.cell[left], facets.cell[right], facets.corners[left])


def is_left(facets: Facets) -> np.ndarray:
    """Return whether each facet's cell is on its side towards y = 0, bool array [facets].

    For a facet along the pillar, left is towards negative x, then z.
    """
    normal = normals(facets)
    across = [axis for axis in range(normal.shape[1]) if axis != facets.along]
    leading = normal[:, [facets.along, *across]]
    first = (np.abs(leading) > 1e-6).argmax(axis=1)[:, None]
    sign = np.sign(np.take_along_axis(leading, first, axis=1)[:, 0])
    return sign * ((facets.inside - facets.middle) * normal).sum(axis=1) < 0


def normals(facets: Facets) -> np.ndarray:
    """Return a unit normal of each facet [facets, dim], of either sign; the mean of a warped one.

    The mean normal of a quadrilateral is along the vector product of its diagonals.
    """
    x, (corners, dim) = facets.corners, facets.corners.shape[1:]
    if dim == 1:
        return np.ones((len(x), 1))
    if dim == 2:
        edge = x[:, 1] - x[:, 0]
        normal = np.stack([-edge[:, 1], edge[:, 0]], axis=1)
    elif corners == 3:
        normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    else:
        normal = np.cross(x[:, 3] - x[:, 0], x[:, 2] - x[:, 1])
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)
