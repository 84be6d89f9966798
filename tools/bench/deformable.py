"""The continuum against plain dolfinx and scipy, for cubic blocks and randomly cut rock.

All compute the same motion, which is asserted before anything is timed.
"""

from functools import partial

import numba
import numpy as np
import plain_dolfinx
import processes
from rock import BLOCKS, CUT, assert_same, engine_of, scene_of
from timing import Timed, side_by_side

from jointwave.continuum.stepping.leapfrog import products_for_steps
from jointwave.continuum.stepping.product import product_for

STEPS = 200  # of the compared motion, and of one call of the engine
SAME = 1e-10  # largest difference over the largest displacement
FEW = 10  # steps of one call of the others


def against_others(case: str) -> None:
    """Print the engine's rates over those of the others on one case."""
    engine = engine_of(scene_of(case))
    size = engine.problem.body.stiffness.shape[0]
    print(f"continuum: {case}, {size:,} freedoms; freedoms x steps a second, one core")
    others = {
        "plain dolfinx, -O2": plain_dolfinx.assembled(engine.plan, engine.problem),
        "scipy": plain_dolfinx.multiplied(engine.plan, engine.problem),
    }
    assert_same(engine, list(others.values()), STEPS, SAME)
    own = partial(engine.march, STEPS, 2 * STEPS), size * STEPS
    for name, other in others.items():
        side_by_side(f"engine over {name}", own, (partial(other.march, FEW), size * FEW))
    side_by_side("K u alone, over scipy", *products(engine.problem.body))


def products(body) -> tuple[Timed, Timed]:
    """Return the products K u of the engine and of scipy, for timing."""
    product, matrix = products_for_steps(body)[0], body.stiffness
    multiply = product_for(product.kind, body.components)
    times = numba.njit(lambda table, x, y: multiply(table, x, y))
    x, y, u = np.zeros(product.size), np.zeros(product.size), np.sin(np.arange(matrix.shape[0]))
    x[product.place] = u

    def own() -> None:
        times(product.table, x, y)

    own()
    assert np.abs(y[product.place] + matrix @ u).max() < 1e-12 * np.abs(y).max()

    def other() -> None:
        matrix @ u

    return (own, u.size), (other, u.size)


def main() -> None:
    """Print the results of all cases."""
    for case in [*BLOCKS, *CUT]:
        against_others(case)
    for case in processes.CASES:
        processes.compared(case)
