"""The choices of block size, elements and time step of an engine, with their expected cost."""

from math import ceil
from typing import Any, NamedTuple

import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.material.effective_medium import slowest
from jointwave.cases.sampling import resolved_period, sample_times
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.validate import checked
from jointwave.compare.engines import ENGINES, applies, solve, solver
from jointwave.compare.runs import timings
from jointwave.compare.solvers.continuum import EQUIVALENT_ROCK, JOINTED_ROCK
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.solvers.record import Prepared
from jointwave.compare.studies.store import FAILURES

COARSEST = 0.9  # largest explicit step over the critical step
#: Fewest rigid blocks, and elements by order, per wavelength of a rock mass's slowest wave.
BLOCKS_IN_WAVE, ELEMENTS_IN_WAVE = 6, {1: 20, 2: 6, 3: 3, 4: 2}
#: Assumed seconds per step and freedom of runs never timed: small, so that they are tried.
UNTIMED, UNTIMED_IMPLICIT = 1e-9, 5e-7
EXPLICIT: dict[str, Any] = {"scheme": "explicit"}
#: No numerical damping: only the accuracy of the waveforms counts here.
IMPLICIT: dict[str, Any] = {"scheme": "implicit", "spectral_radius": 1.0}
#: Least ratio of degrees of freedom of a refinement. Halving one element of order 2 gives 5 / 3
#: along a block, 25 / 9 in a quadrilateral, nothing in blocks smaller than the elements.
GROWN = {"pillar": 1.5, "rock mass": 2.5}
MOST_HALVINGS = 4  # in one refinement, until the degrees of freedom grow
HALF = {"elements_per_block": 2, "size": 0.5, "block": 0.5}  # factors for half the size


class Elements(NamedTuple):
    """An engine's blocks or elements, scheme and time step for a scene.

    name : of the engine. changes : of its table in [numerics], without the step. run : the prepared
    run, with freedoms and critical step. per_sample : time steps per sample.
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
        """The changes that alter the model, not only its discretisation: the size of blocks."""
        return {k: v for k, v in self.changes.items() if k == "block"}

    @property
    def numerics(self) -> dict[str, Any]:
        """The keys of the engine's table, with the step."""
        dt = self.scene.interval / self.per_sample
        if self.run.scheme == "implicit":
            key, value = "steps_per_period", resolved_period(self.scene) / dt * (1 - 1e-6)
        else:
            key, value = "step_fraction", dt / self.run.critical * (1 + 1e-6)
        return self.changes | {key: float(f"{value:.7g}")}

    @property
    def seconds(self) -> float:
        """The expected seconds of stepping, from rates measured on this machine."""
        steps = self.per_sample * (len(sample_times(self.scene)) - 1)
        known = timings.stepping(self.name, self.scene, self.run._replace(steps=steps))
        each = UNTIMED_IMPLICIT if self.run.scheme == "implicit" else UNTIMED
        return each * steps * self.run.freedoms if known is None else known

    def finer(self) -> "list[Elements]":
        """Return elements, or blocks, of half the size or less; none if the mesh is given or they
        cannot be prepared, e.g. for lack of memory."""
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
        """Return the result of its run; the measured rate is saved for later estimates."""
        result = solve(self.name, configured(self.scene, self.name, self.numerics))
        timings.note(self.name, self.scene, result.attrs)
        return result


def label(name: str, changes: dict[str, Any]) -> str:
    """Return an engine with changes of its numerics, in one line."""
    text = ", ".join(f"{k} {v}" for k, v in changes.items())
    return f"{name} ({text})" if text else name


def elements(scene: AnyScene, name: str, changes: dict[str, Any]) -> Elements:
    """Return elements with their longest step; raises SceneError if the engine cannot run them."""
    trial = configured(scene, name, changes)
    if not (answer := applies(name, trial)):
        raise SceneError(scene.where, "", None, answer.reason)
    run = solver(name).prepare(trial)
    longest = scene.interval if run.scheme == "implicit" else COARSEST * run.critical
    return Elements(scene, name, changes, run, ceil(scene.interval / longest * (1 - 1e-9)))


def coarsest(scene: AnyScene) -> list[tuple[str, dict[str, Any]]]:
    """Return each engine with each scheme and its coarsest elements, as changes of [numerics]."""
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
    """Return the changes for blocks or elements of half the size; unchanged if they set no size."""
    return changes | {k: HALF[k] * v for k, v in changes.items() if k in HALF}


def _part(scene: AnyScene, count: int) -> float:
    """Return the shortest wavelength in a rock mass divided by `count`, m."""
    return float(f"{slowest(scene) * resolved_period(scene) / count:.3g}")  # type: ignore[arg-type]


def plain(scene: AnyScene) -> AnyScene:
    """Return a scene with default numerics, without energy ledger and snapshots."""
    record = scene.record.model_copy(
        update={"interval": scene.interval, "energy": False, "fields": None}
    )
    numerics = type(scene.numerics)()
    return scene.model_copy(update={"numerics": numerics, "record": record, "expect": {}})


def configured(scene: AnyScene, name: str, changes: dict[str, Any]) -> AnyScene:
    """Return a scene, without energy ledger and snapshots, with changes of an engine's numerics;
    raises SceneError if they are invalid."""
    key = ENGINES[name].engine
    table = getattr(scene.numerics, key).model_copy(update=changes)
    numerics = scene.numerics.model_copy(update={key: table})
    return checked(plain(scene).model_copy(update={"numerics": numerics}))
