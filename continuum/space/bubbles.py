"""Triangles and tetrahedra of order 2 with bubbles, for a diagonal mass matrix.

The row sums of the plain order-2 mass matrix are zero or negative. With the bubbles lambda_i
lambda_j lambda_k of each face, and in space the product of all four, the triangle has 7 nodes and
the tetrahedron 15, at corners and the middles of edges, faces and cell, and row sums are positive
(Cohen, Joly, Roberts & Tordjman, SIAM J. Numer. Anal. 38, 2001; Geevers, Mulder & van der Vegt,
SIAM J. Sci. Comput. 40, 2018).
"""

from functools import cache
from itertools import combinations, combinations_with_replacement
from typing import Any

import basix
import numpy as np

from jointwave.continuum.space.compat import custom_element, quadrature

DEGREE = {"triangle": 3, "tetrahedron": 4}  # of the highest bubble


@cache
def bubble_element(kind: str) -> Any:
    """Return the basix element of order 2 with bubbles, one function a node."""
    cell, degree = getattr(basix.CellType, kind), DEGREE[kind]
    corners = np.asarray(basix.geometry(cell))
    at, weight = quadrature(kind, 2 * degree)
    shares = np.column_stack([1 - at.sum(axis=1), at])
    number = shares.shape[1]
    faces = [one for k in range(3, number + 1) for one in combinations(range(number), k)]
    products = [*combinations_with_replacement(range(number), 2), *faces]
    functions = [shares[:, list(one)].prod(axis=1) for one in products]
    legendre = basix.tabulate_polynomials(basix.PolynomialType.legendre, cell, degree, at)
    legendre = legendre if len(legendre) != len(at) else legendre.T
    span = np.linalg.qr((np.array(functions) * weight @ legendre.T).T)[0].T
    middles = [
        [corners[list(one)].mean(axis=0)[None] for one in entities]
        for entities in basix.topology(cell)
    ]
    return custom_element(kind, span, middles, 2, degree)
