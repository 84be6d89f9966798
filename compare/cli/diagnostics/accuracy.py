"""Self-check of each engine against the exact solution of its model, on the paper's free pillar.

`python -m compare.cli.diagnostics.accuracy PAIR` prints one line of JSON. The bound is the one that
the shipped scene is held to by its [expect].
"""

import json
import sys
from time import perf_counter
from typing import NamedTuple

import cases
from compare.scenes import SHIPPED

SCENE = SHIPPED / "guo-li-2002" / "fig-03.toml"
PAIRS = ("dem ~ lattice", "continuum-jointed ~ jointed-bar")


class Check(NamedTuple):
    """A pair, its relative L2 misfit and bound, nan and a reason where it could not be measured.

    seconds : of both solutions, with all that is compiled.
    """

    pair: str
    misfit: float
    bound: float
    seconds: float
    reason: str = ""

    @property
    def holds(self) -> bool:
        """Whether the misfit is within the bound."""
        return self.misfit <= self.bound


def bound_of(pair: str) -> float:
    """Return what the shipped scene expects of a pair."""
    return cases.load_variant(SCENE).expect[pair]


def check(pair: str) -> Check:
    """Return how far an engine is from its exact solution here."""
    from compare.engines import solve
    from compare.misfit.metrics import misfit

    scene, began = cases.load_variant(SCENE), perf_counter()
    one, other = (solve(name, scene) for name in pair.split(" ~ "))
    return Check(pair, misfit(one, other), scene.expect[pair], perf_counter() - began)


if __name__ == "__main__":
    print("\n" + json.dumps(check(sys.argv[1])._asdict()))
