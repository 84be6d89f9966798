"""All figures of one scene, in the order of the page, and the additional runs that they need."""

import xarray as xr

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import ENGINES, applies, names
from jointwave.compare.figures.charts import waveforms
from jointwave.compare.figures.charts.energy import energy
from jointwave.compare.figures.charts.maps import peak_velocities
from jointwave.compare.figures.charts.propagation import propagation
from jointwave.compare.figures.charts.spacetime import space_time
from jointwave.compare.figures.charts.spectra import spectra
from jointwave.compare.figures.drawing.scene import scene_figure, sketch_of
from jointwave.compare.figures.export import SceneFigure, blank
from jointwave.compare.figures.receivers import Panel, named, table_of
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.misfit.ranking import own_exact
from jointwave.compare.runs.reuse import NOWHERE, ResultFolder

HEIGHT, WIDTHS = 3.2, (1.0, 1.3)  # height of the lead, inches; width ratios of scene and waveform


def figures_of(
    name: str, comparisons: list[Comparison], fields: list[dict[str, xr.Dataset]]
) -> list[SceneFigure]:
    """Return the figures of a scene's variants.

    name : prefix of file names ("fig-03"). fields : of `along_pillar` by variant, or empty.
    """
    along = [
        figure
        for k, ((variant, one), field) in enumerate(zip(named(comparisons), fields, strict=False))
        for figure in space_time(f"{name}-space-time-{k}", one.scene, variant, field)
    ]
    return [
        scene_figure(name, comparisons),
        *peak_velocities(name, comparisons),
        *waveforms.waveforms(name, comparisons),
        *(one._replace(folded=k > 0) for k, one in enumerate(along)),
        *spectra(name, comparisons),
        *propagation(name, comparisons),
        *energy(name, comparisons),
    ]


def lead_figure(name: str, panel: Panel) -> SceneFigure:
    """Return the figure at the head of a page: the scene of a panel beside the panel."""
    with blank(HEIGHT) as figure:
        left, right = figure.subplots(1, 2, width_ratios=WIDTHS)
        sketch_of(panel.comparison.scene)._replace(size="").draw(left)
        waveforms.draw_waveforms(right, waveforms.by_solution(panel))
        right.set_xlabel("time (ms)")
        handles = right.get_legend_handles_labels()
        figure.legend(*handles, loc="outside lower center", ncols=4, handlelength=4.0)
    title = f"{panel.comparison.scene.title}: {panel.heading}"
    table = table_of(panel.recorded.rename(columns=panel.column), "time (s)")
    return SceneFigure(f"{name}-lead", title, waveforms.STYLES, figure, table)


SECTIONS, TIMES = 60, 240  # largest numbers of intervals between sections and between samples
ALONG = "-along-pillar"  # suffix of the names of these results' files
FEWEST = 8  # blocks; with fewer no wave is visible


def along_pillar(scene: AnyScene, stored: ResultFolder = NOWHERE) -> dict[str, xr.Dataset]:
    """Return results by name at joints or blocks all along the pillar, at some 240 times.

    These are the engines, run as in the comparison, and the exact solution of each engine's own
    model. Empty for a rock mass, or if the pillar has too few blocks to show a wave.
    Raises the errors of `compare.engines.solve`.
    """
    found = {}
    for name, result in stored.solve(*runs_along(scene), None, ALONG):
        step = max(1, -(-(result.sizes["time"] - 1) // TIMES))
        found[name] = result.isel(time=slice(None, None, step)).copy(deep=True)  # frees the rest
    return found


def runs_along(scene: AnyScene) -> tuple[list[str], AnyScene]:
    """Return the names of the solvers of `along_pillar`, and their scene."""
    if not scene.is_column or scene.block_count < FEWEST:
        return [], scene
    wide = recorded_along(scene)
    every = [name for name in names() if applies(name, wide)]
    engines = [name for name in every if name in ENGINES]
    exact = [own for name in engines if (own := own_exact(name, every, wide))]
    return list(dict.fromkeys([*engines, *exact])), wide


def recorded_along(scene: Scene) -> Scene:
    """Return the scene with receivers at the start, every k-th joint and the end of the pillar; if
    it records only velocities, at centres of blocks. Samples and steps are unchanged."""
    count, p = scene.block_count, calibrate(scene)
    contacts = [*range(0, count, -(-count // SECTIONS)), count]
    sections, points = p.contact_y[contacts].tolist(), []
    if scene.record.velocity and not scene.record.stress:
        sections, points = [], p.centre_y[contacts[:-1]].tolist()
    elif scene.load.arm is not None:
        # Torsion gives no stress at a section; rotation is recorded with the velocity.
        points = sections
    update = {"stress": sections, "velocity": points, "fields": None}
    return scene.model_copy(update={"record": scene.record.model_copy(update=update)})
