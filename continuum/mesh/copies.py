"""Pieces of a mesh that are copies of each other."""

import numpy as np

from jointwave.continuum.mesh.description import Part

ALIKE = 1e-9  # of the body: tolerance for pieces to be copies of each other
REPEATED = 6  # least number of copies for SIMD lanes of their own


def moved_alike(vertices: np.ndarray, tied: np.ndarray | None) -> np.ndarray:
    """Return vertices with each replaced by the one whose motion it has; tied : as in `Part`."""
    for row in () if tied is None else tied:
        vertices = np.where(row[vertices] >= 0, row[vertices], vertices)
    return vertices


def tied_together(ties: list[np.ndarray | None], first: np.ndarray) -> np.ndarray | None:
    """Return the ties of parts whose vertices are numbered from `first` on; None without."""
    each = [np.where(t >= 0, t + n, -1) for t, n in zip(ties, first, strict=True) if t is not None]
    return np.concatenate(each, axis=1) if each else None


def parts_of_pieces(
    x: np.ndarray,
    cells: np.ndarray,
    piece: np.ndarray,
    material: np.ndarray,
    tied: np.ndarray | None = None,
) -> tuple[tuple[Part, ...], np.ndarray]:
    """Return the pieces of the rock as parts, and the new number of each cell; tied : as in `Part`.

    Equal pieces are copies; those with few copies form one part together.
    """
    own = np.split(np.argsort(piece, kind="stable"), np.cumsum(np.bincount(piece))[:-1])
    alike: dict[bytes, list[np.ndarray]] = {}
    for some in own:
        vertices, local = _in_order(cells[some])
        shape = np.rint((x[vertices] - x[vertices[0]]) / (ALIKE * np.ptp(x, axis=0).max()))
        key = shape.tobytes() + local.tobytes() + material[some].tobytes()
        if tied is not None:
            key += _within(tied, vertices).tobytes()
        alike.setdefault(key, []).append(some)
    groups = [some for some in alike.values() if len(some) >= REPEATED]
    alone = [one for some in alike.values() if len(some) < REPEATED for one in some]
    if alone:
        groups.append([np.sort(np.concatenate(alone))])
    number, parts = np.empty(len(cells), dtype=np.int64), []
    ordered = np.concatenate([cells_of for group in groups for cells_of in group])
    number[ordered] = np.arange(len(cells))
    for group in groups:
        vertices, local = _in_order(cells[group[0]])
        first = np.array([cells[one[0], 0] for one in group])
        shifts = x[first] - x[first[0]]
        ties = None if tied is None else _within(tied, vertices)
        parts.append(Part(x[vertices], local, material[group[0]], shifts, ties))
    return tuple(parts), number


def _within(tied: np.ndarray, vertices: np.ndarray) -> np.ndarray:
    """Return what vertices are tied to, by their places among them [pairs, n]; -1 of others."""
    order = np.argsort(vertices)
    to = tied[:, vertices]
    place = order[np.searchsorted(vertices[order], np.maximum(to, vertices.min()))]
    return np.where(to >= 0, place, -1)


def _in_order(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertices in the order in which cells use them, and the cells in this numbering."""
    vertices, first, local = np.unique(cells, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(order.size, dtype=np.int64)
    rank[order] = np.arange(order.size)
    return vertices[order], rank[local].reshape(cells.shape)
