"""Tables of a comparison in SI, and its files: distances, readings of velocities, how curves were
aligned."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from jointwave.compare.figures.charts.waveforms import draw_solutions
from jointwave.compare.figures.export import save
from jointwave.compare.figures.receivers import curve_table
from jointwave.compare.figures.variants import named
from jointwave.compare.misfit.pairs import Comparison, Row
from jointwave.compare.misfit.places import Place, places_of
from jointwave.compare.readings.attenuation import quality_factor, wave_speed, waveforms
from jointwave.compare.readings.ground_motion import arias, ppv, response_spectrum
from jointwave.compare.readings.recordings import dataset_of, sampling
from jointwave.compare.runs import timings
from jointwave.compare.runs.output import write_csv

PERIODS, SHORTEST = 60, 8  # of oscillators: how many, and the shortest period in samples
#: Columns of distances, by their names in `Row.facts`.
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
NAME = "comparison"  # of the files of a comparison
READINGS = (
    "peak velocity (m/s)",
    "Arias intensity (m/s)",
    "spectral acceleration (m/s2)",
    "at period (s)",
    "speed (m/s)",
    "apparent Q",
)


def rows_of(comparisons: list[Comparison]) -> list[tuple[str, Row]]:
    """Return every distance, with the name of its variant."""
    return [(name, row) for name, comparison in named(comparisons) for row in comparison.rows]


def distance_frame(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return every distance of every pair at every receiver of every variant."""
    rows = [{"variant": v, "pair": row.solutions, **row.facts} for v, row in rows_of(comparisons)]
    found = pd.DataFrame(rows)
    axes = {axis: f"{axis} (m)" for axis in "xyz" if axis in found}
    names = {**dict.fromkeys(("kind", "pair", "variant", "quantity")), **axes, **DISTANCES}
    return found.reindex(columns=list(names)).rename(columns=axes | DISTANCES)


def alignment_frame(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return how each file of others' curves was put beside each variant."""
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
    """Return what engineers read off each receiver of velocity of each solution of each variant.

    Peak particle velocity; Arias intensity and the largest pseudo-acceleration of oscillators with
    5 % damping, of the direction in which they are largest; and from the first receiver, of whole
    records, the speed by cross-correlation and the apparent Q where the first one is loudest.
    """
    return pd.DataFrame(
        {"variant": name, "solution": solution, **row}
        for name, comparison in named(comparisons)
        for solution, result in _velocities(comparison)
        for row in _readings(result)
    )


def _velocities(comparison: Comparison) -> Iterator[tuple[str, xr.Dataset]]:
    """Yield the solutions with velocities, then the velocities of others at each receiver."""
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
            lossy = quality.where((quality > 0) & (quality < np.inf))  # nan where nothing is lost
            speed, Q = wave_speed(result, 0, i), lossy.sel(frequency=loudest, method="nearest")
        k = int(values.argmax())
        found = peaks[i], intensities[i], values[k], periods[k], speed, Q
        where = {"at": Place("velocity", "", at).receiver}
        yield where | dict(zip(READINGS, map(float, found), strict=True))


def write_comparisons(comparisons: list[Comparison], out: Path) -> None:
    """Write the figure and the tables of a scene's variants into a folder: comparison.csv with the
    curves, comparison-misfits.csv, and where there are velocities or curves of others
    comparison-readings.csv and comparison-alignment.csv."""
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
