"""The continuum in three dimensions against plain dolfinx and scipy.

All step the same motion, which is asserted before anything is timed. They take turns, so that a
machine whose speed drifts slows all; medians of the rounds' ratios are the figures to quote.
"""

from collections.abc import Callable, Iterator
from statistics import median
from typing import NamedTuple

import numba
import numpy as np
import plain_dolfinx
import plain_scipy
import processes
from kernels import ROUNDS, rate
from plain_dolfinx import Pillar
from rock import BLOCKS, CASES, SAME_STEPS, Engine, assert_same, engine_of, pillar_of

from jointwave.continuum.space.operator import layout, multiply, operator, zeros


class Contender(NamedTuple):
    """Something that steps: its name, how, and the freedoms times steps of one call."""

    name: str
    march: Callable[[], None]
    units: int


def contenders(case: str, engine: Engine) -> list[Contender]:
    """Return the engine, dolfinx, scipy and the bare operators, all in the same motion."""
    pillar = pillar_of(case, engine)
    others = [
        plain_dolfinx.assembled(pillar),
        plain_scipy.multiplied(pillar),
    ]
    assert_same(engine, others)
    size, few = others[0].u.size, 10
    return [
        Contender("engine", lambda: engine.march(SAME_STEPS, 2 * SAME_STEPS), size * SAME_STEPS),
        Contender("plain dolfinx, -O2", lambda: others[0].march(few), size * few),
        Contender("scipy, zeros dropped", lambda: others[1].march(few), size * few),
        *operators(pillar, size),
    ]


def operators(pillar: Pillar, size: int) -> Iterator[Contender]:
    """Yield K u alone: of the engine, and of scipy without the zeros."""
    block = plain_scipy.stiffness(pillar._replace(blocks=1))
    where = layout([BLOCKS], [block.shape[0]])
    own, x, y = operator(where, [block]), zeros(where.length), zeros(where.length)
    x[:] = 1.0
    compiled = numba.njit(lambda *arguments: multiply(*arguments))
    yield Contender("engine, K u alone", lambda: compiled(*own, x, y, 1.0), size)
    whole = plain_scipy.without_zeros(pillar)
    u = np.ones(size)
    yield Contender("scipy, K u alone", lambda: whole @ u, size)


def side_by_side(rivals: list[Contender]) -> None:
    """Time all in turn and print rates and ratios."""
    for rival in rivals:
        rival.march()
    rounds = [[rate(rival.march, rival.units) for rival in rivals] for _ in range(ROUNDS)]
    rates = dict(zip([rival.name for rival in rivals], zip(*rounds, strict=True), strict=True))
    for name, found in rates.items():
        first = "engine, K u alone" if name.endswith("alone") else "engine"
        ratios = sorted(a / b for a, b in zip(rates[first], found, strict=True))
        spread = f"{median(ratios):7.2f} ({ratios[0]:.2f} to {ratios[-1]:.2f})"
        over = "" if name == first else f": {first} is {spread} times that"
        print(f"  {name:24s} {median(found):8.2e}{over}", flush=True)


def main() -> None:
    """Print all of it for both cases."""
    for case, (n, p) in CASES.items():
        engine = engine_of(case)
        print(
            f"continuum: {BLOCKS} blocks of {n} x {n} x {n} hexahedra of order {p}, "
            f"{3 * len(engine.discrete.body.x):,} freedoms; freedoms x steps a second, one core"
        )
        side_by_side(contenders(case, engine))
        processes.compared(case)
