"""The undamped linear cases of the continuum's benchmark, and the engine's steps on them."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from rows import ELASTIC, lattice

from jointwave import cases
from jointwave.cases.read import load
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.continuum.plan import Plan, plan_of
from jointwave.continuum.problem import in_time
from jointwave.continuum.stepping.leapfrog import Leapfrog
from jointwave.continuum.stepping.problem import Problem

LOAD = {"kind": "pressure", "side": "top", "shape": "sine", "period": 2e-3, "amplitude": 1e6}
SCENE = Path(cases.__file__).parent / "rock-mass" / "random-network.toml"
NETWORK = {"waves": [], "loads": [LOAD], "boundaries": {}, "record.energy": False}

#: Cases of cubic blocks: dimension, number, elements along each edge of a block, order.
BLOCKS = {
    "quadrilaterals of order 2": (2, 100, 4, 2),
    "hexahedra of order 1": (3, 64, 4, 1),
    "hexahedra of order 3": (3, 64, 1, 3),
}
#: Cases of randomly cut rock, 30 m x 30 m: size of triangles, m, and order.
CUT = {"triangles of order 1": (0.4, 1), "triangles of order 2": (0.8, 2)}


class Engine(NamedTuple):
    """The continuum engine on a scene, at rest."""

    plan: Plan
    problem: Problem
    steps: Leapfrog

    def march(self, first: int, last: int) -> None:
        """Take steps first .. last - 1."""
        self.steps.take(first, last, self.plan.choice.time.stride)


def scene_of(case: str, size: float | None = None, duration: float = 0.01) -> RockMass:
    """Return the scene of a case; size : of its elements, m; duration : s."""
    if case in BLOCKS:
        dim, count, each, order = BLOCKS[case]
        numerics = {"size": size or 1.0 / each, "order": order, "scheme": "explicit"}
        tables = {"loads": [LOAD], "numerics": {"continuum": numerics}}
        return lattice(count, ELASTIC, tables | {"time": {"duration": duration}}, dim)
    own, order = CUT[case]
    numerics = {"size": size or own, "order": order, "scheme": "explicit", "cell": "triangle"}
    changes = NETWORK | {"numerics": {"continuum": numerics}, "time.duration": duration}
    return load(SCENE, changes)[0]  # type: ignore[return-value]


def engine_of(scene: RockMass, model: str = "jointed") -> Engine:
    """Return the continuum engine on a scene."""
    plan = plan_of(scene, model)
    problem = in_time(scene, plan.problem, plan.choice.time, None, model)
    time = plan.choice.time
    return Engine(plan, problem, Leapfrog(problem, time.dt, time.samples, energy=False))


def assert_same(engine: Engine, others: list, steps: int, most: float) -> None:
    """Assert that all reach the same displacements; most : difference over the largest one."""
    engine.march(0, steps)
    own = engine.steps.u
    for other in others:
        other.march(steps)
        error = np.abs(other.u - own).max() / np.abs(own).max()
        assert error < most, f"not the same motion: {error:.1e}"
