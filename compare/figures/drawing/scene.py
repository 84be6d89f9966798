"""The figure of a scene: a drawing for each appearance, its load over time and a legend."""

from types import ModuleType
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from jointwave.cases.effects import is_spatial
from jointwave.cases.schema.scene import Scene
from jointwave.compare.figures.drawing import pillar
from jointwave.compare.figures.drawing.pulses import draw_pulse
from jointwave.compare.figures.drawing.sketch import Sketch, draw, legend, table
from jointwave.compare.figures.export import blank
from jointwave.compare.figures.figure import SceneFigure
from jointwave.compare.figures.panels import variant_names
from jointwave.compare.figures.style import WIDTH
from jointwave.compare.misfit.pairs import Comparison

MOST = 4  # drawings per scene
TITLE = "The scene"
EDGE, DRAWING, BESIDE = 0.6, 5.2, 1.25  # inches across: the margin, drawing, and parts beside it
GAP, TALLEST = 0.55, 6.0  # inches between parts, and of the tallest drawing
HEAD, FOOT, LINE, PART = 0.3, 0.5, 0.19, 1.0  # inches up


def scene_figure(name: str, comparisons: list[Comparison]) -> SceneFigure:
    """Return the figure of a scene; variants with the same appearance share a drawing."""
    drawing: ModuleType = pillar
    if not isinstance(comparisons[0].scene, Scene):
        from jointwave.compare.figures.drawing import rock_mass as drawing  # imports shapely

    groups: dict[str, tuple[list[str], Any]] = {}
    for words, comparison in zip(variant_names(comparisons), comparisons, strict=True):
        seen = drawing.appearance(comparison.scene)
        groups.setdefault(seen, ([], comparison.scene))[0].append(words)
    rows = {", ".join(names): scene for names, scene in list(groups.values())[:MOST]}
    sketches = {words: drawing.sketch_of(scene) for words, scene in rows.items()}
    tables = pd.concat({words: table(sketch) for words, sketch in sketches.items()})
    numbers = tables.rename_axis(["variant", None]).reset_index("variant").reset_index(drop=True)
    caption = drawing.caption(next(iter(rows.values())))
    figure = _figure(rows, list(sketches.values()))
    return SceneFigure(f"{name}-scene", TITLE, caption, figure, numbers)


def _figure(rows: dict[str, Any], sketches: list[Sketch]) -> Figure:
    heights = [_height(sketch) for sketch in sketches]
    top = total = sum(heights)
    with blank(total, True) as figure:
        for k, (words, scene) in enumerate(rows.items()):
            if len(rows) > 1:
                heading = f"({chr(97 + k)})  {words}"
                figure.text(0.08 / WIDTH, 1 - (total - top + 0.06) / total, heading, va="top")
            _draw_row(figure, scene, sketches[k], top - HEAD)
            top -= heights[k]
    return figure


def _draw_row(figure: Figure, scene: Any, sketch: Sketch, top: float) -> None:
    """Draw a scene and what belongs to it below a height, inches."""
    width, height = figure.get_size_inches()

    def axes(left: float, across: float, up: float) -> Axes:
        place = left / width, (top - up) / height, across / width, up / height
        return figure.add_axes(place)

    ax = axes(EDGE, DRAWING, _drawing_height(sketch))
    draw(ax, sketch)
    beside = EDGE + DRAWING + GAP
    if isinstance(scene, Scene):
        _mark_ends(ax, scene)
        if is_spatial(scene):
            pillar.draw_section(axes(beside + 0.15, PART, PART), scene)
            beside += 0.2 + PART + GAP
    acting = next((pulse for pulse in scene.pulses if pulse.amplitude), None)
    if acting is not None:
        kind = getattr(acting, "kind", "load")
        words = f"{kind} wave" if kind in ("P", "S") else kind
        draw_pulse(axes(beside, BESIDE, PART), acting, scene.time.duration, words)
        beside += BESIDE + 0.15
    free = axes(beside, WIDTH - beside, PART)
    free.set_axis_off()
    free.legend(handles=legend(sketch), loc="upper left", frameon=False, fontsize=8, borderpad=0)


def _drawing_height(sketch: Sketch) -> float:
    return min(TALLEST, DRAWING * sketch.ratio)


def _height(sketch: Sketch) -> float:
    """Return the height of a row, inches."""
    return HEAD + max(_drawing_height(sketch) + FOOT, PART + FOOT, LINE * len(legend(sketch)))


def _mark_ends(ax: Axes, scene: Scene) -> None:
    """Number the axis along the pillar only where it is."""
    length, (low, high) = scene.pillar.length, ax.get_xlim()
    ticks = MaxNLocator(max(1, round(10 * length / (high - low)))).tick_values(0, length)
    ax.set_xticks([y for y in ticks if 0 <= y <= length * (1 + 1e-9)])
    ax.set_yticks([])
    ax.spines[["left", "bottom"]].set_visible(False)
