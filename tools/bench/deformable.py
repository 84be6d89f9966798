"""The continuum in three dimensions against plain dolfinx and scipy, and against the machine.

All step the same motion, which is asserted before anything is timed. They take turns, so that a
machine whose speed drifts slows all; medians of the rounds' ratios are the figures to quote.
"""

from collections.abc import Callable, Iterator
from statistics import median
from typing import NamedTuple

import machine
import numba
import numpy as np
import plain_dolfinx
import plain_scipy
import processes
from kernels import ROUNDS, rate
from plain_dolfinx import Pillar
from rock import BLOCKS, CASES, SAME_STEPS, Engine, assert_same, engine_of, pillar_of

from continuum.space.operator import Operator, layout, multiply, operator, zeros
from results.arrays import size_of


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
        plain_scipy.multiplied(pillar, zeros=True),
    ]
    assert_same(engine, others)
    size, few = others[0].u.size, 10
    return [
        Contender("engine", lambda: engine.march(SAME_STEPS, 2 * SAME_STEPS), size * SAME_STEPS),
        Contender("plain dolfinx, -O2", lambda: others[0].march(few), size * few),
        Contender("scipy, zeros dropped", lambda: others[1].march(few), size * few),
        Contender("scipy, as assembled", lambda: others[2].march(few), size * few),
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


def side_by_side(rivals: list[Contender]) -> dict[str, float]:
    """Time all in turn, print rates and ratios, and return the rates."""
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
    return {name: median(found) for name, found in rates.items()}


def against_machine(engine: Engine, rates: dict[str, float]) -> None:
    """Print what a step of a freedom takes, as shares of what this machine can do at most."""
    freedoms = 3 * len(engine.discrete.body.x)
    most, stream = machine.peak(), machine.bandwidth()
    work, moved = flops(engine, freedoms), bytes_moved(engine, freedoms)
    held = size_of(engine.model, engine.state)
    speed, alone = rates["engine"], rates["engine, K u alone"]
    product = flops_of(engine.model.rock.stiffness) / freedoms
    print(f"  {held / freedoms:.0f} bytes a freedom in memory")
    print(
        f"  a step of a freedom: {work:.0f} flops, {100 * speed * work / most:.0f} % of one core's "
        f"peak ({most:.2e} a second); K u alone: {product:.0f} flops, "
        f"{100 * alone * product / most:.0f} %"
    )
    print(
        f"  and {moved:.0f} bytes of vectors read and written, {100 * speed * moved / stream:.0f} %"
        f" of the memory's bandwidth by triad ({stream:.2e} a second); above 100 %: from caches"
    )


def flops(engine: Engine, freedoms: int) -> float:
    """Return products and sums a freedom and step: K u, the joints, v += h f, u += dt v.

    A point of a joint takes 2 for a jump, 1 for the law, 1 for its area and 4 for the forces on
    the two sides, in each direction.
    """
    points = engine.model.interfaces.area.size
    return (flops_of(engine.model.rock.stiffness) + 3 * 8 * points) / freedoms + 4


def flops_of(stiffness: Operator) -> int:
    """Return products and sums of K u, without padding."""
    return 2 * BLOCKS * stiffness.value.size


def bytes_moved(engine: Engine, freedoms: int) -> float:
    """Return bytes of vectors that a step reads and writes, a freedom; padding counts.

    u, f; f, dt / m, v, v and v before; v, u, u: ten numbers.
    """
    return 10 * 8 * engine.state.u.size / freedoms


def main() -> None:
    """Print all of it for both cases."""
    for case, (n, p) in CASES.items():
        engine = engine_of(case)
        print(
            f"continuum: {BLOCKS} blocks of {n} x {n} x {n} hexahedra of order {p}, "
            f"{3 * len(engine.discrete.body.x):,} freedoms; freedoms x steps a second, one core"
        )
        rates = side_by_side(contenders(case, engine))
        against_machine(engine, rates)
        processes.compared(case)
