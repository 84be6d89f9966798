"""The figure of a scene: drawings of its variants, the load over time and a legend."""

from operator import truediv
from textwrap import fill
from typing import Any, cast

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from jointwave.cases.loads import history_of
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import Pulse
from jointwave.cases.units import units_of
from jointwave.compare.figures.drawing import plane, space
from jointwave.compare.figures.drawing.sketch import LOAD, Sketch
from jointwave.compare.figures.export import SceneFigure, blank
from jointwave.compare.figures.receivers import named
from jointwave.compare.figures.style import WIDTH, unit_for
from jointwave.compare.misfit.pairs import Comparison

MOST = 4  # drawings per scene
TITLE = "The scene"
CAPTION = (
    "Drawn from the scene file; blue marks: receivers, red: loads and waves, as over time beside."
)
#: Inches: width of the pulse, least height of a drawing, height below it, largest height.
PULSE, LOW, FOOT, TALLEST = 1.3, 0.75, 0.55, 3.6
FLAT = 0.3  # height over width of drawings, below which they are one below the other
ENTRIES, LINE = 6, 0.25  # entries in a line of the legend, height of a line in inches
SAMPLES, LETTERS = 400, 24  # samples of the pulse, letters in a line of its title
#: Keys that a drawing shows besides its lines.
SEEN = (
    *("pillar", "segments", "scatter", "load", "ends", "domain", "regions"),
    *("waves", "loads", "boundaries", "gravity", "prestress"),
)


def scene_figure(name: str, comparisons: list[Comparison], explode: float = 0.0) -> SceneFigure:
    """Return the figure of a scene; variants with the same appearance share a drawing.

    explode : how far blocks in space are moved apart, over their distance from the middle.
    """
    groups: dict[str, tuple[list[str], AnyScene, Sketch]] = {}
    for words, comparison in named(comparisons):
        scene, sketch = comparison.scene, sketch_of(comparison.scene, explode)
        seen = f"{[getattr(scene, key, None) for key in SEEN]} {sketch.table().to_csv()}"
        groups.setdefault(seen, ([], scene, sketch))[0].append(words)
    few = {", ".join(names): (scene, sketch) for names, scene, sketch in groups.values()}
    few = dict(list(few.items())[:MOST])
    numbers = pd.concat({words: sketch.table() for words, (_, sketch) in few.items()})
    numbers = numbers.rename_axis(["variant", None]).reset_index("variant").reset_index(drop=True)
    return SceneFigure(f"{name}-scene", TITLE, CAPTION, _figure(few), numbers)


def sketch_of(scene: Any, explode: float = 0.0) -> Sketch:
    """Return the sketch of a pillar or a rock mass."""
    return space.sketch_of(scene, explode) if scene.in_space else plane.sketch_of(scene)


def _figure(scenes: dict[str, tuple[AnyScene, Sketch]]) -> Figure:
    """Draw flat scenes one below the other, others in pairs, each next to its pulse."""
    sketches = [sketch for _, sketch in scenes.values()]
    pairs = 1 if len(scenes) == 1 or sketches[0].ratio < FLAT else 2
    rows = [sketches[k : k + pairs] for k in range(0, len(sketches), pairs)]
    width = WIDTH / pairs - PULSE - 0.9
    ratios = [max(sketch.ratio for sketch in row) for row in rows]
    heights = [max(min(TALLEST, ratio * width), LOW) for ratio in ratios]
    beside = max(0.0, width - max(map(truediv, heights, ratios))) / 2  # of narrow drawings
    width -= 2 * beside
    foot = FOOT + LINE * (len(scenes) > 1) + LINE * max(s.size.count("\n") for s in sketches)
    with blank(sum(heights) + len(rows) * foot + LINE) as figure:
        shape: dict[str, Any] = {"width_ratios": [width, PULSE] * pairs, "height_ratios": heights}
        layout = cast(ConstrainedLayoutEngine, figure.get_layout_engine())
        share = pairs * beside / WIDTH
        layout.set(rect=(share, 0.0, 1 - 2 * share, 1.0))
        axes = figure.subplots(len(rows), 2 * pairs, squeeze=False, **shape).reshape(-1, 2)
        handles: dict[str, Any] = {}
        for k, (words, (scene, sketch)) in enumerate(scenes.items()):
            ax, beside = axes[k]
            sketch.draw(ax)
            if len(scenes) > 1:
                ax.set_title(f"({chr(97 + k)})  {words}")
            handles |= {artist.get_label(): artist for artist in ax.get_legend_handles_labels()[0]}
            _draw_pulse(beside, scene)
        for ax in axes[len(sketches) :].ravel():
            ax.remove()
        figure.legend(handles=list(handles.values()), loc="outside lower center", ncols=ENTRIES)
    return figure


def _draw_pulse(ax: Axes, scene: AnyScene) -> None:
    """Draw the first load or wave over time, until shortly after its end."""
    pulse = next((pulse for pulse in scene.pulses if pulse.amplitude), None)
    if pulse is None:
        ax.remove()
        return
    time, values = pulse_curve(pulse, scene.time.duration)
    si = next(iter(units_of(pulse.quantity, scene.in_space))).replace("s2", "s²")
    unit = unit_for(si, 1.001 * float(np.abs(values).max()))
    ax.axhline(0, color="#bbbbbb", linewidth=0.6)
    ax.plot(1e3 * time, values / unit.size, color=LOAD, linewidth=1.3)
    words = f"{pulse.kind} wave" if pulse.kind in ("P", "S") else pulse.kind
    title = fill(f"{words}, {pulse.shape} ({unit.name})", LETTERS)
    ax.set(xlabel="time (ms)", title=title, anchor="SW", box_aspect=0.6)


def pulse_curve(pulse: Pulse, duration: float) -> tuple[np.ndarray, np.ndarray]:
    """Return times, s, and the load or wave, SI, from its start to shortly after its end.

    duration : of the scene, s.
    """
    history = history_of(pulse, pulse.amplitude)
    end = min(duration, 1.25 * history.end or duration)
    time = np.linspace(0, end, SAMPLES)
    return time, np.asarray(history.value(time))
