"""Subdivision of higher-order cells into linear cells, for viewers."""

from itertools import permutations, product

import numpy as np

#: meshio's and VTK's names of the cells.
KINDS = {
    "interval": "line",
    "triangle": "triangle",
    "quadrilateral": "quad",
    "tetrahedron": "tetra",
    "hexahedron": "hexahedron",
}

#: Corners of the unit cell, in VTK's order.
CORNERS: dict[str, list[tuple[int, ...]]] = {
    "interval": [(0,), (1,)],
    "quadrilateral": [(0, 0), (1, 0), (1, 1), (0, 1)],
    "hexahedron": [
        *[(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
        *[(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    ],
}


def linear_cells(cell: str, nodes: np.ndarray) -> np.ndarray:
    """Return the linear cells between a cell's nodes, int array [parts, corners], in VTK's order.

    cell : "interval", "triangle", "quadrilateral", "tetrahedron" or "hexahedron".
    nodes : float array [nodes, dim], a full lattice of any order on the unit cell, in any order;
        points of a quadrilateral or hexahedron need not be equally spaced.
    """
    ranks = np.stack([np.unique(x.round(9), return_inverse=True)[1] for x in nodes.T], axis=-1)
    node_at = {tuple(place): i for i, place in enumerate(ranks.tolist())}
    order = int(ranks.max())
    if cell in CORNERS:
        boxes = product(range(order), repeat=nodes.shape[1])
        parts = [(np.array(place) + CORNERS[cell]).tolist() for place in boxes]
    else:
        parts = _simplices(nodes.shape[1], order)
    return np.array([[node_at[tuple(place)] for place in part] for part in parts])


def _simplices(dim: int, order: int) -> list[list[list[int]]]:
    """Return the lattice places of the corners of every simplex (Freudenthal's subdivision).

    In the sums s_i = x_i + ... + x_dim the simplex is s_1 >= s_2 >= ..., a union of the simplices
    along monotone paths between opposite corners of unit boxes.
    """
    parts = []
    for start, steps in product(
        product(range(order), repeat=dim), permutations(np.eye(dim, dtype=int))
    ):
        sums = np.cumsum([start, *steps], axis=0)
        if (np.diff(sums, axis=1) <= 0).all():
            x = sums - np.pad(sums, ((0, 0), (0, 1)))[:, 1:]
            if np.linalg.det(x[1:] - x[0]) < 0:
                x[[-2, -1]] = x[[-1, -2]]
            parts.append(x.tolist())
    return parts
