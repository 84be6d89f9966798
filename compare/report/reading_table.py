"""The table of engineering measures of every solution's velocities."""

from collections.abc import Iterator
from math import isfinite

import numpy as np
import pandas as pd
import xarray as xr

from compare.figures.subplots import variant_names
from compare.misfit.pairs import Comparison
from compare.misfit.places import Place
from compare.readings import arias_intensity, peak_velocity, response_spectrum, wave_speed
from compare.report.tables import Table
from results.labels import RECEIVERS

#: Periods of the oscillators: how many, and the shortest one in samples.
PERIODS, SHORTEST = 60, 8
NUMBERS = (
    "peak velocity (m/s)",
    "Arias intensity (m/s)",
    "spectral acceleration (m/s2)",
    "at period (s)",
    "speed (m/s)",
)


def reading_frame(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return a row for each receiver of velocity of each solution of each variant, SI.

    Peak particle velocity; Arias intensity and the largest pseudo-acceleration of oscillators with
    5 % damping, of the direction in which they are largest; and the speed from the first receiver
    by cross-correlation of the whole records.
    """
    return pd.DataFrame(
        {"variant": name, "solution": solution, **row}
        for name, comparison in zip(variant_names(comparisons), comparisons, strict=True)
        for solution, result in comparison.results.items()
        for row in _rows(result)
    )


def _rows(result: xr.Dataset) -> Iterator[dict[str, float | str]]:
    if "velocity" not in result or not result["velocity"].size:
        return
    receiver = str(next(d for d in result["velocity"].dims if d in RECEIVERS))
    time = result["time"].values
    periods = np.geomspace(SHORTEST * (time[1] - time[0]), time[-1] - time[0], PERIODS)
    acceleration = response_spectrum(result, periods)["pseudo_acceleration"].max("axis")
    peaks, intensities = peak_velocity(result).values, arias_intensity(result).max("axis").values
    at = np.stack([result[name].values for name in RECEIVERS[receiver]], axis=1)
    for i, values in enumerate(acceleration.values):
        speed = wave_speed(result, 0, i) if i and peaks[i] and peaks[0] else np.nan
        top = int(values.argmax())
        place = Place("velocity", "", tuple(at[i].tolist()))
        found = peaks[i], intensities[i], values[top], periods[top], speed
        yield {"at": place.receiver} | dict(zip(NUMBERS, map(float, found), strict=True))


def reading_table(frame: pd.DataFrame) -> Table:
    """Return the same as text, four digits each, a group a variant."""
    groups: dict[str, list[list[str]]] = {}
    for row in frame.to_dict("records"):
        numbers = (row[name] for name in NUMBERS)
        cells = [f"{x:.4g}" if isfinite(x) else "–" for x in numbers]
        groups.setdefault(row["variant"], []).append([row["solution"], row["at"], *cells])
    return Table(["solution", "at", *NUMBERS], groups)
