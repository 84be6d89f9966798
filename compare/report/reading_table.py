"""The table of engineering measures of every solution's velocities."""

from collections.abc import Iterator
from math import isfinite

import numpy as np
import pandas as pd
import xarray as xr

from cases.records import Column
from compare.figures.subplots import variant_names
from compare.misfit.pairs import Comparison
from compare.misfit.places import Place
from compare.readings import (
    arias_intensity,
    peak_velocity,
    quality_factor,
    response_spectrum,
    wave_speed,
)
from compare.readings.attenuation import sampling, waveforms
from compare.readings.recordings import dataset_of
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
    "apparent Q",
)


def reading_frame(comparisons: list[Comparison]) -> pd.DataFrame:
    """Return a row for each receiver of velocity of each solution of each variant, SI.

    Peak particle velocity; Arias intensity and the largest pseudo-acceleration of oscillators with
    5 % damping, of the direction in which they are largest; and from the first receiver, of whole
    records, the speed by cross-correlation and the apparent Q where the first one is loudest.
    """
    return pd.DataFrame(
        {"variant": name, "solution": solution, **row}
        for name, comparison in zip(variant_names(comparisons), comparisons, strict=True)
        for solution, result in _results(comparison)
        for row in _rows(result)
    )


def _results(comparison: Comparison) -> Iterator[tuple[str, xr.Dataset]]:
    """Yield solutions, and then curves of others at each receiver, by name."""
    yield from comparison.results.items()
    for curves in (beside.curves for beside in comparison.besides):
        moving = [place for place in curves.waveforms if place.quantity == "velocity"]
        for at in dict.fromkeys(place.at for place in moving):
            here = [place for place in moving if place.at == at]
            columns = [Column(str(place), "", curves.waveforms[place]) for place in here]
            yield curves.name, dataset_of(curves.time, columns, "velocity")


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
        apart = i and peaks[i] and peaks[0]
        speed, Q = (wave_speed(result, 0, i), _quality(result, i)) if apart else (np.nan, np.nan)
        top = int(values.argmax())
        place = Place("velocity", "", tuple(at[i].tolist()))
        found = peaks[i], intensities[i], values[top], periods[top], speed, Q
        yield {"at": place.receiver} | dict(zip(NUMBERS, map(float, found), strict=True))


def _quality(result: xr.Dataset, i: int) -> float:
    """Return the apparent Q from the first receiver to another at the frequency that is loudest;
    nan where nothing is lost there."""
    row = waveforms(result)
    size = np.abs(np.fft.rfft(row[0].values))
    loudest = np.fft.rfftfreq(row.sizes["time"], sampling(row))[1 + size[1:].argmax()]
    Q = float(quality_factor(result, 0, i).quality.sel(frequency=loudest, method="nearest"))
    return Q if 0 < Q < np.inf else np.nan


def reading_table(frame: pd.DataFrame) -> Table:
    """Return the same as text, four digits each, a group a variant."""
    groups: dict[str, list[list[str]]] = {}
    for row in frame.to_dict("records"):
        numbers = (row[name] for name in NUMBERS)
        cells = [f"{x:.4g}" if isfinite(x) else "–" for x in numbers]
        groups.setdefault(row["variant"], []).append([row["solution"], row["at"], *cells])
    return Table(["solution", "at", *NUMBERS], groups)
