"""The picture at the head of a scene's page: the scene, and a waveform by every solution."""

from jointwave.compare.figures.charts.waveforms import STYLES, by_solution, draw_waveforms
from jointwave.compare.figures.drawing.scene import sketch_of
from jointwave.compare.figures.export import SceneFigure, blank
from jointwave.compare.figures.receivers import Panel

HEIGHT, WIDTHS = 3.2, (1.0, 1.3)  # inches, and shares of the scene and of the waveform


def lead_figure(name: str, panel: Panel) -> SceneFigure:
    """Return the scene of a panel beside the panel."""
    with blank(HEIGHT) as figure:
        left, right = figure.subplots(1, 2, width_ratios=WIDTHS)
        sketch_of(panel.comparison.scene)._replace(size="").draw(left)
        draw_waveforms(right, by_solution(panel))
        right.set_xlabel("time (ms)")
        handles = right.get_legend_handles_labels()
        figure.legend(*handles, loc="outside lower center", ncols=4, handlelength=4.0)
    title = f"{panel.comparison.scene.title}: {panel.heading}"
    curves = panel.recorded.rename(columns=panel.column)
    table = curves.rename_axis("time (s)").reset_index()
    return SceneFigure(f"{name}-lead", title, STYLES, figure, table)
