"""Deformable rock masses: the product with their stiffness beside scipy's, and two processes.

A network of two sets at random spacings, 60 m x 60 m: blocks of any shape, in triangles of order 2;
and the same rock as its effective medium, in one piece.
"""

import numba
import numpy as np
import processes
from kernels import side_by_side
from rock import network

from jointwave.continuum.plane.rock import discretise
from jointwave.continuum.space.body import rock_matrices
from jointwave.continuum.space.operator import multiply
from jointwave.numerics.cache_lines import zeros


def products() -> None:
    """K u of the engine over scipy's, of the same matrix."""
    print("rock masses, K u alone, over scipy's CSR product of the same matrix, freedoms/s")
    compiled = numba.njit(lambda *arguments: multiply(*arguments))
    for name, model in {"blocks of any shape": "jointed", "one piece": "equivalent"}.items():
        body = discretise(network(), model).body
        matrix, count = rock_matrices(body)[0], body.degrees_of_freedom
        x, y = zeros(body.mass.size), zeros(body.mass.size)
        x[:] = np.sin(np.arange(x.size))
        compiled(*body.stiffness, x, y, 1.0)
        assert np.abs(y - matrix @ x).max() < 1e-12 * np.abs(y).max()
        own = (lambda: compiled(*body.stiffness, x, y, 1.0), count)  # noqa: B023
        side_by_side(f"{name}, {count:,}", own, (lambda: matrix @ x, count))  # noqa: B023


def main() -> None:
    """Print all ratios."""
    products()
    print("rock masses, freedoms x steps a second", flush=True)
    processes.compared("rock mass")


if __name__ == "__main__":
    main()
