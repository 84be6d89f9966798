"""Cut the convex cells of a complex by families of parallel planes, all in one pass.

Vertices are classified as on a plane or between two. Edges, faces and cells are then split in this
order by the planes of the cells that they belong to, so that each part lies in one slab between
planes. A split k-cell gains a (k-1)-cell in each plane, bounded by its (k-2)-cells in that plane
and shared by the slabs on both sides. A facet that is split for one of its two cells is therefore
split for the other too.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from jointwave.cases.geometry.cell_complex import NO_SET, OUTSIDE, Complex, Sliver
from jointwave.cases.geometry.relations import Lookup, composed, counted, distinct, ranges

GRAZING = "joints meet at a grazing angle"


@dataclass(frozen=True)
class Planes:
    """Families of parallel planes: one family for each group of cells.

    The place of a plane is its distance from the origin along the normal. A vertex has code 2 j + 1
    on plane j, and 2 j between planes j - 1 and j; edges, faces and cells have the range of their
    vertices' codes.

    normal : float array [d], unit vector.
    family : int array [cells], family of each cell, or -1 for cells that are not cut.
    places : float array [p], m, of all planes, increasing, further apart than the tolerance.
    held : the planes of each family, int pairs (family, plane), sorted.
    base : int array [families], signed number of a family's first plane.
    joint_set : index of the joint set of the planes, or NO_SET.
    """

    normal: np.ndarray
    family: np.ndarray
    places: np.ndarray
    held: np.ndarray
    base: np.ndarray
    joint_set: int

    def codes(self, s: np.ndarray, tolerance: float) -> np.ndarray:
        """Return the codes of vertices at distances s along the normal, float array [n], m."""
        at = np.searchsorted(self.places, s - tolerance)
        near = np.append(self.places, np.inf)[at] <= s + tolerance
        return 2 * at + near


def planes_of(
    normal: np.ndarray,
    family: np.ndarray,
    each: Sequence[np.ndarray],
    base: Sequence[int] | None = None,
    joint_set: int = NO_SET,
    tolerance: float = 0.0,
) -> Planes:
    """Return families of planes from the places of each, m, increasing; planes within the tolerance
    (m) are merged. base : 0 where absent. For the others see `Planes`."""
    places = np.concatenate(each)
    order = np.argsort(places, kind="stable")
    new = np.diff(places[order], prepend=-np.inf) > tolerance
    number = np.empty(len(places), np.int64)
    number[order] = np.cumsum(new) - 1
    held = np.stack([np.repeat(np.arange(len(each)), list(map(len, each))), number], axis=1)
    signed = np.zeros(len(each), np.int64) if base is None else np.array(base)
    return Planes(normal, family, places[order][new], held, signed, joint_set)


def one_plane(normal: np.ndarray, place: float, cells: np.ndarray) -> Planes:
    """Return one plane, of no joint set, that cuts some cells (bool array [cells])."""
    return planes_of(normal, np.where(cells, 0, -1), [np.array([place])])


class Cut(NamedTuple):
    """A complex after a cut; for each cell its parent before the cut, and the signed number of the
    plane below it, int arrays [count]."""

    body: Complex
    parent: np.ndarray
    number: np.ndarray


def cut(body: Complex, planes: Planes, tolerance: float) -> Cut:
    """Return a complex with its cells cut by their planes.

    Vertices within the tolerance (m) of a plane are on it. A cell's first slab keeps its index; the
    others are appended. Raises Sliver where a plane that cuts a cell contains one of its facets.
    """
    work = _Work(body, planes, tolerance)
    for k in range(1, body.dim + 1):
        work.split(k)
    return work.finished()


class _Work:
    """A complex while it is cut. Lists have one entry for each dimension k of cells, 0 to d.

    number : of k-cells. rows : int arrays [m, 2], k-cells with their bounding (k-1)-cells, sorted.
    codes : least and largest vertex code of each k-cell, int arrays [n, 2]; least > largest marks
    cells that are not cut. crossed : pairs (k-cell, plane) at which k-cells are split, sorted.
    parts : pairs (k-cell, part above each of these planes). vertices : float arrays [n, d], m.
    """

    def __init__(self, body: Complex, planes: Planes, tolerance: float) -> None:
        self.body, self.planes, dim = body, planes, body.dim
        half = body.halves(np.append(planes.family >= 0, False)[body.sides].any(axis=1))
        top = np.stack([half.cell, half.facet], axis=1)
        top = top[np.argsort(half.cell, kind="stable")]
        self.rows = [np.empty((0, 2), np.int64), *body.bounds, top]
        self.number = body.numbers()
        self.vertices = [body.vertices]
        code = planes.codes(body.vertices @ planes.normal, tolerance)
        self.codes = [np.stack([code, code], axis=1)]
        for k in range(1, dim + 1):
            self.codes.append(_span(self.rows[k], self.codes[k - 1], self.number[k]))
        self.codes[dim][planes.family < 0] = [1, 0]
        self.held = Lookup(planes.held, len(planes.places) + 1)
        cell = np.flatnonzero(planes.family >= 0)
        family, (low, high) = planes.family[cell], self.codes[-1][cell].T
        first, after = self.held.index(family, (low + 1) // 2), self.held.index(family, high // 2)
        at, which = ranges(first, after)  # planes of the cell's family between its vertices
        none = np.empty((0, 2), np.int64)
        self.crossed, self.parts = [none] * (dim + 1), [none] * (dim + 1)
        self.crossed[dim] = np.stack([cell[which], planes.held[at, 1]], axis=1)
        for k in range(dim, 1, -1):  # planes that split k-cells also split their boundaries
            split = np.zeros(self.number[k], bool)
            split[self.crossed[k][:, 0]] = True
            rows = self.rows[k][split[self.rows[k][:, 0]]]
            found = composed(rows[:, ::-1], self.crossed[k])[0]
            low, high = self.codes[k - 1][found[:, 0]].T
            code = 2 * found[:, 1] + 1
            self.crossed[k - 1] = distinct(found[(low < code) & (code < high)])

    def split(self, k: int) -> None:
        """Split the k-cells, whose (k-1)-cells are already split, and add their sections."""
        cross = Lookup(self.crossed[k], len(self.planes.places) + 1)
        (cell, plane), first = self.crossed[k].T, self.number[k]
        mine = np.isin(self.rows[k][:, 1], self.parts[k - 1][:, 0])  # bounded by split (k-1)-cells
        more = composed(self.rows[k][mine], self.parts[k - 1])[0]
        self.rows[k] = np.concatenate([self.rows[k], more])
        gained = self.number[k - 1] + np.arange(len(cell))
        above = first + np.arange(len(cell))
        begins = np.diff(cell, prepend=-1) > 0
        below = np.where(begins, cell, above - 1)
        self._bound_gained(k, cross)
        rows = self.rows[k]
        mine = np.isin(rows[:, 0], cell[begins])
        owner, part = rows[mine].T
        low, high = self.codes[k - 1][part].T
        flat = (low == high) & (low % 2 == 1) & cross.holds(owner, low // 2)
        if k > 1 and flat.any():
            raise self._grazing_error(k - 1, part[np.argmax(flat)])
        slab = cross.below(owner, (low + 1) // 2)
        rows[mine, 0] = np.where(slab == 0, owner, first + cross.index(owner, 0 * owner) + slab - 1)
        new = np.concatenate([np.stack([below, gained], axis=1), np.stack([above, gained], axis=1)])
        rows = np.concatenate([rows, new])
        self.rows[k] = rows[np.argsort(rows[:, 0], kind="stable")]
        code = 2 * plane + 1
        ends, last = np.append(code[1:], 0), np.append(begins[1:], True)
        ends, last = ends[: len(cell)], last[: len(cell)]
        ends[last] = self.codes[k][cell[last], 1]
        self.codes[k][cell[begins], 1] = code[begins]
        self.codes[k] = np.concatenate([self.codes[k], np.stack([code, ends], axis=1)])
        self.codes[k - 1] = np.concatenate([self.codes[k - 1], np.stack([code, code], axis=1)])
        self.parts[k] = np.stack([cell, above], axis=1)
        self.number[k] += len(cell)
        self.number[k - 1] += len(cell)

    def _bound_gained(self, k: int, cross: Lookup) -> None:
        """Bound the new sections by vertices (k = 1) or by the (k-2)-cells in the planes."""
        cell, plane = cross.pairs.T
        if k == 1:
            at = np.searchsorted(self.rows[1][:, 0], cell)
            one, other = self.rows[1][at, 1], self.rows[1][at + 1, 1]
            x = np.concatenate(self.vertices)
            s = x @ self.planes.normal
            t = (self.planes.places[plane] - s[one]) / (s[other] - s[one])
            found = x[one] + t[:, None] * (x[other] - x[one])
            left = self.planes.places[plane] - found @ self.planes.normal
            self.vertices.append(found + left[:, None] * self.planes.normal)
            return
        rows = self.rows[k][np.isin(self.rows[k][:, 0], cell)]
        found = composed(rows, self.rows[k - 1])[0]
        low, high = self.codes[k - 2][found[:, 1]].T
        found, low = found[(low == high) & (low % 2 == 1)], low[(low == high) & (low % 2 == 1)]
        inside = cross.holds(found[:, 0], low // 2)
        which = cross.index(found[inside, 0], low[inside] // 2)
        bound = distinct(np.stack([which, found[inside, 1]], axis=1))
        self._check_closed(k, bound, len(cell))
        bound[:, 0] += self.number[k - 1]
        self.rows[k - 1] = np.concatenate([self.rows[k - 1], bound])

    def _check_closed(self, k: int, bound: np.ndarray, number: int) -> None:
        """Raise Sliver unless each section has two ends (k = 2) or closed edges (k = 3)."""
        ends, times = bound, np.bincount(bound[:, 0], minlength=number)
        wrong = np.flatnonzero(times != 2 if k == 2 else times < 3)
        if not len(wrong) and k == 3:
            ends = composed(bound, self.rows[1])[0]
            keys, count = counted(ends)
            wrong = keys[count != 2, 0]
        if len(wrong):
            raise self._grazing_error(k, self.crossed[k][wrong[0], 0])

    def _grazing_error(self, k: int, cell: int) -> Sliver:
        """Return the Sliver error, located at the first vertex of a k-cell."""
        for level in range(k, 0, -1):
            cell = self.rows[level][np.searchsorted(self.rows[level][:, 0], cell), 1]
        return Sliver(np.concatenate(self.vertices)[cell], GRAZING)

    def finished(self) -> Cut:
        """Return the complex after the cut."""
        body, planes, dim = self.body, self.planes, self.body.dim
        normals, plane, turned = body.with_normal(planes.normal)
        split, (whole, above) = self.parts[dim - 1][:, 0], self.parts[dim].T
        parent, gained = np.append(np.arange(body.count), whole), len(above)

        def of_facets(array: np.ndarray, value: int) -> np.ndarray:
            return np.concatenate([array, array[split], np.full(gained, value)])

        cells, facets = self.rows[dim].T
        into = of_facets(body.sides[:, 1], 0)[facets] == parent[cells]
        new = facets - len(body.sides) - len(split)  # index among the facets gained
        into[new >= 0] = (cells[new >= 0] == above[new[new >= 0]]) != turned
        sides = np.full((self.number[dim - 1], 2), OUTSIDE)
        sides[: len(body.sides)] = body.sides
        sides[facets, into.astype(np.int64)] = cells
        family, joint_set = planes.family[parent], of_facets(body.joint_set, planes.joint_set)
        low, high = self.codes[dim - 1].T  # existing facets on a cell's plane: joints
        on = np.flatnonzero((low == high) & (low % 2 == 1) & (joint_set == NO_SET))
        here = [
            self.held.holds(k, low[on] // 2) & (k >= 0) for k in np.append(family, -1)[sides[on]].T
        ]
        joint_set[on[np.any(here, axis=0)]] = planes.joint_set
        found = Complex(
            vertices=np.concatenate(self.vertices),
            bounds=tuple(self.rows[1:dim]),
            sides=sides,
            plane=of_facets(body.plane, plane),
            joint_set=joint_set,
            side=of_facets(body.side, 0),
            normals=normals,
            region=body.region[parent],
            count=self.number[dim],
        )
        low, number = self.codes[dim][:, 0], np.full(found.count, -1)
        mine = np.flatnonzero(family >= 0)
        slab = self.held.below(family[mine], (low[mine] + 1) // 2)
        number[mine] = planes.base[family[mine]] + slab - 1
        return Cut(found, parent, number)


def _span(rows: np.ndarray, codes: np.ndarray, number: int) -> np.ndarray:
    """Return the least and largest code [number, 2] over the bounding cells of each cell."""
    found = np.tile(np.array([1, 0]), (number, 1))
    if len(rows):
        begins = np.flatnonzero(np.diff(rows[:, 0], prepend=-1))
        below = codes[rows[:, 1]]
        found[rows[begins, 0], 0] = np.minimum.reduceat(below[:, 0], begins)
        found[rows[begins, 0], 1] = np.maximum.reduceat(below[:, 1], begins)
    return found
