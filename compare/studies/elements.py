"""The blocks, elements and steps that an engine can have on a scene, and their expected cost."""

from math import ceil
from typing import Any, NamedTuple

import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.material.effective_medium import slowest
from jointwave.cases.sampling import sample_times
from jointwave.cases.scene_type import AnyScene, checked
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import ENGINES, applies, solve, solver
from jointwave.compare.runs import timings
from jointwave.compare.solvers.continuum import EQUIVALENT_ROCK, JOINTED_ROCK
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.solvers.record import Prepared

COARSEST = 0.9  # of the critical step, explicit
#: Rigid blocks and, by their order, elements in the length of a rock mass's slowest waves, at the
#: coarsest.
BLOCKS_IN_WAVE, ELEMENTS_IN_WAVE = 6, {1: 20, 2: 6, 3: 3, 4: 2}
#: Seconds of a step of a freedom, where no such run was timed yet: little, so that it is tried.
UNTIMED, UNTIMED_IMPLICIT = 1e-9, 5e-7
EXPLICIT: dict[str, Any] = {"scheme": "explicit"}
#: Without numerical damping: only the accuracy of the waveforms counts here.
IMPLICIT: dict[str, Any] = {"scheme": "implicit", "spectral_radius": 1.0}


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
    def is_implicit(self) -> bool:
        """Whether its steps are not bounded by a critical one."""
        return self.changes.get("scheme") == "implicit"

    @property
    def numerics(self) -> dict[str, Any]:
        """The keys of the engine's table, with the step."""
        dt = self.scene.interval / self.per_sample
        if self.is_implicit:
            per_period = _period(self.scene) / dt * (1 - 1e-6)
            return self.changes | {"steps_per_period": float(f"{per_period:.7g}")}
        return self.changes | {"step_fraction": float(f"{dt / self.run.critical * (1 + 1e-6):.7g}")}

    @property
    def seconds(self) -> float:
        """The expected seconds of stepping, by the rates of this machine."""
        steps = self.per_sample * (len(sample_times(self.scene)) - 1)
        known = timings.stepping(self.name, self.scene, self.run._replace(steps=steps))
        each = UNTIMED_IMPLICIT if self.is_implicit else UNTIMED
        return each * steps * self.run.freedoms if known is None else known

    def with_steps(self, per_sample: int) -> "Elements":
        """Return the same elements with so many steps per sample."""
        return self._replace(per_sample=per_sample)

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
    made = Elements(scene, name, changes, solver(name).prepare(asked))
    if made.is_implicit:
        return made
    return made.with_steps(ceil(scene.interval / (COARSEST * made.run.critical) * (1 - 1e-9)))


def coarsest(scene: AnyScene) -> list[tuple[str, dict[str, Any]]]:
    """Return the engines with their schemes and coarsest elements, as changes of [numerics]."""
    found: list[tuple[str, dict[str, Any]]] = []
    if isinstance(scene, Scene):
        found += [(DEM.name, {"scheme": scheme}) for scheme in DEM.schemes]
    else:
        found += [(DEM.name, {}), (DEM.name, {"block": _part(scene, BLOCKS_IN_WAVE)})]
    for scheme in (EXPLICIT, IMPLICIT):
        for order in ELEMENTS_IN_WAVE:
            both = (JOINTED_ROCK.name, EQUIVALENT_ROCK.name)
            found += [(name, scheme | rock(scene, order)) for name in both]
    return found


def rock(scene: AnyScene, order: int) -> dict[str, Any]:
    """Return the changes for the fewest elements of an order."""
    if isinstance(scene, Scene):
        return {"order": order, "elements_per_block": 1}
    return {"order": order, "size": _part(scene, ELEMENTS_IN_WAVE[order])}


def halved(changes: dict[str, Any]) -> dict[str, Any]:
    """Return the changes for blocks or elements of half the size; empty where these are given."""
    if "elements_per_block" in changes:
        return changes | {"elements_per_block": 2 * changes["elements_per_block"]}
    finer = {k: float(f"{v / 2:.3g}") for k, v in changes.items() if k in ("size", "block")}
    return changes | finer if finer else {}


def _part(scene: AnyScene, count: int) -> float:
    """Return a part of the length of a rock mass's slowest waves of the shortest period, m."""
    return float(f"{slowest(scene) * _period(scene) / count:.3g}")  # type: ignore[arg-type]


def _period(scene: AnyScene) -> float:
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
