"""The blocks, elements and steps that an engine can have on a scene, and their expected cost."""

from math import ceil
from typing import Any, NamedTuple

import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.material.effective_medium import slowest
from jointwave.cases.sampling import sample_times
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.validate import checked
from jointwave.compare.engines import ENGINES, applies, solve, solver
from jointwave.compare.runs import timings
from jointwave.compare.solvers.continuum import EQUIVALENT_ROCK, JOINTED_ROCK
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.solvers.record import Prepared
from jointwave.compare.studies.store import FAILURES

COARSEST = 0.9  # of the critical step, explicit
#: Rigid blocks and, by their order, elements in the length of a rock mass's slowest waves, at the
#: coarsest.
BLOCKS_IN_WAVE, ELEMENTS_IN_WAVE = 6, {1: 20, 2: 6, 3: 3, 4: 2}
#: Seconds of a step of a freedom, where no such run was timed yet: little, so that it is tried.
UNTIMED, UNTIMED_IMPLICIT = 1e-9, 5e-7
EXPLICIT: dict[str, Any] = {"scheme": "explicit"}
#: Without numerical damping: only the accuracy of the waveforms counts here.
IMPLICIT: dict[str, Any] = {"scheme": "implicit", "spectral_radius": 1.0}
#: Least growth in degrees of freedom of elements of half the size: 5 / 3 along a block of one
#: element of order 2, 25 / 9 in a quadrilateral. Blocks smaller than the elements do not grow.
GROWN = {"pillar": 1.5, "rock mass": 2.5}
MOST_HALVINGS = 4  # of elements at once, until there are more of them
HALF = {"elements_per_block": 2, "size": 0.5, "block": 0.5}  # factors for half the size


class Elements(NamedTuple):
    """An engine's blocks or elements and its scheme on a scene, with a step.

    name : of the engine. changes : of its table in [numerics], without the step. run : as prepared,
    with its freedoms and its critical step. per_sample : steps per sample, at first the fewest.
    """

    scene: AnyScene
    name: str
    changes: dict[str, Any]
    run: Prepared
    per_sample: int = 1

    @property
    def label(self) -> str:
        """Its engine and changes, in one line."""
        return label(self.name, self.changes)

    @property
    def model(self) -> dict[str, Any]:
        """The changes that remain in the limit of fine steps and elements: the size of blocks."""
        return {k: v for k, v in self.changes.items() if k == "block"}

    @property
    def numerics(self) -> dict[str, Any]:
        """The keys of the engine's table, with the step."""
        dt = self.scene.interval / self.per_sample
        if self.run.scheme == "implicit":
            key, value = "steps_per_period", period_of(self.scene) / dt * (1 - 1e-6)
        else:
            key, value = "step_fraction", dt / self.run.critical * (1 + 1e-6)
        return self.changes | {key: float(f"{value:.7g}")}

    @property
    def seconds(self) -> float:
        """The expected seconds of stepping, by the rates of this machine."""
        steps = self.per_sample * (len(sample_times(self.scene)) - 1)
        known = timings.stepping(self.name, self.scene, self.run._replace(steps=steps))
        each = UNTIMED_IMPLICIT if self.run.scheme == "implicit" else UNTIMED
        return each * steps * self.run.freedoms if known is None else known

    def finer(self) -> "list[Elements]":
        """Return elements, or blocks, of half the size or less; none where their mesh is given or
        they cannot be had, for lack of memory."""
        changes = self.changes
        for _ in range(MOST_HALVINGS):
            if (changes := halved(changes)) == self.changes:
                break
            try:
                found = elements(self.scene, self.name, changes)
            except FAILURES:
                break
            if found.run.freedoms >= GROWN[self.scene.kind] * self.run.freedoms:
                return [found]
        return []

    def solve(self) -> xr.Dataset:
        """Return the result of its run, whose rate is kept for later estimates."""
        result = solve(self.name, configured(self.scene, self.name, self.numerics))
        timings.note(self.name, self.scene, result.attrs)
        return result


def label(name: str, changes: dict[str, Any]) -> str:
    """Return an engine with changes of its numerics, in one line."""
    text = ", ".join(f"{k} {v}" for k, v in changes.items())
    return f"{name} ({text})" if text else name


def elements(scene: AnyScene, name: str, changes: dict[str, Any]) -> Elements:
    """Return an engine's elements on a scene with their longest step; raises SceneError if it
    cannot have them."""
    asked = configured(scene, name, changes)
    if not (answer := applies(name, asked)):
        raise SceneError(scene.where, "", None, answer.reason)
    run = solver(name).prepare(asked)
    longest = scene.interval if run.scheme == "implicit" else COARSEST * run.critical
    return Elements(scene, name, changes, run, ceil(scene.interval / longest * (1 - 1e-9)))


def coarsest(scene: AnyScene) -> list[tuple[str, dict[str, Any]]]:
    """Return the engines with their schemes and coarsest elements, as changes of [numerics]."""
    if scene.is_column:
        rigid: list[dict[str, Any]] = [{"scheme": scheme} for scheme in DEM.schemes]
    else:
        rigid = [{}, {"block": _part(scene, BLOCKS_IN_WAVE)}]
    return [(DEM.name, changes) for changes in rigid] + [
        (name, scheme | rock(scene, order))
        for scheme in (EXPLICIT, IMPLICIT)
        for order in ELEMENTS_IN_WAVE
        for name in (JOINTED_ROCK.name, EQUIVALENT_ROCK.name)
    ]


def rock(scene: AnyScene, order: int) -> dict[str, Any]:
    """Return the changes for the fewest elements of an order."""
    if scene.is_column:
        return {"order": order, "elements_per_block": 1}
    return {"order": order, "size": _part(scene, ELEMENTS_IN_WAVE[order])}


def halved(changes: dict[str, Any]) -> dict[str, Any]:
    """Return the changes for blocks or elements of half the size; the same if these are given."""
    return changes | {k: HALF[k] * v for k, v in changes.items() if k in HALF}


def _part(scene: AnyScene, count: int) -> float:
    """Return a part of the length of a rock mass's slowest waves of the shortest period, m."""
    return float(f"{slowest(scene) * period_of(scene) / count:.3g}")  # type: ignore[arg-type]


def period_of(scene: AnyScene) -> float:
    """Return the shortest period of a scene's pulses, s; without one a tenth of its duration."""
    return shortest_period(scene.pulses) or scene.time.duration / 10


def plain(scene: AnyScene) -> AnyScene:
    """Return a scene with default numerics, without ledger and snapshots."""
    record = scene.record.model_copy(
        update={"interval": scene.interval, "energy": False, "fields": None}
    )
    numerics = type(scene.numerics)()
    return scene.model_copy(update={"numerics": numerics, "record": record, "expect": {}})


def configured(scene: AnyScene, name: str, changes: dict[str, Any]) -> AnyScene:
    """Return a scene with changes of an engine's numerics, which are otherwise its own; raises
    SceneError if it cannot have them."""
    key = ENGINES[name].engine
    table = getattr(scene.numerics, key).model_copy(update=changes)
    numerics = scene.numerics.model_copy(update={key: table})
    return checked(plain(scene).model_copy(update={"numerics": numerics}))
