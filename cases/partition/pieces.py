"""Edges cut by the lines of the cells on both of their sides."""

from typing import NamedTuple

import numpy as np

from cases.partition.lines import Lines
from cases.partition.subdivision import Subdivision


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
