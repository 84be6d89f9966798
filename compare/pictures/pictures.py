"""All pictures of one scene, in the order of the page."""

import xarray as xr

from compare.pairs import Comparison
from compare.pictures.picture import Picture
from compare.pictures.waveforms import waveforms


def pictures_of(
    name: str, comparisons: list[Comparison], fields: dict[str, xr.Dataset]
) -> list[Picture]:
    """Return the pictures of a scene's variants.

    name : what file names begin with ("fig-03"). fields : what `along_pillar` returns for the first
    variant; empty: no space-time diagrams.
    """
    return [waveforms(name, comparisons)]
