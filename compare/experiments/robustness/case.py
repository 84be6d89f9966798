"""Hard cases: a scene with changes, the solvers it is put to, and the criterion that judges it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property, partial
from typing import Any, NamedTuple

import xarray as xr

import cases
from cases.errors import SceneError
from cases.schema.scene import Scene
from compare.engines import ENGINES, solve
from compare.scenes import find

SHORT = "hard/short-pillar"  # the scene of most cases
#: In a case's changes: numerics.dem.step_fraction or numerics.continuum.step_fraction.
STEP = "step_fraction"
ALLOW = "allow_unstable"


class Solver(NamedTuple):
    """An engine with one of its schemes; `changes` are the dotted keys that ask for it."""

    engine: str
    scheme: str
    changes: dict[str, Any]

    @property
    def part(self) -> str:
        """The table of [numerics] that is this engine's."""
        return ENGINES[self.engine].engine

    @property
    def model(self) -> str:
        """The model of the rock, "" of rigid blocks."""
        return ENGINES[self.engine].model or ""

    @property
    def is_rigid(self) -> bool:
        """Whether its blocks are rigid, so that it has no elements."""
        return ENGINES[self.engine].has_rigid_blocks

    @property
    def name(self) -> str:
        """The solver in words, as cases name those that they spare."""
        return f"{self.engine} {self.scheme}"


SOLVERS = tuple(
    Solver(name, scheme, {f"numerics.{engine.engine}.scheme": scheme})
    for name, engine in ENGINES.items()
    for scheme in engine.schemes
)
LEAPFROG, FOURTH, JOINTED, _, EQUIVALENT, _ = SOLVERS


class Finding(NamedTuple):
    """The finding of a criterion: it holds where value <= bound; `said` adds to the message."""

    value: float
    bound: float
    said: str = ""


class Criterion(NamedTuple):
    """A bound from theory. words : what it bounds. judge : measures it on one solver."""

    words: str
    judge: Callable[[Trial], Finding]

    def __call__(self, trial: Trial) -> Finding:
        """Return what the criterion finds."""
        return self.judge(trial)


def criterion(words: str) -> Callable[[Callable[[Trial], Finding]], Criterion]:
    """Return the decorator that makes a function of a trial a criterion."""
    return partial(Criterion, words)


class Case(NamedTuple):
    """A hard case.

    name : in words. changes : of the scene, dotted keys; those of [numerics] may be `STEP` and
    `ALLOW`. spared : why a solver is not put to the case, by its name or its engine's or its
    scheme's. slow : takes long; run by `make test-all` and the study alone. scene : a shipped one.
    """

    name: str
    criterion: Criterion
    changes: dict[str, Any] = {}  # noqa: RUF012
    spared: dict[str, str] = {}  # noqa: RUF012
    slow: bool = False
    scene: str = SHORT

    def why_spared(self, solver: Solver) -> str | None:
        """Return why a solver is not put to this case; None where it is."""
        for key in (solver.name, solver.engine, solver.scheme):
            if key in self.spared:
                return self.spared[key]
        return None


def rock_is_spared(reason: str) -> dict[str, str]:
    """Return the reason why no deformable rock is put to a case, as `Case.spared` has it."""
    return {name: reason for name, engine in ENGINES.items() if not engine.has_rigid_blocks}


class Trial:
    """One case on one solver: its scene, with more changes where a criterion needs them."""

    def __init__(self, case: Case, solver: Solver) -> None:
        self.case, self.solver = case, solver

    def scene(self, **more: Any) -> Scene:
        """Return the scene with more dotted keys (dots written __) changed."""
        extra = {key.replace("__", "."): value for key, value in more.items()}
        keys = self.solver.changes | self.case.changes | extra
        for key in (STEP, ALLOW):
            if key in keys:
                keys[f"numerics.{self.solver.part}.{key}"] = keys.pop(key)
        return cases.load_variant(find(self.case.scene), "", keys)

    def run(self, **more: Any) -> xr.Dataset:
        """Return the solver's result for the scene with more keys changed."""
        return solve(self.solver.engine, self.scene(**more))

    @cached_property
    def critical(self) -> float:
        """The critical step of explicit steps of this scene, s."""
        return critical_step(self.solver, self.scene(**{STEP: 0.5}))


def critical_step(solver: Solver, scene: Scene) -> float:
    """Return the critical step (s) of a solver's explicit steps."""
    return ENGINES[solver.engine].prepare(scene).critical


def is_refusal_of_scheme(error: SceneError) -> bool:
    """Return whether a scene calls for what the solver's scheme does not have."""
    return error.key.endswith(".scheme")
