"""Cutting the convex cells of a subdivision by parallel lines, all cells and lines together.

Each edge is cut once, by the lines of the cells on both of its sides, so that what was a joint's
end in one cell becomes a point of the other's edge. A cell becomes the slabs between its lines.
"""

from typing import NamedTuple

import numpy as np

from jointwave.cases.partition.lines import Lines
from jointwave.cases.partition.subdivision import NO_SET, OUTSIDE, Sliver, Subdivision


class Pieces(NamedTuple):
    """Edges after they are cut: points [p, 2], old ones first; ends [n, 2]; the edge that each is
    part of [n]; its two cells before [n, 2], and the codes of its ends in their families
    [n, side, end]."""

    points: np.ndarray
    ends: np.ndarray
    edge: np.ndarray
    cells: np.ndarray
    codes: np.ndarray


def cut_edges(sub: Subdivision, lines: Lines, touched: np.ndarray, tolerance: float) -> Pieces:
    """Return the touched edges (bool array [e]) cut by the lines of the cells beside them."""
    edge = np.flatnonzero(touched)
    ends, cells = sub.ends[edge], sub.cells[edge]
    family = np.append(lines.family, len(lines.first) - 2)[cells]
    s = sub.points @ lines.normal
    codes = lines.codes(
        np.repeat(s[ends][:, None, :], 2, axis=1), np.repeat(family[:, :, None], 2, 2), tolerance
    )
    which, t = _crossings(lines, family, codes, s[ends])
    chord = sub.points[ends[:, 1]] - sub.points[ends[:, 0]]
    which, t = _distinct(which, t, np.hypot(*chord.T), tolerance / 2)
    points = np.concatenate([sub.points, sub.points[ends[which, 0]] + t[:, None] * chord[which]])
    nodes, part = _chains(ends, which, len(sub.points))
    s = points @ lines.normal
    codes = lines.codes(
        np.repeat(s[nodes][:, None, :], 2, axis=1),
        np.repeat(family[part][:, :, None], 2, 2),
        tolerance,
    )
    return Pieces(points, nodes, edge[part], cells[part], codes)


def _crossings(
    lines: Lines, family: np.ndarray, codes: np.ndarray, s: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the crossings of lines and edges: the edge, and position on it, 0 to 1; unsorted."""
    first, after = (codes.min(axis=2) + 1) // 2, codes.max(axis=2) // 2
    number = np.maximum(after - first, 0).ravel()
    where = np.repeat(np.arange(number.size), number)
    line = np.arange(number.sum()) - np.repeat(np.cumsum(number) - number, number)
    place = lines.places[lines.first[family.ravel()[where]] + first.ravel()[where] + line]
    edge = where // 2
    return edge, (place - s[edge, 0]) / (s[edge, 1] - s[edge, 0])


def _distinct(
    edge: np.ndarray, t: np.ndarray, length: np.ndarray, tolerance: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return crossings in order along their edges, those within the tolerance as one."""
    order = np.lexsort([t, edge])
    edge, t = edge[order], t[order]
    new = np.ones(len(edge), bool)
    new[1:] = (np.diff(edge) > 0) | (np.diff(t) * length[edge[1:]] > tolerance)
    return edge[new], t[new]


def _chains(ends: np.ndarray, which: np.ndarray, first: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the pieces [n, 2] of edges cut at new points, from index `first` on, in order along
    the edges `which`; and the edge that each is part of [n]."""
    number = np.bincount(which, minlength=len(ends))
    begin = np.cumsum(number + 2) - (number + 2)
    nodes = np.empty((number + 2).sum(), np.int64)
    nodes[begin], nodes[begin + number + 1] = ends[:, 0], ends[:, 1]
    inner = np.ones(len(nodes), bool)
    inner[begin] = inner[begin + number + 1] = False
    nodes[inner] = first + np.arange(len(which))
    starts = np.ones(len(nodes), bool)
    starts[begin + number + 1] = False
    at = np.flatnonzero(starts)
    return np.stack([nodes[at], nodes[at + 1]], axis=1), np.repeat(np.arange(len(ends)), number + 1)


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
