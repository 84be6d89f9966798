"""The tables of the report, as plain text in rows."""

from collections.abc import Callable, Iterable
from itertools import chain
from math import isfinite
from typing import NamedTuple

import pandas as pd
import xarray as xr

from compare.figures.subplots import variant_names
from compare.misfit.differences import STRESS, VELOCITY, PeakDifference, peak_ratios
from compare.misfit.pairs import Comparison, Pair, Row, meaning, pairs
from compare.misfit.places import Place
from compare.report.verdict import Standing
from results.dataset import energy_residual, open_ledger


class Table(NamedTuple):
    """Column names, and rows of cells in groups: a heading, then its rows."""

    header: list[str]
    groups: dict[str, list[list[str]]]


def title(pair: Pair) -> str:
    """Return a pair as scene files write it."""
    return f"{pair.one} ~ {pair.other}"


def percent(x: float) -> str:
    """Return a ratio in percent to three digits; below 0.001 % only that it is."""
    if not isfinite(x):
        return "–"
    if 0 < x < 1e-5:
        return "< 0.001"
    return f"{100 * x:#.3g}".rstrip(".")


def mean_and_worst(peak: PeakDifference | None) -> str:
    """Return a difference of peaks in percent, of all receivers and of the worst."""
    return f"{100 * peak.mean:.2g}, ≤ {100 * peak.worst:.2g}" if peak else ""


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


def distance_frame(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return the same as numbers, SI, for a machine to read; beside it the ratio of what engineers
    read off all components at the receiver."""
    peaks = {
        (name, pair): peak_ratios(one.results[pair.one], one.results[pair.other])
        for name, one in zip(variant_names(comparisons), comparisons, strict=True)
        for pair in dict.fromkeys(row.pair for row in one.rows)
        if {pair.one, pair.other} <= one.results.keys()
    }
    return pd.DataFrame(
        {
            "kind": row.pair.kind,
            "pair": title(row.pair),
            "variant": name,
            "quantity": row.place.named,
            **{f"{axis} (m)": at for axis, at in row.place.coordinates.items()},
            "relative L2": row.distance.misfit,
            "own error of the reference": row.floor,
            "faint": row.faint,
            "of all motion": row.of_all,
            "peak ratio": row.distance.peak_ratio,
            "PPV or peak stress ratio": peaks.get((name, row.pair), {}).get(
                (row.place.quantity, row.place.at)
            ),
            "delay (s)": row.distance.delay,
            "period ratio": row.distance.period_ratio,
            "envelope misfit": row.distance.envelope,
            "phase misfit": row.distance.phase,
        }
        for name, row in _rows(comparisons)
    )


def alignment_frame(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return how each file of others' curves was put beside each variant, SI."""
    return pd.DataFrame(
        {
            "file": beside.curves.name,
            "variant": name,
            "samples": len(beside.time),
            "times": "file" if beside.own_times else "scene",
            "start (s)": beside.time[0],
            "end (s)": beside.time[-1],
            "outside": beside.outside,
            "missed": beside.missed,
            "moved by (s)": beside.shift.seconds if beside.shift else 0.0,
            "onto": beside.shift.onto if beside.shift else "",
            "correlation": beside.shift.correlation if beside.shift else None,
        }
        for name, comparison in zip(variant_names(comparisons), comparisons, strict=True)
        for beside in comparison.besides
    )


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
    ledger = result["energy"].values, result["term"].values.tolist()
    return f"{energy_residual(result):.1e}{' (open)' if open_ledger(*ledger, result.attrs) else ''}"


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
