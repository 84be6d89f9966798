"""The first screen: how far apart the engines are on every scene, what each costs; versions."""

import json
import platform
from collections.abc import Callable, Iterable
from importlib.metadata import PackageNotFoundError, version
from math import isnan
from time import perf_counter
from typing import NamedTuple

from compare.engines import ENGINES, stepping
from compare.misfit.pairs import Comparison
from compare.report.verdict import NOT_CHECKED, Standing
from compare.text import in_seconds, times


class RankedScene(NamedTuple):
    """A scene's name on the page, its label and title, and where its engines stand.

    seconds : of stepping the first variant, by engine.
    """

    name: str
    label: str
    title: str
    standings: dict[str, Standing]
    seconds: dict[str, float]

    @property
    def heading(self) -> str:
        """Number or name, and the title."""
        return f"{self.label.removeprefix('fig. ')} {self.title}"

    def ratio(self, engine: str) -> float:
        """Return an engine's seconds over those of the cheapest engine of the scene."""
        least = min(self.seconds.values())
        return self.seconds[engine] / least if least > 0 else 1.0


class Overview(NamedTuple):
    """The scenes of the page."""

    scenes: list[RankedScene]

    @property
    def engines(self) -> list[str]:
        """Those that ran on any scene."""
        return [name for name in ENGINES if any(name in s.standings for s in self.scenes)]

    @property
    def lead(self) -> dict[str, str]:
        """By engine, how far it lies from the finest physics, and at what cost, in a sentence."""
        return {
            engine: _sentence(engine, [s for s in self.scenes if engine in s.standings])
            for engine in self.engines
        }


def _sentence(engine: str, scenes: list[RankedScene]) -> str:
    totals = [x for s in scenes if not isnan(x := s.standings[engine].total)]
    own = [x for s in scenes if not isnan(x := s.standings[engine].own)]
    held = any(s.standings[engine].finest for s in scenes)
    alone = "not compared with finer physics" if held else NOT_CHECKED.word
    far = f"{_span(_short, totals)} % from the finest physics" if totals else alone
    error = f", own numerical error ≤ {_short(max(own))} %" if own else ""
    open_ones = sum(bool(s.standings[engine].unchecked) for s in scenes)
    unchecked = f", {NOT_CHECKED.word} on {open_ones} of {len(scenes)} scenes" if totals else ""
    found = f"{far}{error}{unchecked * bool(open_ones)}; {_cost(engine, scenes)}"
    return f"({ENGINES[engine].words.sentence}): {found}."


def _cost(engine: str, scenes: list[RankedScene]) -> str:
    ratios = [s.ratio(engine) for s in scenes]
    if max(ratios) == 1:
        return f"cheapest, {_span(in_seconds, [s.seconds[engine] for s in scenes])} a run"
    return f"{_span(times, ratios)} the time of the cheapest"


def _span(write: Callable[[float], str], values: list[float]) -> str:
    low, high = write(min(values)), write(max(values))
    return low if low == high else f"{low} to {high}"


def _short(x: float) -> str:
    """Return a ratio in percent to two digits."""
    return "< 0.001" if 0 < x < 1e-5 else f"{100 * x:.2g}"


PACKAGES = ("scipy", "xarray", "obspy", "matplotlib")


def versions(scenes: Iterable[list[Comparison]]) -> dict[str, str]:
    """Return them by name."""
    found = {"jointwave": _version("jointwave"), "Python": platform.python_version()}
    for comparisons in scenes:
        for result in comparisons[0].results.values():
            found |= json.loads(result.attrs.get("versions", "{}"))
    return found | {name: _version(name) for name in PACKAGES}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:  # run from its folder, not installed
        return "(not installed)"


REPEATS = 5
LONG = 0.5  # s: a run that has taken so long is not repeated
ENOUGH = 0.1  # s: of repeats, their set-up included


def seconds(comparison: Comparison) -> dict[str, float]:
    """Return the seconds of stepping of each engine on a variant that it has solved.

    The least of a few repeats, while no other process should be computing; of a run that has
    taken long before, what it took then.
    """
    engines = [name for name in ENGINES if name in comparison.results]
    return {name: _least(name, comparison) for name in engines}


def _least(name: str, comparison: Comparison) -> float:
    known = _stepping(comparison.results[name])
    if known > LONG:
        return known
    found: list[float] = []
    began, repeat = perf_counter(), stepping(name, comparison.scene)
    while not found or (len(found) < REPEATS and perf_counter() - began < ENOUGH):
        found.append(repeat())
    return min(found)


def _stepping(result) -> float:
    return float(result.attrs["seconds_stepping"])
