"""Linear cells fill the cell whose nodes they join, whatever its order and the nodes' order."""

from math import factorial

import numpy as np
import pytest

from jointwave.results.subcells import CORNERS, linear_cells

LOBATTO = {1: [0, 1], 2: [0, 0.5, 1], 3: [0, 0.27639, 0.72361, 1], 4: [0, 0.17267, 0.5, 0.82733, 1]}
BOXES = {"interval": 1, "quadrilateral": 2, "hexahedron": 3}
SIMPLICES = {"triangle": 2, "tetrahedron": 3}


def lattice(axis, dim):
    """Return all points of an axis's powers, in an order that no cell has."""
    points = np.stack(np.meshgrid(*[axis] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
    return np.random.default_rng(5).permutation(points)


@pytest.mark.parametrize("order", LOBATTO)
@pytest.mark.parametrize("cell", BOXES)
def test_boxes_fill_the_cell_with_corners_in_order(cell, order):
    nodes = lattice(LOBATTO[order], BOXES[cell])
    parts = nodes[linear_cells(cell, nodes)]
    low, size = parts.min(axis=1, keepdims=True), np.ptp(parts, axis=1)
    assert len(parts) == order ** BOXES[cell]
    assert size.prod(axis=1).sum() == pytest.approx(1, abs=1e-14)
    np.testing.assert_array_equal((parts > low).astype(int), [CORNERS[cell]] * len(parts))


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("cell", SIMPLICES)
def test_simplices_fill_the_cell_and_are_not_turned_over(cell, order):
    dim = SIMPLICES[cell]
    nodes = lattice(np.arange(order + 1) / order, dim)
    nodes = nodes[nodes.sum(axis=1) < 1 + 1e-9]
    parts = linear_cells(cell, nodes)
    corners = nodes[parts]
    volumes = np.linalg.det(corners[:, 1:] - corners[:, :1]) / factorial(dim)
    np.testing.assert_allclose(volumes, 1 / factorial(dim) / order**dim)
    assert len(parts) == order**dim
    assert set(parts.ravel()) == set(range(len(nodes)))
