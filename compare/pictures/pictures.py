"""All pictures of one scene, in the order of the page."""

import xarray as xr

from compare.pairs import Comparison
from compare.panels import variant_names
from compare.pictures.diagrams import diagrams_of
from compare.pictures.energy import energy
from compare.pictures.picture import Picture
from compare.pictures.scene import scene_picture
from compare.pictures.spacetime import space_time
from compare.pictures.spectra import spectra
from compare.pictures.waveforms import waveforms


def pictures_of(
    name: str, comparisons: list[Comparison], fields: list[dict[str, xr.Dataset]]
) -> list[Picture]:
    """Return the pictures of a scene's variants.

    name : what file names begin with ("fig-03"). fields : what `along_pillar` returns for each
    variant; none: no space-time diagrams.
    """
    return [
        scene_picture(name, comparisons),
        *waveforms(name, comparisons),
        *_space_time(name, comparisons, fields),
        *spectra(name, comparisons),
        *energy(name, comparisons),
    ]


def _space_time(
    name: str, comparisons: list[Comparison], fields: list[dict[str, xr.Dataset]]
) -> list[Picture]:
    variants = zip(comparisons, variant_names(comparisons), fields, strict=False)
    return [
        space_time(
            f"{name}-space-time-{k}{'-exact' * shown.exact}", comparison.scene, variant, shown
        )
        for k, (comparison, variant, found) in enumerate(variants)
        for shown in diagrams_of(comparison.scene, found)
    ]
