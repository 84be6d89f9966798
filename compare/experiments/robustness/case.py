"""Hard cases: a scene with changes, the engines that run it, and its criterion."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, cached_property, partial
from typing import TYPE_CHECKING, Any, NamedTuple

import xarray as xr

import cases
from cases.kinds import AnyScene, pillar_of
from cases.material.calibrate import Properties, calibrate
from cases.schema.pulse import shortest_period
from cases.schema.scene import Scene
from compare.engines import ENGINES, solve
from compare.scenes import find
from compare.solvers.record import Solver

if TYPE_CHECKING:
    from cases.schema.rock_mass import RockMass

SHORT = "hard/short-pillar"  # the scene of most cases
#: In a case's changes: numerics.dem.step_fraction or numerics.continuum.step_fraction.
STEP = "step_fraction"
ALLOW = "allow_unstable"
EPS = 2.2e-16


class EngineScheme(NamedTuple):
    """An engine with one of its schemes of time steps."""

    engine: Solver
    scheme: str

    @property
    def name(self) -> str:
        """Engine and scheme in words, as in `spared` of cases."""
        return f"{self.engine.name} {self.scheme}"


SCHEMES = tuple(EngineScheme(one, scheme) for one in ENGINES.values() for scheme in one.schemes)
LEAPFROG, FOURTH, JOINTED, _, EQUIVALENT, _ = SCHEMES


class Judgement(NamedTuple):
    """The finding of a criterion: passed if value <= bound; `said` adds to the message."""

    value: float
    bound: float
    said: str = ""


class Criterion(NamedTuple):
    """A bound from theory. words : what it bounds. judge : measures it on one engine."""

    words: str
    judge: Callable[[CaseTrial], Judgement]


def criterion(words: str) -> Callable[[Callable[[CaseTrial], Judgement]], Criterion]:
    """Return the decorator that makes a function of a trial a criterion."""
    return partial(Criterion, words)


class HardCase(NamedTuple):
    """A hard case.

    name : in words. changes : of the scene, dotted keys; those of [numerics] may be `STEP` and
    `ALLOW`. spared : why an engine does not run the case, by its name, its scheme's or both.
    slow : run only by `make test-all` and the study. scene : a shipped one.
    """

    name: str
    criterion: Criterion
    changes: dict[str, Any] = {}  # noqa: RUF012
    spared: dict[str, str] = {}  # noqa: RUF012
    slow: bool = False
    scene: str = SHORT

    def why_spared(self, stepper: EngineScheme) -> str | None:
        """Return why an engine does not run this case; None if it does."""
        names = stepper.name, stepper.engine.name, stepper.scheme
        return next((self.spared[name] for name in names if name in self.spared), None)


def rock_is_spared(reason: str) -> dict[str, str]:
    """Return why deformable rock does not run a case, in the form of `HardCase.spared`."""
    return {name: reason for name, engine in ENGINES.items() if not engine.has_rigid_blocks}


class CaseTrial:
    """One case on one engine: its scene, with more changes if a criterion needs them."""

    def __init__(self, case: HardCase, stepper: EngineScheme) -> None:
        self.case = case
        self.engine, self.scheme = stepper

    def read(self, **more: Any) -> AnyScene:
        """Return the scene with more dotted keys (dots written __) changed."""
        part = f"numerics.{self.engine.engine}"
        extra = {key.replace("__", "."): value for key, value in more.items()}
        scheme = {f"{part}.scheme": self.scheme}
        if self.engine.has_rigid_blocks and _kind(self.case.scene) != Scene.kind:
            scheme = {}  # rock masses have only leapfrog
        keys = scheme | self.case.changes | extra
        for key in (STEP, ALLOW):
            if key in keys:
                keys[f"{part}.{key}"] = keys.pop(key)
        return cases.load_variant(find(self.case.scene), "", keys)

    @cached_property
    def own(self) -> AnyScene:
        """The scene of the case."""
        return self.read()

    def changed(self, **more: Any) -> Scene:
        """Return the pillar with more dotted keys (dots written __) changed."""
        return pillar_of(self.read(**more))

    def run(self, **more: Any) -> xr.Dataset:
        """Return the engine's result for the scene with more keys changed."""
        return solve(self.engine.name, self.read(**more) if more else self.own)

    @cached_property
    def scene(self) -> Scene:
        """The pillar of the case."""
        return pillar_of(self.own)

    @cached_property
    def rock_mass(self) -> RockMass:
        """The rock mass of the case."""
        assert not isinstance(self.own, Scene), self.case.name
        return self.own

    @cached_property
    def period(self) -> float:
        """The shortest period of loads and waves, s; 0 without."""
        return shortest_period(self.own.pulses) or 0.0

    @cached_property
    def duration(self) -> float:
        """The simulated time, s."""
        return self.own.time.duration

    @cached_property
    def properties(self) -> Properties:
        """The calibrated scene."""
        return calibrate(self.scene)

    @cached_property
    def result(self) -> xr.Dataset:
        """The engine's result for the scene of the case."""
        return self.run()

    @cached_property
    def critical(self) -> float:
        """The critical step of explicit steps of this scene, s."""
        return self.engine.prepare(self.read(**{STEP: 0.5})).critical

    @property
    def fraction(self) -> float:
        """The fraction of the critical step set by the case."""
        return float(self.case.changes[STEP])

    @property
    def dt(self) -> float:
        """The step set by the case, s."""
        return self.fraction * self.critical

    @property
    def is_implicit(self) -> bool:
        """Whether the engine's steps are implicit."""
        return self.scheme == "implicit"


@cache
def _kind(scene: str) -> str:
    return cases.load_variant(find(scene)).kind
