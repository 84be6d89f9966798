"""Cutting the convex cells of a subdivision by parallel lines, all cells and lines together.

Each edge is cut once, by the lines of the cells on both of its sides, so that what was a joint's
end in one cell becomes a point of the other's edge. A cell becomes the slabs between its lines.
"""

from typing import NamedTuple

import numpy as np

from cases.partition.faults import Sliver
from cases.partition.lines import Lines
from cases.partition.pieces import Pieces, cut_edges
from cases.partition.subdivision import NO_SET, OUTSIDE, Subdivision


class Split(NamedTuple):
    """A subdivision after a cut; of each of its cells the one that it was part of, and the signed
    number of the line below it (int arrays [count])."""

    subdivision: Subdivision
    parent: np.ndarray
    number: np.ndarray


def split(sub: Subdivision, lines: Lines, tolerance: float) -> Split:
    """Return a subdivision with its cells cut by their lines.

    Points within the tolerance (m) of a line are on it. A cell's first slab keeps its index, the
    others come after all cells that there were. Raises Sliver where lines meet within the
    tolerance at more than a point.
    """
    empty = len(lines.first) - 2
    touched = (np.append(lines.family, empty)[sub.cells] != empty).any(axis=1)
    pieces = cut_edges(sub, lines, touched, tolerance)
    slabs = _slabs(sub, lines, pieces)
    ends, cells = _new_edges(sub, lines, pieces, slabs)
    carrier = np.full(len(ends), len(sub.directions))
    old, edge = ~touched, pieces.edge
    found = Subdivision(
        points=pieces.points,
        ends=np.concatenate([sub.ends[old], pieces.ends, ends]),
        cells=np.concatenate([sub.cells[old], slabs.of_pieces, cells]),
        line=np.concatenate([sub.line[old], _lines(sub, lines, pieces), carrier]),
        side=np.concatenate([sub.side[old], sub.side[edge], np.zeros(len(ends), np.int64)]),
        along=np.concatenate([sub.along[old], _along(sub, lines, pieces), carrier * 0 + NO_SET]),
        directions=np.concatenate([sub.directions, lines.direction[None]]),
        joint_set=np.append(sub.joint_set, lines.joint_set),
        region=sub.region[slabs.parent],
        count=len(slabs.parent),
    )
    number = lines.base[lines.family[slabs.parent]] + slabs.slab - 1
    return Split(found, slabs.parent, number)


def _along(sub: Subdivision, lines: Lines, pieces: Pieces) -> np.ndarray:
    """Return the joint set along each piece of the boundary [n], these lines' own included."""
    outer = (pieces.cells == OUTSIDE).any(axis=1)
    return np.where(_on_line(pieces) & outer, lines.joint_set, sub.along[pieces.edge])


def _lines(sub: Subdivision, lines: Lines, pieces: Pieces) -> np.ndarray:
    """Return the direction of each piece [n]: a joint along a cut through rock is what it is."""
    line, inner = sub.line[pieces.edge], (pieces.cells != OUTSIDE).all(axis=1)
    joint = inner & _on_line(pieces) & (sub.joint_set[line] == NO_SET)
    return np.where(joint & (lines.joint_set != NO_SET), len(sub.directions), line)


def _on_line(pieces: Pieces) -> np.ndarray:
    """Return which pieces lie on a line of one of their cells, bool array [n]."""
    one, other = np.moveaxis(pieces.codes, 2, 0)
    return ((one % 2 == 1) & (one == other) & (pieces.cells != OUTSIDE)).any(axis=1)


class _Slabs(NamedTuple):
    """The new cells: parent and slab [count]; those beside each piece [n, 2]; the range of codes
    of each old cell, and its first new one beside itself [cells]."""

    parent: np.ndarray
    slab: np.ndarray
    of_pieces: np.ndarray
    least: np.ndarray
    most: np.ndarray
    first: np.ndarray


def _slabs(sub: Subdivision, lines: Lines, pieces: Pieces) -> _Slabs:
    least, most = np.full(sub.count, np.iinfo(np.int64).max), np.full(sub.count, -1)
    for side in (0, 1):
        inside = pieces.cells[:, side] != OUTSIDE
        cell, codes = pieces.cells[inside, side], pieces.codes[inside, side]
        np.minimum.at(least, cell, codes.min(axis=1))
        np.maximum.at(most, cell, codes.max(axis=1))
    least[most < 0], most[most < 0] = 0, 0  # cells that no line touches
    low, high = (least + 1) // 2, most // 2
    more = high - low
    first = sub.count + np.cumsum(more) - more
    parent = np.concatenate([np.arange(sub.count), np.repeat(np.arange(sub.count), more)])
    new = np.arange(more.sum()) - np.repeat(first - sub.count, more)
    slab = np.concatenate([low, np.repeat(low, more) + 1 + new])
    found = _Slabs(parent, slab, pieces.cells, least, most, first)
    return found._replace(of_pieces=_beside(sub, pieces, found))


def _cell_of(slabs: _Slabs, cell: np.ndarray, slab: np.ndarray) -> np.ndarray:
    """Return the new cell that is a slab of an old one."""
    step = slab - (slabs.least[cell] + 1) // 2
    return np.where(step == 0, cell, slabs.first[cell] + step - 1)


def _beside(sub: Subdivision, pieces: Pieces, slabs: _Slabs) -> np.ndarray:
    """Return the new cells on both sides of each piece [n, 2]."""
    cell, (one, other) = pieces.cells, np.moveaxis(pieces.codes, 2, 0)
    along = (one % 2 == 1) & (one == other)  # on a line: the whole cell lies on one side of it
    least, most = slabs.least[cell], slabs.most[cell]
    inside = (cell != OUTSIDE) & along & (least < one) & (one < most)
    if inside.any():
        at = pieces.points[pieces.ends[np.flatnonzero(inside.any(axis=1))[0], 0]]
        raise Sliver(at, "joints meet at a grazing angle")
    slab = np.where(
        one % 2 == 0, one // 2, np.where(other % 2 == 0, other // 2, (one + other) // 4)
    )
    slab = np.where(along, one // 2 + (most > one), slab)
    return np.where(cell == OUTSIDE, OUTSIDE, _cell_of(slabs, cell, slab))


def _new_edges(
    sub: Subdivision, lines: Lines, pieces: Pieces, slabs: _Slabs
) -> tuple[np.ndarray, np.ndarray]:
    """Return the joints across cells: ends [n, 2], and cells to the left and right [n, 2]."""
    cell = np.repeat(pieces.cells[:, :, None], 2, axis=2).ravel()
    point = np.repeat(pieces.ends[:, None, :], 2, axis=1).ravel()
    code = pieces.codes.ravel()
    across = (code % 2 == 1) & (cell != OUTSIDE)
    across &= (slabs.least[cell] < code) & (code < slabs.most[cell])
    cell, point, code = cell[across], point[across], code[across]
    order = np.lexsort([pieces.points[point] @ lines.direction, point, code, cell])
    cell, point, code = cell[order], point[order], code[order]
    new = np.ones(len(cell), bool)
    new[1:] = (np.diff(cell) != 0) | (np.diff(code) != 0) | (np.diff(point) != 0)
    return _paired(lines, pieces.points, slabs, cell[new], point[new], code[new])


def _paired(
    lines: Lines,
    points: np.ndarray,
    slabs: _Slabs,
    cell: np.ndarray,
    point: np.ndarray,
    code: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the edges between the two points that a line has in common with a cell's outline."""
    begins = np.ones(len(cell), bool)
    begins[1:] = (np.diff(cell) != 0) | (np.diff(code) != 0)
    at = np.flatnonzero(begins)
    wrong = np.diff(np.append(at, len(cell))) != 2
    if wrong.any():
        raise Sliver(points[point[at[wrong][0]]], "joints meet at a grazing angle")
    one, other, cell, line = point[at], point[at + 1], cell[at], code[at] // 2
    swap = (points[one] - points[other]) @ lines.direction > 0
    ends = np.where(swap[:, None], np.stack([other, one], 1), np.stack([one, other], 1))
    beside = [_cell_of(slabs, cell, line + 1), _cell_of(slabs, cell, line)]
    return ends, np.stack(beside, axis=1)
