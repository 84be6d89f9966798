"""The tables of a scene on the page: what a row is stands in the index, numbers in the columns,
misfits in percent."""

from typing import Any

import pandas as pd
import xarray as xr

from jointwave.compare.figures.tables import rows_of
from jointwave.compare.figures.variants import named
from jointwave.compare.misfit.pairs import Comparison, meaning
from jointwave.compare.report.verdict import EngineScore
from jointwave.compare.text import mean_and_worst
from jointwave.results.dataset import energy_residual, open_ledger
from jointwave.results.labels import PEAKS

#: Columns of distances, in their order, with the factor of each.
DISTANCES = {"relative L2 (%)": 100, "peak ratio": 1, "delay (ms)": 1e3, "period ratio": 1}
DISTANCES |= {"envelope misfit (%)": 100, "phase misfit (%)": 100}
MANY = 8  # columns: a table of more is transposed


def _under(rows: list[dict[str, Any]], *index: str) -> pd.DataFrame:
    return pd.DataFrame(rows).set_index(list(index)) if rows else pd.DataFrame()


def verdict_table(scores: dict[str, EngineScore]) -> pd.DataFrame:
    """Return the verdict on each engine in each variant, with what engineers read."""
    rows = [
        {
            "engine": engine,
            "variant": one.variant,
            "worst misfit (%)": 100 * one.total.judged,
            "at": one.total.where if one.against else "",
            **{f"{name} (%)": mean_and_worst(one.peaks.get(name)) for name in PEAKS},
            "compared with": one.against,
            "which is a": one.meaning,
            "own error (%)": 100 * one.own.judged,
            "verdict": f"{one.verdict.sign} {one.verdict.word}",
        }
        for engine, score in scores.items()
        for one in score.variants
    ]
    return _under(rows, "engine", "variant")


def misfit_table(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return the relative L2 misfits: a row a pair, a column a variant and receiver, or where these
    are many the other way round.

    Faint waveforms and displacements, which are velocities once more, are in `distance_table`.
    """
    shown = [
        (variant, row)
        for variant, row in rows_of(comparisons)
        if not (row.faint or row.place.quantity == "displacement")
    ]
    several = len({row.place for _, row in shown}) > 1
    cells: dict[tuple[str, str, str], dict[str, float]] = {}
    for variant, row in shown:
        label = f"{variant}, {row.place.words} (%)" if several else f"{variant} (%)"
        at = row.pair.kind, row.solutions, meaning(row.pair)
        cells.setdefault(at, {})[label] = 100 * row.distance.misfit
    names = ["kind", "pair", "cause of the difference"]
    table = pd.DataFrame(list(cells.values()), pd.MultiIndex.from_tuples(cells, names=names))
    if len(table.columns) <= MANY:
        return table
    long = table.droplevel(2).T.rename(index=lambda at: at.removesuffix(" (%)"))
    long = long.rename(columns=lambda pair: f"{pair} (%)", level=1)
    return long.rename_axis(index="variant and receiver", columns=[None, None])


def distance_table(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return every distance of every pair at every receiver of every variant."""
    rows = [
        {"kind": row.pair.kind, "variant": name, "pair": row.solutions, "receiver": row.place.words}
        | {head: x and k * x for (head, k), x in zip(DISTANCES.items(), row.distance, strict=True)}
        for name, row in rows_of(comparisons)
    ]
    return _under(rows, "kind", "variant", "pair", "receiver")


def worst_misfits(comparisons: list[Comparison]) -> pd.Series:
    """Return by kind and pair the largest misfit over the variants, of the waveform that is
    furthest off, as `[expect]` bounds it."""
    rows = [
        (row.pair.kind, row.solutions, 0.0 if row.faint else 100 * row.distance.misfit)
        for _, row in rows_of(comparisons)
    ]
    table = pd.DataFrame(rows, columns=["kind", "pair", "misfit"])
    return table.groupby(["kind", "pair"], sort=False)["misfit"].max()


def run_table(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return what each engine's run took, and how well its energy ledger closes."""
    rows = [
        {
            "engine": engine,
            "variant": variant,
            "degrees of freedom": result.attrs["degrees_of_freedom"],
            "steps": result.attrs["steps"],
            "step (µs)": 1e6 * result.attrs["dt"],
            "of the critical step": result.attrs["dt"] / result.attrs["critical_dt"],
            "stepping (s)": float(result.attrs["seconds_stepping"]),
            "energy residual": _residual(result),
        }
        for variant, one in named(comparisons)
        for engine, result in one.results.items()
        if "steps" in result.attrs
    ]
    return _under(rows, "engine", "variant")


def _residual(result: xr.Dataset) -> str:
    if "energy" not in result:
        return "not recorded"
    return f"{energy_residual(result):.1e}{' (open)' * bool(open_ledger(result))}"


def reason_table(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return why the solutions that are not drawn do not apply, and to which variants."""
    columns = ["solution", "variants", "why it does not apply"]
    rows = [
        (solution, variant, reason)
        for variant, one in named(comparisons)
        for solution, reason in one.reasons.items()
    ]
    alike = pd.DataFrame(rows, columns=columns).groupby(columns[::2], as_index=False)["variants"]
    every = len(comparisons)
    table = alike.agg(lambda names: "all" if len(names) == every else "; ".join(names))
    return table[columns]
