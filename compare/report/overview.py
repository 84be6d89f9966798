"""The first screen: how far apart the engines are on every scene, and what each costs."""

from collections.abc import Callable, Iterable, Sequence
from math import isnan

from jointwave.compare.engines import ENGINES
from jointwave.compare.report.scenes import SolvedScene
from jointwave.compare.report.verdict import NOT_CHECKED
from jointwave.compare.text import in_seconds, times


def lead(scenes: Sequence[SolvedScene]) -> dict[str, str]:
    """Return a sentence on each engine that solves a scene."""
    found = {e: [one for one in scenes if e in one.scores] for e in ENGINES}
    return {engine: _sentence(engine, solved) for engine, solved in found.items() if solved}


def _sentence(engine: str, scenes: list[SolvedScene]) -> str:
    """Return how far an engine lies from the finest physics, and at what cost."""
    scores = [one.scores[engine] for one in scenes]
    totals = [x for one in scores if not isnan(x := one.total.judged)]
    own = [x for one in scores if not isnan(x := one.own.judged)]
    said = f"({ENGINES[engine].sentence}): "
    said += f"{_span(_short, totals)} % from the finest physics" if totals else NOT_CHECKED.word
    said += f", own numerical error ≤ {_short(max(own))} %" if own else ""
    unchecked = sum(bool(one.unchecked) for one in scores)
    if totals and unchecked:
        said += f", {NOT_CHECKED.word} on {unchecked} of {len(scenes)} scenes"
    costs = [one.costs[engine] for one in scenes]
    if max(costs) == 1:
        return f"{said}; cheapest, {_span(in_seconds, (s.seconds[engine] for s in scenes))} a run."
    return f"{said}; {_span(times, costs)} the time of the cheapest."


def _span(write: Callable[[float], str], values: Iterable[float]) -> str:
    ordered = sorted(values)
    return " to ".join(dict.fromkeys(write(x) for x in (ordered[0], ordered[-1])))


def _short(x: float) -> str:
    """Return a ratio in percent to two digits."""
    return "< 0.001" if 0 < x < 1e-5 else f"{100 * x:.2g}"
