"""The continuum against plain dolfinx and scipy: jointed pillars in space, and rock masses.

All step the same motion, which is asserted before anything is timed. The rock mass is a network of
two sets at random spacings, 60 m x 60 m: blocks of any shape, in triangles of order 2; and the same
rock as its effective medium, in one piece.
"""

from functools import partial

import numba
import numpy as np
import plain_dolfinx
import processes
from rock import BLOCKS, CASES, SAME_STEPS, assert_same, engine_of, network, pillar_of
from scipy.sparse import csr_matrix
from timing import Timed, side_by_side

from jointwave.continuum.plane.rock import discretise
from jointwave.continuum.space.body import rock_matrices
from jointwave.continuum.space.operator import Operator, layout, multiply, operator
from jointwave.numerics.cache_lines import zeros

FEW = 10  # steps of one call of the others
PRODUCT = numba.njit(lambda *arguments: multiply(*arguments))


def pillars(case: str) -> None:
    """Print the engine's rates over those of all others on one case."""
    n, p = CASES[case]
    engine = engine_of(case)
    print(
        f"continuum: {BLOCKS} blocks of {n} x {n} x {n} hexahedra of order {p}, "
        f"{3 * len(engine.discrete.body.x):,} freedoms; freedoms x steps a second, one core"
    )
    pillar = pillar_of(case, engine)
    dolfinx, scipy = plain_dolfinx.assembled(pillar), plain_dolfinx.multiplied(pillar)
    assert_same(engine, [dolfinx, scipy])
    size = dolfinx.u.size
    own = partial(engine.march, SAME_STEPS, 2 * SAME_STEPS), size * SAME_STEPS
    for name, other in {"plain dolfinx, -O2": dolfinx, "scipy, zeros dropped": scipy}.items():
        side_by_side(f"engine over {name}", own, (partial(other.march, FEW), size * FEW))
    block = plain_dolfinx.stiffness(pillar._replace(blocks=1))
    where = layout([BLOCKS], [block.shape[0]])
    whole = plain_dolfinx.without_zeros(pillar)
    both = products(operator(where, [block]), where.length, whole, size)
    side_by_side("K u alone, over scipy", *both)


def products(own: Operator, length: int, matrix: csr_matrix, count: int) -> tuple[Timed, Timed]:
    """Return K u of the engine and of scipy, count freedoms each."""
    x, y = zeros(length), zeros(length)
    x[:] = np.sin(np.arange(length))
    u = x[: matrix.shape[0]].copy()

    def product() -> np.ndarray:
        PRODUCT(*own, x, y, 1.0)
        return y

    return (product, count), (lambda: matrix @ u, count)


def masses() -> None:
    """Print K u of rock masses over scipy's, of the same matrix."""
    print("rock masses, K u alone, over scipy's CSR product of the same matrix, freedoms/s")
    for name, model in {"blocks of any shape": "jointed", "one piece": "equivalent"}.items():
        body = discretise(network(), model).body
        matrix, count = rock_matrices(body)[0], body.degrees_of_freedom
        both = products(body.stiffness, body.mass.size, matrix, count)
        own, other = (take() for take, _ in both)
        assert np.abs(own - other).max() < 1e-12 * np.abs(other).max()
        side_by_side(f"{name}, {count:,}", *both)


def main() -> None:
    """Print all of it."""
    for case in CASES:
        pillars(case)
        processes.compared(case)
    masses()
    print("rock masses, freedoms x steps a second", flush=True)
    processes.compared("rock mass")
