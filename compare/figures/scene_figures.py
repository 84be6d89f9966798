"""All pictures of one scene, in the order of the page."""

import xarray as xr

from compare.figures.charts.energy import energy
from compare.figures.charts.peak_velocities import peak_velocities
from compare.figures.charts.propagation import propagation
from compare.figures.charts.spacetime import space_time
from compare.figures.charts.spacetime_data import diagrams_of
from compare.figures.charts.spectra import spectra
from compare.figures.charts.waveforms import waveforms
from compare.figures.drawing.scene import scene_figure
from compare.figures.figure import SceneFigure
from compare.figures.subplots import variant_names
from compare.misfit.pairs import Comparison


def figures_of(
    name: str, comparisons: list[Comparison], fields: list[dict[str, xr.Dataset]]
) -> list[SceneFigure]:
    """Return the pictures of a scene's variants.

    name : what file names begin with ("fig-03"). fields : what `along_pillar` returns for each
    variant; none: no space-time diagrams.
    """
    return [
        scene_figure(name, comparisons),
        *waveforms(name, comparisons),
        *_space_time(name, comparisons, fields),
        *spectra(name, comparisons),
        *propagation(name, comparisons),
        *peak_velocities(name, comparisons),
        *energy(name, comparisons),
    ]


def _space_time(
    name: str, comparisons: list[Comparison], fields: list[dict[str, xr.Dataset]]
) -> list[SceneFigure]:
    variants = zip(comparisons, variant_names(comparisons), fields, strict=False)
    return [
        space_time(
            f"{name}-space-time-{k}{'-exact' * shown.exact}", comparison.scene, variant, shown
        )
        for k, (comparison, variant, found) in enumerate(variants)
        for shown in diagrams_of(comparison.scene, found)
    ]
