"""The scene drawn as in a textbook: a pillar from the side, its section, its load over time; a rock
mass in its plane."""

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from cases.effects import is_spatial
from cases.material.calibrate import calibrate
from cases.material.face import face_points
from cases.schema.scene import Scene
from compare.figures.drawing import side, symbols
from compare.figures.drawing.actions import HEIGHT, WIDTH
from compare.figures.drawing.pulses import draw_pulse, law_words
from compare.figures.drawing.symbols import EDGE, INK, ROCK, SOFT
from compare.figures.export import blank
from compare.figures.figure import SceneFigure
from compare.figures.panels import variant_names
from compare.misfit.pairs import Comparison

MOST = 4  # drawings per scene
GAP, LOAD_WIDTH = 0.45, 1.75  # inches of the gap before, and of the load over time
HEADING = 0.22  # inches of a heading
TITLE = "The scene"
SEEN = (
    "pillar", "soft_layers", "segments", "scatter", "load", "ends", "gravity", "prestress",
    "record", "motion",
)  # fmt: skip

SIZE = 0.8  # inches of a side
ACROSS, TALL = 1.5, 1.68  # inches of the drawing
MIDDLE = 0.75, 0.87


def scene_figure(name: str, comparisons: list[Comparison]) -> SceneFigure:
    """Return the figure of a scene; variants with the same appearance share a drawing."""
    if not isinstance(comparisons[0].scene, Scene):
        return _of_rock_mass(name, comparisons)
    groups = _groups(comparisons, _appearance)
    return SceneFigure(
        f"{name}-scene",
        TITLE,
        _caption(groups),
        partial(_figure, groups),
        pd.concat([_table(scene, words) for words, scene in groups], ignore_index=True),
    )


def _of_rock_mass(name: str, comparisons: list[Comparison]) -> SceneFigure:
    from compare.figures.drawing import rock_mass  # imports shapely, not needed for pillars

    groups = [rock_mass.drawn(*one) for one in _groups(comparisons, rock_mass.appearance)]
    return SceneFigure(
        f"{name}-scene",
        TITLE,
        rock_mass.caption(groups[0].scene),
        partial(rock_mass.figure_of, groups),
        pd.concat([rock_mass.table(one) for one in groups], ignore_index=True),
    )


def _groups(
    comparisons: list[Comparison], appearance: Callable[[Any], str]
) -> list[tuple[str, Any]]:
    """Return names of variants and their scene, one entry per appearance."""
    seen: dict[str, tuple[list[str], Any]] = {}
    for words, comparison in zip(variant_names(comparisons), comparisons, strict=True):
        scene = comparison.scene
        seen.setdefault(appearance(scene), ([], scene))[0].append(words)
    return [(", ".join(names), scene) for names, scene in list(seen.values())[:MOST]]


def _appearance(scene: Scene) -> str:
    return str([getattr(scene, key) for key in SEEN] + [scene.joints.contact_points])


def _caption(groups: list[tuple[str, Scene]]) -> str:
    scene = groups[0][1]
    rock, joints = scene.rock, scene.joints
    if rock.p_speed is not None:
        speeds = f"waves of {rock.p_speed:g} and {rock.s_speed:g} m/s"
    else:
        speeds = f"a modulus of {calibrate(scene).modulus / 1e9:.3g} GPa"
    words = law_words(joints) or "elastic"
    count = len(scene.segments)
    segments = f"; other rock in {count} segment{'s' * (count > 1)}" if count else ""
    return (
        f"From the scene file: rock mass of {rock.density:g} kg/m³ with {speeds}; "
        f"joints: {words}{segments}. Triangles: sections whose stress is recorded; circles: points "
        "whose velocity is."
    )


def _figure(groups: list[tuple[str, Scene]]) -> Figure:
    heading = HEADING if len(groups) > 1 else 0.0
    width = WIDTH + ACROSS + GAP + LOAD_WIDTH
    height = len(groups) * (HEIGHT + heading)
    with blank(height, width, laid_out=True) as figure:
        above = None
        for i, (words, scene) in enumerate(groups):
            bottom = height - (i + 1) * (HEIGHT + heading)
            _draw_row(figure, scene, above, bottom)
            if heading:
                text = f"({chr(97 + i)})  {words}"
                figure.text(0.08 / width, (bottom + HEIGHT) / height, text, va="bottom")
            above = scene
    return figure


def _draw_row(figure: Figure, scene: Scene, above: Scene | None, bottom: float) -> None:
    """Draw the pillar, and section and load where they differ from the scene above."""
    width, height = figure.get_size_inches()

    def axes(left: float, across: float, low: float = 0.0, high: float = HEIGHT) -> Axes:
        size = across / width, (high - low) / height
        return figure.add_axes((left / width, (bottom + low) / height, *size))

    side.draw_strip(axes(0, WIDTH), scene)
    if above is None or appearance(scene) != appearance(above):
        draw_section(axes(WIDTH, ACROSS), scene)
    if scene.load.amplitude and (above is None or _history(scene) != _history(above)):
        left = WIDTH + ACROSS + GAP
        draw_pulse(axes(left, LOAD_WIDTH - 0.18, 0.45, 1.4), scene.load, scene.time.duration)


def _history(scene: Scene) -> dict[str, object]:
    return scene.load.model_dump(exclude={"direction", "at", "arm"})


def _table(scene: Scene, variant: str) -> pd.DataFrame:
    pillar = scene.pillar
    edges = side.block_edges(scene)
    rows = [("block", a, b, "") for a, b in pairwise(edges)]
    rows += [("joint", y, y, "") for y in edges[1:-1]]
    rows += [
        ("soft layer", x.y, x.y, f"thickness {x.thickness or 0:g} m") for x in scene.soft_layers
    ]
    rows += [("segment", x.y[0], x.y[1], x.name or "") for x in scene.segments]
    rows += [
        ("end", 0.0, 0.0, scene.ends.start),
        ("end", pillar.length, pillar.length, scene.ends.end),
    ]
    rows += [("receiver", y, y, "stress") for y in scene.record.stress]
    rows += [("receiver", y, y, "velocity") for y in scene.record.velocity]
    table = pd.DataFrame(rows, columns=["part", "from y (m)", "to y (m)", "what"])
    table.insert(0, "variant", variant)
    return table


def appearance(scene: Scene) -> tuple[object, ...]:
    """Return everything that determines the drawing of a scene's section."""
    joints = scene.joints.contact_points, scene.joints.point_rule
    return (*joints, scene.pillar.side, scene.load.model_dump(), is_spatial(scene))


def draw_section(ax: Axes, scene: Scene) -> None:
    """Draw the section viewed against y, x up and z to the right, in axes of ACROSS x TALL inches.

    Contact points, one part each of the SVG's group `contacts`, are drawn only for spatial motion:
    in axial motion all points of a face behave the same.
    """
    ax.set(xlim=(0, ACROSS), ylim=(0, TALL), aspect="equal")
    ax.axis("off")
    left, bottom = MIDDLE[0] - SIZE / 2, MIDDLE[1] - SIZE / 2
    ax.add_patch(Rectangle((left, bottom), SIZE, SIZE, facecolor=ROCK, edgecolor=INK, linewidth=1))
    if is_spatial(scene):
        joints, side = scene.joints, scene.pillar.side
        x, z, area = face_points(side, joints.contact_points, joints.point_rule)
        places = [_at(scene, a, b) for a, b in zip(x.tolist(), z.tolist(), strict=True)]
        across, up = zip(*places, strict=True)
        points = ax.scatter(across, up, s=120 * area / side**2 + 4, color=EDGE, zorder=3)
        points.set_gid("contacts")
    _draw_load(ax, scene)
    line = {"arrowstyle": "<->", "color": SOFT, "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", (left, bottom - 0.14), (left + SIZE, bottom - 0.14), arrowprops=line)
    top, right, middle = bottom + SIZE, left + SIZE, MIDDLE[0]
    symbols.note(ax, middle, bottom - 0.2, f"{scene.pillar.side:g} m", va="top")
    symbols.note(ax, middle, top + 0.1, "start face, seen along -y", va="bottom", color=SOFT)
    symbols.note(ax, left - 0.06, top, "x", "right", "top", style="italic")
    symbols.note(ax, right + 0.05, bottom, "z", "left", "bottom", style="italic")


def _at(scene: Scene, x: float, z: float) -> tuple[float, float]:
    scale = SIZE / scene.pillar.side
    return MIDDLE[0] + scale * z, MIDDLE[1] + scale * x


def _draw_load(ax: Axes, scene: Scene) -> None:
    load = scene.load
    if not load.amplitude:
        return
    across, along, depth = load.direction
    if load.arm is not None:
        symbols.couple(ax, MIDDLE, 0.22)
        return
    at = MIDDLE if load.is_motion else _at(scene, *load.at)
    # The tail, unless the force points at the reader: the tip.
    symbols.along_or_across(ax, at, (depth, across), along, 0.5)
