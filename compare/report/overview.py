"""The first screen: how far apart the engines are on every scene, and what each costs."""

from __future__ import annotations

from collections.abc import Callable
from math import isnan
from typing import NamedTuple

from compare.engines import ENGINES
from compare.report.tables import percent
from compare.report.verdict import NOT_CHECKED, Standing, Verdict

#: Engines as a sentence names them.
WORDS = {
    "dem": "rigid blocks",
    "continuum-jointed": "continuum, every joint resolved",
    "continuum-equivalent": "homogenised continuum",
}
ROOM = 22  # characters of a scene in the table
LIMITS = "✓ agrees within 1 %, ≈ close within 5 %, △ differs within 20 %, ▲ far off beyond"


class Cell(NamedTuple):
    """An engine on a scene, as text; `ratio` is the cost over that of the cheapest engine."""

    own: str
    total: str
    ratio: str
    seconds: str
    verdict: Verdict
    explained: str


class Line(NamedTuple):
    """A scene: where it stands on the page, its short name, its title, and a cell an engine."""

    name: str
    label: str
    title: str
    cells: list[Cell | None]

    @property
    def heading(self) -> str:
        """Number or name, and the title as far as there is room."""
        text = f"{self.label.removeprefix('fig. ')} {self.title}"
        return text if len(text) <= ROOM else text[: ROOM - 1].rstrip() + "…"


class Overview(NamedTuple):
    """The engines that ran, the lead in sentences, and a line a scene."""

    engines: list[str]
    lead: list[tuple[str, str]]
    lines: list[Line]
    limits: str = LIMITS


class Ranked(NamedTuple):
    """A scene's name on the page, its label and title, and where its engines stand.

    seconds : of stepping the first variant, by engine.
    """

    name: str
    label: str
    title: str
    standings: dict[str, Standing]
    seconds: dict[str, float]

    def ratio(self, engine: str) -> float:
        """Return an engine's seconds over those of the cheapest engine of the scene."""
        least = min(self.seconds.values())
        return self.seconds[engine] / least if least > 0 else 1.0


def overview(scenes: list[Ranked]) -> Overview:
    """Return the table of all scenes, and what it comes to."""
    engines = [engine for engine in ENGINES if any(engine in s.standings for s in scenes)]
    lines = [Line(*s[:3], [_cell(s, engine) for engine in engines]) for s in scenes]
    return Overview(engines, _lead(engines, scenes), lines)


def _cell(scene: Ranked, engine: str) -> Cell | None:
    if engine not in scene.standings:
        return None
    one = scene.standings[engine]
    return Cell(
        percent(one.own),
        percent(one.total),
        _times(scene.ratio(engine)),
        in_seconds(scene.seconds[engine]),
        one.verdict,
        _explained(one),
    )


def _explained(one: Standing) -> str:
    parts = [f"held against {' and '.join(one.finest)}: {one.where}"] if one.finest else []
    if one.unchecked:
        named = [name for name in one.unchecked if name] if len(one.variants) > 1 else []
        parts.append(": ".join([NOT_CHECKED.word, *([", ".join(named)] if named else [])]))
    if one.broken:
        parts.append(f"beyond the scene's bound: {', '.join(one.broken)}")
    return "; ".join(parts)


def in_seconds(x: float) -> str:
    """Return a time to two digits, in the unit that suits it."""
    factor, unit = (1, "s") if x >= 1 else (1e3, "ms") if x >= 1e-3 else (1e6, "µs")
    shown = factor * x
    return f"{shown:.0f} {unit}" if shown >= 10 else f"{shown:.2g} {unit}"


def _lead(engines: list[str], scenes: list[Ranked]) -> list[tuple[str, str]]:
    """Return each engine with how far it lies from the finest physics, and at what cost."""
    return [
        (engine, _sentence(engine, [s for s in scenes if engine in s.standings]))
        for engine in engines
    ]


def _sentence(engine: str, scenes: list[Ranked]) -> str:
    totals = [x for s in scenes if not isnan(x := s.standings[engine].total)]
    own = [x for s in scenes if not isnan(x := s.standings[engine].own)]
    held = any(s.standings[engine].finest for s in scenes)
    alone = "not held against finer physics" if held else NOT_CHECKED.word
    far = f"{_span(_short, totals)} % from the finest physics" if totals else alone
    error = f", own numerical error ≤ {_short(max(own))} %" if own else ""
    open_ones = sum(bool(s.standings[engine].unchecked) for s in scenes)
    unchecked = f", {NOT_CHECKED.word} on {open_ones} of {len(scenes)} scenes" if totals else ""
    return f"({WORDS[engine]}): {far}{error}{unchecked * bool(open_ones)}; {_cost(engine, scenes)}."


def _cost(engine: str, scenes: list[Ranked]) -> str:
    ratios = [s.ratio(engine) for s in scenes]
    if max(ratios) == 1:
        return f"cheapest, {_span(in_seconds, [s.seconds[engine] for s in scenes])} a run"
    return f"{_span(_times, ratios)} the cheapest's time"


def _span(write: Callable[[float], str], values: list[float]) -> str:
    low, high = write(min(values)), write(max(values))
    return low if low == high else f"{low} to {high}"


def _short(x: float) -> str:
    """Return a ratio in percent to two digits."""
    return "< 0.001" if 0 < x < 1e-5 else f"{100 * x:.2g}"


def _times(x: float) -> str:
    return f"{x:.0f}×" if x >= 9.95 else f"{x:.1f}×"
