"""A scene solved at sections all along the pillar, for space-time diagrams."""

import xarray as xr

from cases.scene import Scene


def along_pillar(scene: Scene) -> dict[str, xr.Dataset]:
    """Return the results of engines and exact solutions, by name, at sections all along."""
    return {}
