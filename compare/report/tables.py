"""The tables of the report, as plain text in rows."""

from collections.abc import Callable, Iterable
from itertools import chain
from math import isfinite
from typing import NamedTuple

import xarray as xr

from compare.figures.panels import variant_names
from compare.misfit.differences import STRESS, VELOCITY
from compare.misfit.pairs import Comparison, Pair, Row, meaning, pairs
from compare.misfit.places import Place
from compare.report.verdict import Standing
from compare.text import mean_and_worst, percent
from results.dataset import energy_residual, open_ledger


class Table(NamedTuple):
    """Column names, and rows of cells in groups: a heading, then its rows."""

    header: list[str]
    groups: dict[str, list[list[str]]]


def title(pair: Pair) -> str:
    """Return a pair as scene files write it."""
    return f"{pair.one} ~ {pair.other}"


def verdict_table(standings: dict[str, Standing]) -> Table:
    """Return the verdict on each engine, a row a variant, with what engineers read."""
    header = ["variant", "worst misfit (%)", "at", "PPV (%)", "peak stress (%)"]
    header += ["compared with", "which is a", "verdict"]
    groups = {
        engine: [
            [
                held.variant,
                percent(held.total.judged),
                held.total.where if held.against else "",
                *(mean_and_worst(held.peaks.get(name)) for name in (VELOCITY, STRESS)),
                held.against,
                held.meaning,
                f"{held.verdict.sign} {held.verdict.word}",
            ]
            for held in one.variants
        ]
        for engine, one in standings.items()
    }
    return Table(header, groups)


def misfit_table(comparisons: list[Comparison]) -> Table:
    """Return the relative L2 misfits in %: one row a pair, one column a variant and receiver.

    Faint waveforms and displacements, which are velocities once more, are in `distance_table`.
    """
    shown = [
        (name, row)
        for name, row in _rows(comparisons)
        if not (row.faint or row.place.quantity == "displacement")
    ]
    places = list(dict.fromkeys(row.place for _, row in shown))
    cells: dict[Pair, dict[tuple, str]] = {}
    for name, row in shown:
        cells.setdefault(row.pair, {})[name, row.place] = percent(row.distance.misfit)
    columns = [(name, place) for name in variant_names(comparisons) for place in places]
    header = ["pair", "cause of the difference"]
    header += [
        f"{name}, {_column(at, places)}" if len(places) > 1 else name for name, at in columns
    ]

    def lines(pair: Pair) -> list[list[str]]:
        if pair not in cells:
            return []
        found = [cells[pair].get(column, "") for column in columns]
        return [[title(pair), meaning(pair), *found]]

    return Table(header, _by_kind(lines, comparisons))


def _column(place: Place, places: list[Place]) -> str:
    """Return a receiver as it heads a column, with what is there where there is more than one."""
    several = sum(one.at == place.at for one in places) > 1
    return place.words if several and len(place.at) > 1 else place.receiver


def _rows(comparisons: list[Comparison]) -> list[tuple[str, Row]]:
    """Return every distance with its variant."""
    named = zip(variant_names(comparisons), comparisons, strict=True)
    return [(name, row) for name, comparison in named for row in comparison.rows]


def _by_kind(
    lines: Callable[[Pair], list[list[str]]], comparisons: Iterable[Comparison]
) -> dict[str, list[list[str]]]:
    """Return the lines of all pairs by the meaning of their distance: first as the solvers' records
    have it, then where a scene makes two models of them, and others' curves."""
    measured = (row.pair for comparison in comparisons for row in comparison.rows)
    groups: dict[str, list[list[str]]] = {}
    for pair in dict.fromkeys((*pairs(), *measured)):
        if found := lines(pair):
            groups.setdefault(pair.kind, []).extend(found)
    return groups


def distance_table(comparisons: list[Comparison]) -> Table:
    """Return every distance of every pair at every receiver of every variant."""
    rows = _rows(comparisons)

    def lines(pair: Pair) -> list[list[str]]:
        return [
            [title(pair), name, row.place.words, *_distances(row)]
            for name, row in rows
            if row.pair == pair
        ]

    header = ["pair", "variant", "receiver", "relative L2 (%)", "peak ratio", "delay (ms)"]
    header += ["period ratio", "envelope misfit (%)", "phase misfit (%)"]
    return Table(header, _by_kind(lines, comparisons))


def _distances(row: Row) -> list[str]:
    d = row.distance
    ratios = [
        format(x, form) if isfinite(x) else "–"
        for x, form in ((d.peak_ratio, ".4f"), (1e3 * d.delay, "+.3f"), (d.period_ratio, ".4f"))
    ]
    spectral = ["" if x is None else percent(x) for x in (d.envelope, d.phase)]
    return [percent(d.misfit), *ratios, *spectral]


def run_table(comparisons: list[Comparison]) -> Table:
    """Return what each engine's run took, and how well its energy ledger closes."""
    groups: dict[str, list[list[str]]] = {}
    for variant, comparison in zip(variant_names(comparisons), comparisons, strict=True):
        for name, result in comparison.results.items():
            if "steps" in result.attrs:
                groups.setdefault(name, []).append([variant, *_run_cells(result)])
    header = ["variant", "degrees of freedom", "steps", "step (µs)", "of the critical step"]
    return Table([*header, "stepping (s)", "energy residual"], groups)


def _run_cells(result: xr.Dataset) -> list[str]:
    about = result.attrs
    return [
        str(about["degrees_of_freedom"]),
        str(about["steps"]),
        f"{1e6 * about['dt']:.3g}",
        f"{about['dt'] / about['critical_dt']:.3f}",
        f"{about['seconds_stepping']:.3f}",
        _energy_cell(result),
    ]


def _energy_cell(result: xr.Dataset) -> str:
    if "energy" not in result:
        return "not recorded"
    return f"{energy_residual(result):.1e}{' (open)' if open_ledger(result) else ''}"


def reason_table(comparisons: list[Comparison]) -> Table:
    """Return why the solutions that are not drawn do not apply."""
    found: dict[tuple[str, str], list[str]] = {}
    for variant, comparison in zip(variant_names(comparisons), comparisons, strict=True):
        for name, reason in comparison.reasons.items():
            found.setdefault((name, reason), []).append(variant)
    rows = [
        [name, "all" if len(variants) == len(comparisons) else "; ".join(variants), reason]
        for (name, reason), variants in sorted(found.items())
    ]
    return Table(["solution", "variants", "why it does not apply"], {"": rows} if rows else {})


def summary_table(figures: dict[str, list[Comparison]]) -> Table:
    """Return the largest misfit in % of each pair over the variants of each figure.

    Of the waveform that is furthest off, as `[expect]` bounds it.
    """

    def worst(pair: Pair, comparisons: list[Comparison]) -> str:
        rows = [row for one in comparisons for row in one.rows if row.pair == pair]
        found = (row.distance.misfit for row in rows if not row.faint)
        return percent(max(found, default=0.0)) if rows else ""

    def lines(pair: Pair) -> list[list[str]]:
        cells = [worst(pair, comparisons) for comparisons in figures.values()]
        return [[title(pair), *cells]] if any(cells) else []

    return Table(["pair", *figures], _by_kind(lines, chain(*figures.values())))
