"""The first screen: how far apart the engines are on every scene, and what each costs."""

from __future__ import annotations

from math import isnan
from typing import NamedTuple

from compare.engines import ENGINES
from compare.page.standing import Standing, Verdict
from compare.tables import percent

#: Engines as a sentence names them.
WORDS = {
    "dem": "rigid blocks",
    "continuum-jointed": "the continuum with every joint",
    "continuum-equivalent": "the homogenised continuum",
}
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


class Overview(NamedTuple):
    """The engines that ran, the lead in sentences, and a line a scene."""

    engines: list[str]
    lead: list[str]
    lines: list[Line]
    limits: str = LIMITS


class Ranked(NamedTuple):
    """A scene's name on the page, its label and title, and where its engines stand."""

    name: str
    label: str
    title: str
    standings: dict[str, Standing]


def overview(scenes: list[Ranked]) -> Overview:
    """Return the table of all scenes, and what it comes to."""
    engines = [engine for engine in ENGINES if any(engine in s.standings for s in scenes)]
    lines = [Line(*s[:3], [_cell(s.standings, engine) for engine in engines]) for s in scenes]
    return Overview(engines, _lead(engines, scenes), lines)


def _cell(standings: dict[str, Standing], engine: str) -> Cell | None:
    if engine not in standings:
        return None
    one = standings[engine]
    ratio = _ratio(standings, engine)
    return Cell(
        percent(one.own),
        percent(one.total),
        f"{ratio:.0f}×" if ratio >= 10 else f"{ratio:.2g}×",
        in_seconds(one.seconds),
        one.verdict,
        _explained(engine, one),
    )


def _ratio(standings: dict[str, Standing], engine: str) -> float:
    """Return an engine's seconds over those of the cheapest engine of the scene."""
    least = min(one.seconds for one in standings.values())
    return standings[engine].seconds / least if least > 0 else 1.0


def _explained(engine: str, one: Standing) -> str:
    runs = "one run" if one.runs == 1 else f"mean of {one.runs} runs"
    against = f"held against {' and '.join(one.finest)}" if one.finest else "the finest physics"
    broken = f"; beyond the scene's bound: {', '.join(one.broken)}" if one.broken else ""
    return f"{engine}: {against}; {in_seconds(one.seconds)} of stepping, {runs}{broken}"


def in_seconds(x: float) -> str:
    """Return a time to two digits, in the unit that suits it."""
    factor, unit = (1, "s") if x >= 1 else (1e3, "ms") if x >= 1e-3 else (1e6, "µs")
    shown = factor * x
    return f"{shown:.0f} {unit}" if shown >= 10 else f"{shown:.2g} {unit}"


def _lead(engines: list[str], scenes: list[Ranked]) -> list[str]:
    """Return one sentence an engine: how far it lies from the finest physics, at what cost."""
    said = []
    for engine in engines:
        found = [s.standings for s in scenes if engine in s.standings]
        totals = [f[engine].total for f in found if not isnan(f[engine].total)]
        own = [f[engine].own for f in found if not isnan(f[engine].own)]
        ratios = [_ratio(f, engine) for f in found]
        far = f"{_span(totals)} from the finest physics" if totals else "the finest physics here"
        error = f", {percent(max(own))} % of it at most their own numerical error" if own else ""
        said.append(f"{WORDS[engine]}: {far}{error}; {_cost(ratios)}")
    return said


def _span(values: list[float]) -> str:
    low, high = percent(min(values)), percent(max(values))
    return f"{low} %" if low == high else f"{low} to {high} %"


def _cost(ratios: list[float]) -> str:
    low, high = (f"{x:.0f}" if x >= 10 else f"{x:.2g}" for x in (min(ratios), max(ratios)))
    if low == high == "1":
        return "the cheapest"
    return f"{low if low == high else f'{low} to {high}'} times the cheapest engine's time"
