"""A hard case: a scene with changes, the solvers it is put to, and the criterion that judges it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, NamedTuple

import xarray as xr

import cases
from cases.errors import SceneError
from cases.schema.scene import Scene
from compare.engines import solve
from compare.scenes import find

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
        """Which table of [numerics] is this engine's."""
        return self.engine.partition("-")[0]

    @property
    def name(self) -> str:
        """The solver in words, as cases name those that they spare."""
        return f"{self.engine} {self.scheme}"


def _solver(engine: str, scheme: str, **more: Any) -> Solver:
    part = engine.partition("-")[0]
    return Solver(engine, scheme, {f"numerics.{part}.scheme": scheme, **more})


LEAPFROG = _solver("dem", "leapfrog")
FOURTH = _solver("dem", "fourth-order")
JOINTED = _solver("continuum-jointed", "explicit")
JOINTED_IMPLICIT = _solver("continuum-jointed", "implicit")
EQUIVALENT = _solver("continuum-equivalent", "explicit")
EQUIVALENT_IMPLICIT = _solver("continuum-equivalent", "implicit")
SOLVERS = (LEAPFROG, FOURTH, JOINTED, JOINTED_IMPLICIT, EQUIVALENT, EQUIVALENT_IMPLICIT)


class Finding(NamedTuple):
    """What a criterion has found: it holds where value <= bound; `said` adds to the message."""

    value: float
    bound: float
    said: str = ""


class Case(NamedTuple):
    """A hard case.

    name : in words. scene : a shipped scene, "hard/short-pillar".
    criterion : in words, what theory bounds. judge : what measures it on one solver.
    changes : of the scene, dotted keys; those of [numerics] may be `STEP` and `ALLOW`.
    spared : why a solver is not put to the case, by its name or its engine's or its scheme's.
    slow : takes long; run by `make test-all` and the study alone.
    """

    name: str
    scene: str
    criterion: str
    judge: Callable[[Trial], Finding]
    changes: dict[str, Any] = {}  # noqa: RUF012
    spared: dict[str, str] = {}  # noqa: RUF012
    slow: bool = False

    def why_spared(self, solver: Solver) -> str | None:
        """Return why a solver is not put to this case; None where it is."""
        for key in (solver.name, solver.engine, solver.scheme):
            if key in self.spared:
                return self.spared[key]
        return None


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
    """Return the critical step (s) of a solver's explicit steps along the axis."""
    if solver.engine == "dem":
        from dem.axial.simulate import scheme_of

        return scheme_of(scene).build(scene)[3]
    from continuum.simulate import steps_of

    return steps_of(scene, solver.engine.removeprefix("continuum-"))[1]


def is_refusal_of_scheme(error: SceneError) -> bool:
    """Return whether a scene calls for what the solver's scheme does not have."""
    return error.key.endswith(".scheme")
