"""The xarray accessor `result.jw`: figures of a result. `jointwave.simulate` and `compare` import
it; a script that reads results from files imports this module."""

from __future__ import annotations

import json
from itertools import count
from typing import TYPE_CHECKING

import xarray as xr

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@xr.register_dataset_accessor("jw")
class ResultFigures:
    """Figures of a result."""

    def __init__(self, result: xr.Dataset) -> None:
        self.result = result

    def plot(self, *others: xr.Dataset, width: float = 190.0, font_size: float = 8.0) -> Figure:
        """Return the waveforms at every receiver with those of other results. Other solvers share
        axes; other variants, other physics or the same solver again start a new row.

        width : mm. font_size : points. A static state is subtracted.
        """
        from jointwave.compare.figures.body_maps import scene_of
        from jointwave.compare.figures.charts.waveforms import ASIDE, draw_solutions
        from jointwave.compare.figures.style import printed
        from jointwave.compare.misfit.pairs import Comparison

        found: dict[tuple[str, str, int], Comparison] = {}
        for number, one in enumerate((self.result, *others), start=1):
            variant, solver = one.attrs["variant"], one.attrs["engine"]
            tables = json.loads(one.attrs["scene"])
            physics = json.dumps({key: x for key, x in tables.items() if key not in ASIDE})
            scene = scene_of(one)
            if variant in [known for known, *_ in found]:
                scene = scene.model_copy(update={"name": f"result {number}"})
            rows = (found.setdefault((variant, physics, k), Comparison(scene)) for k in count())
            next(row for row in rows if solver not in row.results).results[solver] = one
        return draw_solutions(list(found.values()), False, printed(width, font_size))

    def plot_map(
        self,
        quantity: str = "ppv",
        other: xr.Dataset | None = None,
        time: float | None = None,
        section: str | None = None,
    ) -> Figure:
        """Return a map of the whole body, as `jointwave.plot_map` does."""
        from jointwave.compare.figures.charts.maps import plot_map

        return plot_map(self.result, quantity, other, time, section)
