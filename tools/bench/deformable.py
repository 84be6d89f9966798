"""The continuum in three dimensions against plain dolfinx and scipy, and against the machine.

All three step the same motion, which is asserted before anything is timed. They take turns, so
that a machine whose speed drifts slows all; medians of the rounds' ratios are the figures to quote.

usage: python tools/bench/deformable.py CASE (steps a case and prints its rate: what mpiexec runs)
"""

import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from statistics import median
from typing import NamedTuple

import machine
import numpy as np
import plain_dolfinx
import plain_scipy
from kernels import ROUNDS, rate
from plain_dolfinx import Pillar, in_order

from cases.sampling import Clock
from cases.scene import Scene
from compare.effort import changed
from continuum import compat, simulate
from continuum.build import Discrete, build_model, discretise, room, state_at_rest
from continuum.explicit import run
from continuum.model import Model, Samples, State
from continuum.operator import Operator, layout, multiply, operator, zeros
from continuum.simulate import steps_of

BLOCKS = 100
SAME_STEPS = 200  # of the motion that all must share
SAME = 1e-10  # of its largest displacement
PROCESS_STEPS = 4000  # of what processes share: some seconds
#: In a container one is root, which Open MPI does not run as unless told twice.
AS_ROOT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
DIRECTION = (0.6, 0.8, 0.0)

#: Elements in each direction of a block, and their order.
CASES = {"linear": (4, 1), "cubic": (1, 3)}


class Contender(NamedTuple):
    """Something that steps: its name, how, and the freedoms times steps of one call."""

    name: str
    march: Callable[[], None]
    units: int


class Engine(NamedTuple):
    """A scene ready to run."""

    discrete: Discrete
    model: Model
    state: State
    samples: Samples
    time: Clock

    def march(self, first: int, last: int) -> None:
        """Take steps first .. last - 1."""
        run(self.model, self.state, self.samples, self.time.stride, first, last)

    @property
    def displacement(self) -> np.ndarray:
        """Displacements of all nodes [nodes, 3] by block, y, z and x, m."""
        body = self.discrete.body
        block = np.empty(len(body.x), dtype=np.int64)
        centre = body.corners[:, :, 1].mean(axis=1)
        block[body.cells] = (centre // self.discrete.properties.spacing)[:, None]
        nodes = in_order(body.x, block)
        return np.stack([self.state.u[body.freedom(nodes, c)] for c in range(3)], axis=1)


def scene_of(case: str, **changes) -> Scene:
    """Return the scene of a case: undamped rock and joints, struck obliquely."""
    elements, order = CASES[case]
    return changed(
        {
            "load.direction": list(DIRECTION),
            "record.energy": False,
            "record.stress": [],
            "record.velocity": [20.25],
            "numerics.continuum.dim": 3,
            "numerics.continuum.order": order,
            "numerics.continuum.elements_per_block": elements,
            "numerics.continuum.elements_across": elements,
            **changes,
        },
        BLOCKS,
    )


def engine_of(case: str) -> Engine:
    """Return the engine on a case, at rest."""
    scene = scene_of(case)
    discrete, (time, _) = discretise(scene, "jointed", 3), steps_of(scene, "jointed", 3)
    model = build_model(scene, discrete, "jointed", time)
    state = state_at_rest(model, False)
    return Engine(discrete, model, state, room(model, state, time.samples), time)


def pillar_of(case: str, engine: Engine) -> Pillar:
    """Return the same scene in plain numbers."""
    elements, order = CASES[case]
    rock, law = engine.discrete.materials[0], engine.model.interfaces.law
    return Pillar(
        blocks=BLOCKS,
        d=engine.discrete.properties.spacing,
        n=elements,
        p=order,
        modulus=rock.modulus,
        poisson=rock.poisson,
        density=rock.density,
        normal=law.normal_stiffness,
        shear=law.shear_stiffness,
        dt=engine.time.dt,
        pressure=engine.model.ends.loaded.pressure,
        direction=DIRECTION,
    )


def assert_same(engine: Engine, others: list[plain_dolfinx.Steps]) -> None:
    """Stop unless all come to the same displacements."""
    engine.march(0, SAME_STEPS)
    own = engine.displacement
    for other in others:
        other.march(SAME_STEPS)
        found = other.u.reshape(-1, 3)[in_order(other.x, other.block)]
        error = np.abs(found - own).max() / np.abs(own).max()
        assert error < SAME, f"not the same motion: {error:.1e}"


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
    yield Contender("engine, K u alone", lambda: multiply(own, x, y), size)
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
    held = sum(a.nbytes for a in arrays((engine.model, engine.state)))
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
    return 2 * BLOCKS * stiffness.rows.value.size


def bytes_moved(engine: Engine, freedoms: int) -> float:
    """Return bytes of vectors that a step reads and writes, a freedom; padding counts.

    u, f; f, dt / m, v, v and v before; v, u, u: ten numbers.
    """
    return 10 * 8 * engine.state.u.size / freedoms


def arrays(value) -> Iterator[np.ndarray]:
    """Yield all arrays in nested tuples."""
    if isinstance(value, np.ndarray):
        yield value
    elif isinstance(value, tuple):
        for part in value:
            yield from arrays(part)


def processes(case: str) -> None:
    """Print the rate of two processes over that of one."""
    if shutil.which("mpiexec") is None:
        print("  two processes: no mpiexec here")
        return
    pairs = [(_under_mpi(case, 1), _under_mpi(case, 2)) for _ in range(3)]
    ratios = sorted(two / one for one, two in pairs)
    one, two = (median(column) for column in zip(*pairs, strict=True))
    print(
        f"  two processes over one, whole runs: {two:.2e} over {one:.2e}: "
        f"{median(ratios):.2f} ({ratios[0]:.2f} to {ratios[-1]:.2f})",
        flush=True,
    )


def _under_mpi(case: str, count: int) -> float:
    command = ("mpiexec", "-n", str(count), sys.executable, __file__, case)
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, env=AS_ROOT)
    return float(done.stdout)


def one_run(case: str) -> None:
    """Run a case in all processes there are, and print freedoms times steps a second."""
    time, _ = steps_of(scene_of(case), "jointed", 3)
    result = simulate(scene_of(case, **{"time.duration": PROCESS_STEPS * time.dt}), "jointed", 3)
    a = result.attrs
    if compat.MPI.COMM_WORLD.rank == 0:
        print(a["degrees_of_freedom"] * a["steps"] / a["seconds_stepping"])


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
        processes(case)


if __name__ == "__main__":
    one_run(sys.argv[1])
