"""A row of receivers: one waveform each, and how far it is along the row."""

from __future__ import annotations

import numpy as np
import xarray as xr

from cases.errors import SceneError
from compare.misfit.metrics import motion
from results.labels import RECEIVERS


def waveforms(
    result: xr.Dataset, quantity: str = "velocity", axis: str | None = None
) -> xr.DataArray:
    """Return one component of a quantity less its static state [receiver, time], with `distance`
    (m) from the first receiver.

    axis : the component, "x", "y", "xy" ...; None: the one that moves most.
    """
    if quantity not in result:
        where = str(result.attrs.get("title", "result"))
        raise SceneError(where, "quantity", quantity, f"must be one of {', '.join(_known(result))}")
    found = result[quantity].copy(data=motion(result, quantity))
    receiver, places = next((d, RECEIVERS[str(d)]) for d in found.dims if d in RECEIVERS)
    for components in set(found.dims) - {receiver, "time"}:
        loudest = abs(found).max([receiver, "time"]).values.argmax()
        chosen = list(found[components].values).index(axis) if axis else int(loudest)
        found = found.isel({components: chosen})
    along = np.array([result[name].values - result[name].values[0] for name in places])
    found = found.transpose(receiver, "time").rename({receiver: "receiver"})
    return found.assign_coords(distance=("receiver", np.hypot.reduce(along, axis=0)))


def _known(result: xr.Dataset) -> list[str]:
    """Return the quantities that receivers record."""
    return [str(n) for n, x in result.items() if "time" in x.dims and set(x.dims) & set(RECEIVERS)]


def sampling(row: xr.DataArray) -> float:
    """Return the time between samples, s."""
    time = row["time"].values
    return float(time[-1] - time[0]) / (len(time) - 1)
