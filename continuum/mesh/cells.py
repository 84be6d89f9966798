"""The kinds of cells: their facets and orientation, in basix's order of corners.

Source: the reference cells of basix (Scroggs et al., J. Open Source Softw. 7(73), 3982, 2022);
quadrilaterals and hexahedra are numbered as tensor products, the first coordinate fastest.
"""

import numpy as np

#: By dimension and `numerics.continuum.cell`.
KINDS = {
    (1, "hexahedron"): "interval",
    (1, "simplex"): "interval",
    (2, "hexahedron"): "quadrilateral",
    (2, "simplex"): "triangle",
    (3, "hexahedron"): "hexahedron",
    (3, "simplex"): "tetrahedron",
}

DIMENSION = {kind: dim for (dim, _), kind in KINDS.items()}

CORNERS = {"interval": 2, "triangle": 3, "quadrilateral": 4, "tetrahedron": 4, "hexahedron": 8}

#: Corners of each facet, int array [facets, facet corners].
FACETS = {
    "interval": np.array([[0], [1]]),
    "triangle": np.array([[1, 2], [0, 2], [0, 1]]),
    "quadrilateral": np.array([[0, 1], [0, 2], [1, 3], [2, 3]]),
    "tetrahedron": np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]),
    "hexahedron": np.array(
        [[0, 1, 2, 3], [0, 1, 4, 5], [0, 2, 4, 6], [1, 3, 5, 7], [2, 3, 6, 7], [4, 5, 6, 7]]
    ),
}

#: Exchanges the first two coordinates of the reference cell: the mirrored cell.
MIRRORED = {
    "interval": [1, 0],
    "triangle": [0, 2, 1],
    "quadrilateral": [0, 2, 1, 3],
    "tetrahedron": [0, 2, 1, 3],
    "hexahedron": [0, 2, 1, 3, 4, 6, 5, 7],
}


def jacobians(kind: str, x: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Return the determinant of the Jacobian at every corner of every cell [cells, corners], m^dim.

    Simplices have one value; for a parallelepiped, positive values at all corners imply a positive
    Jacobian inside, for other tensor-product cells they are a good indicator.
    """
    edges = _edges_from_corners(kind)
    sides = x[cells[:, edges[:, :, 1]]] - x[cells[:, edges[:, :, 0]]]
    return np.linalg.det(sides)


def oriented(kind: str, x: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Return the cells, mirrored ones corrected so that the Jacobians are positive.

    A cell that is flat, or inverted only at some corners, is unchanged.
    """
    mirrored = (jacobians(kind, x, cells) < 0).all(axis=1)
    turned = cells.copy()
    turned[mirrored] = cells[mirrored][:, MIRRORED[kind]]
    return turned


def _edges_from_corners(kind: str) -> np.ndarray:
    """Return for each corner its edges along the reference axes, int array [corners, dim, 2]."""
    dim = DIMENSION[kind]
    if kind in ("interval", "triangle", "tetrahedron"):
        return np.array([[[0, axis + 1] for axis in range(dim)]])
    corners = np.arange(2**dim)[:, None]
    bit = 1 << np.arange(dim)
    return np.stack([corners & ~bit, corners | bit], axis=-1)
