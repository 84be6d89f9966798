"""Tables of a scene's variants, and their files: misfits, readings of velocities, alignment of
curves, runs, and why solutions do not apply.

Frames hold SI numbers, one fact per column; tables are for display, with misfits in percent.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from jointwave.compare.figures.charts.waveforms import draw_solutions
from jointwave.compare.figures.export import save
from jointwave.compare.figures.receivers import curve_table, named
from jointwave.compare.misfit.pairs import Comparison, Row, meaning
from jointwave.compare.misfit.places import Place, places_of
from jointwave.compare.readings.attenuation import quality_factor, wave_speed, waveforms
from jointwave.compare.readings.ground_motion import arias, ppv, response_spectrum
from jointwave.compare.readings.recordings import dataset_of, sampling
from jointwave.compare.runs import timings
from jointwave.compare.runs.output import write_csv
from jointwave.results.dataset import energy_residual, open_ledger

PERIODS, SHORTEST = 60, 8  # number of oscillators, and their shortest period in samples
#: Columns of `distance_frame`, by their names in `Row.facts`.
DISTANCES = {
    "misfit": "relative L2",
    "floor": "own error of the reference",
    "faint": "faint",
    "of_all": "of all motion",
    "peak_ratio": "peak ratio",
    "delay": "delay (s)",
    "period_ratio": "period ratio",
    "envelope": "envelope misfit",
    "phase": "phase misfit",
}
#: Columns of `distance_table` in the order of `Distance`, with the factor of each.
SHOWN = {"relative L2 (%)": 100, "peak ratio": 1, "delay (ms)": 1e3, "period ratio": 1}
SHOWN |= {"envelope misfit (%)": 100, "phase misfit (%)": 100}
MANY = 8  # columns; a wider table is transposed
NAME = "comparison"  # of the files of a comparison
READINGS = (
    *("peak velocity (m/s)", "Arias intensity (m/s)", "spectral acceleration (m/s2)"),
    *("at period (s)", "speed (m/s)", "apparent Q"),
)


def rows_of(comparisons: list[Comparison]) -> list[tuple[str, Row]]:
    """Return every row of the comparisons, with the name of its variant."""
    return [(name, row) for name, comparison in named(comparisons) for row in comparison.rows]


def _under(rows: list[dict[str, Any]], *index: str) -> pd.DataFrame:
    return pd.DataFrame(rows).set_index(list(index)) if rows else pd.DataFrame()


def distance_frame(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return all measures of distance of every pair at every receiver of every variant."""
    rows = [{"variant": v, "pair": row.solutions, **row.facts} for v, row in rows_of(comparisons)]
    found = pd.DataFrame(rows)
    axes = {axis: f"{axis} (m)" for axis in "xyz" if axis in found}
    names = {**dict.fromkeys(("kind", "pair", "variant", "quantity")), **axes, **DISTANCES}
    return found.reindex(columns=list(names)).rename(columns=axes | DISTANCES)


def misfit_table(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return the relative L2 misfits by pair, variant and receiver; a wide table is transposed.

    Faint waveforms, and displacements (integrals of the velocities), are in `distance_table` only.
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
    """Return the distances of every pair at every receiver of every variant, for display."""
    rows = [
        {"kind": row.pair.kind, "variant": name, "pair": row.solutions, "receiver": row.place.words}
        | {head: x and k * x for (head, k), x in zip(SHOWN.items(), row.distance, strict=True)}
        for name, row in rows_of(comparisons)
    ]
    return _under(rows, "kind", "variant", "pair", "receiver")


def worst_misfits(comparisons: list[Comparison]) -> pd.Series:
    """Return by kind and pair the misfit of the worst waveform, as `[expect]` bounds it."""
    found = distance_frame(comparisons)
    misfits = 100 * found[DISTANCES["misfit"]].where(~found["faint"].astype(bool), 0.0)
    return misfits.groupby([found["kind"], found["pair"]], sort=False).max().rename("misfit")


def alignment_frame(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return how each file of external curves was aligned with each variant."""
    return pd.DataFrame(
        {
            "file": beside.curves.name,
            "variant": name,
            "samples": len(beside.time),
            "times": "file" if beside.own_times else "scene",
            "start (s)": beside.time[0],
            "end (s)": beside.time[-1],
            "outside": beside.outside,
            "moved by (s)": beside.shift.seconds if beside.shift else 0.0,
            "onto": beside.shift.onto if beside.shift else "",
            "correlation": beside.shift.correlation if beside.shift else None,
        }
        for name, comparison in named(comparisons)
        for beside in comparison.besides
    )


def reading_frame(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return engineering measures at each velocity receiver of each solution of each variant.

    These are peak particle velocity; Arias intensity and largest pseudo-acceleration of oscillators
    with 5 % damping, each along its worst axis; and between the first receiver and this one the
    wave speed by cross-correlation and the apparent Q at the peak frequency of the first record.
    """
    return pd.DataFrame(
        {"variant": name, "solution": solution, **row}
        for name, comparison in named(comparisons)
        for solution, result in _velocities(comparison)
        for row in _readings(result)
    )


def _velocities(comparison: Comparison) -> Iterator[tuple[str, xr.Dataset]]:
    """Yield the solutions with velocities, then the external velocities at each receiver."""
    for name, result in comparison.results.items():
        if "velocity" in result and result["velocity"].size:
            yield name, result
    for curves in (beside.curves for beside in comparison.besides):
        there: dict[tuple[float, ...], dict[Place, np.ndarray]] = {}
        for place, values in curves.waveforms.items():
            if place.quantity == "velocity":
                there.setdefault(place.at, {})[place] = values
        for waves in there.values():
            yield curves.name, dataset_of(curves.time, waves)


def _readings(result: xr.Dataset) -> Iterator[dict[str, float | str]]:
    time, row = result["time"].values, waveforms(result)
    periods = np.geomspace(SHORTEST * (time[1] - time[0]), time[-1] - time[0], PERIODS)
    acceleration = response_spectrum(result, periods)["pseudo_acceleration"].max("axis")
    peaks, intensities = ppv(result).values, arias(result).max("axis").values
    size = np.abs(np.fft.rfft(row[0].values))
    loudest = np.fft.rfftfreq(len(time), sampling(row))[1 + size[1:].argmax()]
    places, _ = places_of(result, "velocity")
    for i, (at, values) in enumerate(zip(places, acceleration.values, strict=True)):
        speed = Q = np.nan
        if i and peaks[i] and peaks[0]:
            quality = quality_factor(result, 0, i).quality
            lossy = quality.where((quality > 0) & (quality < np.inf))  # nan without attenuation
            speed, Q = wave_speed(result, 0, i), lossy.sel(frequency=loudest, method="nearest")
        k = int(values.argmax())
        found = peaks[i], intensities[i], values[k], periods[k], speed, Q
        where = {"at": Place("velocity", "", at).receiver}
        yield where | dict(zip(READINGS, map(float, found), strict=True))


def run_table(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return size, steps, cost and energy residual of each run with time steps."""
    rows = [
        {
            "engine": engine,
            "variant": variant,
            "degrees of freedom": result.attrs["degrees_of_freedom"],
            "steps": result.attrs["steps"],
            "step (µs)": 1e6 * result.attrs["dt"],
            "of the critical step": result.attrs["dt"] / result.attrs["critical_dt"],
            "stepping (s)": float(result.attrs["seconds_stepping"]),
            "energy residual": _residual(result) if "energy" in result else "not recorded",
        }
        for variant, one in named(comparisons)
        for engine, result in one.results.items()
        if "steps" in result.attrs
    ]
    return _under(rows, "engine", "variant")


def _residual(result: xr.Dataset) -> str:
    return f"{energy_residual(result):.1e}{' (open)' * bool(open_ledger(result))}"


def reason_table(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return why solutions do not apply or have failed, and for which variants."""
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


def write_comparisons(comparisons: list[Comparison], out: Path) -> None:
    """Write the figure and tables of a scene's variants into a folder: comparison.csv with the
    curves, comparison-misfits.csv, comparison-readings.csv if there are velocities, and
    comparison-alignment.csv if there are external curves."""
    folder, scene = Path(out), comparisons[0].scene
    with timings.measured("tables", scene.kind, len(comparisons)):
        curves = curve_table(comparisons)
        save(draw_solutions(comparisons), folder, NAME, scene.title, curves)
        write_csv(folder / f"{NAME}-misfits.csv", distance_frame(comparisons))
        for name, table in (
            ("readings", reading_frame(comparisons)),
            ("alignment", alignment_frame(comparisons)),
        ):
            if not table.empty:
                write_csv(folder / f"{NAME}-{name}.csv", table)
