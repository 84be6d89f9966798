"""Maps of the peak particle velocity of a rock mass, for every engine with snapshots of its whole
field."""

import pandas as pd

from jointwave.compare.engines import in_order
from jointwave.compare.figures.body_maps import Map, maps_of
from jointwave.compare.figures.charts.maps import draw_maps
from jointwave.compare.figures.export import SceneFigure
from jointwave.compare.figures.variants import variant_names
from jointwave.compare.misfit.pairs import Comparison

CAPTION = (
    "The largest particle velocity of each cell, the mean of its nodes', over all snapshots "
    "(record.fields): peaks between snapshots are missed."
)


def peak_velocities(name: str, comparisons: list[Comparison]) -> list[SceneFigure]:
    """Return the maps, one figure per variant; empty for a pillar, or without fields."""
    found = []
    for k, (variant, one) in enumerate(zip(variant_names(comparisons), comparisons, strict=True)):
        results = [one.results[engine] for engine in in_order(one.results)]
        results = [result for result in results if "field_velocity" in result]
        if not one.scene.is_column and results:
            maps = maps_of(one.scene, results, "ppv")
            title, stem = f"Peak particle velocity, {variant}", f"{name}-peak-velocity-{k}"
            drawn = draw_maps(maps, one.scene)
            found.append(SceneFigure(stem, title, CAPTION, drawn, _table(maps), bool(k)))
    return found


def _table(maps: dict[str, Map]) -> pd.DataFrame:
    """Return the middle of every cell with its peak velocity, SI."""
    parts = [
        pd.DataFrame({"engine": name, "x (m)": x, "y (m)": y, "peak velocity (m/s)": one.values})
        for name, one in maps.items()
        for x, y in [one.corners.mean(axis=1).T]
    ]
    return pd.concat(parts, ignore_index=True)
