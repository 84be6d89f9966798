"""The first screen: how far apart the engines are on every scene, and what each costs."""

from collections.abc import Callable, Sequence
from math import isnan
from typing import Any, NamedTuple

from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import ENGINES, solve
from jointwave.compare.report.verdict import NOT_CHECKED, EngineScore
from jointwave.compare.text import in_seconds, times

LONG = 0.5  # s: a run that has taken so long is not repeated


class RankedScene(NamedTuple):
    """A scene on the first screen: its name on the page, what is written there, where its engines
    stand, and the seconds of stepping its first variant, by engine."""

    name: str
    heading: str
    title: str
    scores: dict[str, EngineScore]
    seconds: dict[str, float]

    def ratio(self, engine: str) -> float:
        """Return an engine's seconds over those of the cheapest engine of the scene."""
        least = min(self.seconds.values())
        return self.seconds[engine] / least if least > 0 else 1.0


def overview(scenes: Sequence[RankedScene]) -> dict[str, Any]:
    """Return the engines, a sentence on each, and each scene's cells by engine."""
    engines = [name for name in ENGINES if any(name in s.scores for s in scenes)]
    return {
        "engines": engines,
        "lead": {e: _sentence(e, [s for s in scenes if e in s.scores]) for e in engines},
        "rows": [(scene, {e: _cell(scene, e) for e in scene.scores}) for scene in scenes],
    }


def _cell(scene: RankedScene, engine: str) -> dict[str, Any]:
    score = scene.scores[engine]
    return {
        "verdict": score.verdict,
        "explanation": score.explanation,
        "cost": times(scene.ratio(engine)),
        "seconds": in_seconds(scene.seconds[engine]),
        "total": score.total.judged,
        "own": score.own.judged,
    }


def _sentence(engine: str, scenes: list[RankedScene]) -> str:
    """Return how far an engine lies from the finest physics, and at what cost."""
    scores = [s.scores[engine] for s in scenes]
    totals = [x for one in scores if not isnan(x := one.total.judged)]
    own = [x for one in scores if not isnan(x := one.own.judged)]
    far = f"{_span(_short, totals)} % from the finest physics" if totals else NOT_CHECKED.word
    error = f", own numerical error ≤ {_short(max(own))} %" if own else ""
    unchecked = sum(bool(one.unchecked) for one in scores)
    if totals and unchecked:
        error += f", {NOT_CHECKED.word} on {unchecked} of {len(scenes)} scenes"
    return f"({ENGINES[engine].sentence}): {far}{error}; {_cost(engine, scenes)}."


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


def seconds_of_stepping(scene: AnyScene, known: dict[str, float]) -> dict[str, float]:
    """Return the seconds of stepping of each engine, measured once more while no other process
    should be computing; of a run that has taken long, what it took.

    known : what each engine has taken.
    """

    def again(engine: str, taken: float) -> float:
        return min(taken, solve(engine, scene).attrs["seconds_stepping"])

    return {k: taken if taken > LONG else again(k, taken) for k, taken in known.items()}
