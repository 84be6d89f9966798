"""The drawing of a rock mass: joints, boundaries, waves and loads, receivers."""

from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from cases.partition.blocks import Partition
from cases.partition.regions import rocks_of
from cases.partition.scene import partition_of
from cases.schema.plane import IntactRock
from cases.schema.rock_mass import RockMass
from compare.figures.drawing import symbols
from compare.figures.drawing.pulses import draw_pulse, law_words
from compare.figures.drawing.rock_mass_actions import draw_actions
from compare.figures.drawing.symbols import EDGE, INK, RECEIVER, ROCK
from compare.figures.export import blank

#: Colours of joint sets, in order; safe for all kinds of colour blindness (Tol 2021, bright).
SETS = ("#4477aa", "#ee6677", "#228833", "#aa3377", "#ccbb44", "#66ccee")
#: Line styles of sides by boundary condition: width (points) and dashes.
SIDES: dict[str, tuple[float, Any]] = {
    "free": (1.0, "-"),
    "quiet": (2.2, (0, (3.0, 1.2))),
    "fixed": (3.4, "-"),
    "periodic": (1.4, (0, (1.0, 1.5))),
}
#: Colours of the rock of regions, in order.
REGIONS = ("#cfc8b8", "#b9c4cc", "#d9cfe0", "#c4d2bd")
MANY = 3000  # contacts above which they are an image in the drawing
WIDTH, BESIDE, TALLEST = 6.2, 2.6, 6.0  # inches of the drawing, and of the column beside it
MARGIN, HEADING, LEGEND_ROW = 0.62, 0.25, 0.19  # inches
OVER = 0.16  # margin for arrows, of the domain's size


class Drawn(NamedTuple):
    """A rock mass with its blocks, and in words the variants with the same drawing."""

    words: str
    scene: RockMass
    partition: Partition


def drawn(words: str, scene: RockMass) -> Drawn:
    """Return a rock mass for drawing, cut into blocks."""
    return Drawn(words, scene, partition_of(scene))


def appearance(scene: RockMass) -> str:
    """Return everything that determines the drawing of a rock mass."""
    seen = (
        "domain",
        "regions",
        "joint_sets",
        "waves",
        "loads",
        "boundaries",
        "gravity",
        "prestress",
    )
    return str([getattr(scene, key) for key in (*seen, "record")])


def figure_of(groups: list[Drawn]) -> Figure:
    """Return the drawings, one above the other, each with its loads over time and its legend."""
    heights = [_height(one) for one in groups]
    top = sum(heights)
    with blank(top, WIDTH + BESIDE, laid_out=True) as figure:
        for i, (one, tall) in enumerate(zip(groups, heights, strict=True)):
            heading = f"({chr(97 + i)})  {one.words}" if len(groups) > 1 else ""
            _draw_row(figure, one, top, tall, heading)
            top -= tall
    return figure


def _height(one: Drawn) -> float:
    """Return the height of a row, inches: the domain to scale, and room for its side column."""
    low, high = _extent(one.partition)
    across, up = (1 + 2 * OVER) * (high - low)
    drawing = min(TALLEST, (WIDTH - MARGIN) * float(up / across)) + MARGIN
    return max(drawing, 2.0 + LEGEND_ROW * len(_legend(one))) + HEADING


def _extent(partition: Partition) -> tuple[np.ndarray, np.ndarray]:
    return partition.corners.min(axis=0), partition.corners.max(axis=0)


def _draw_row(figure: Figure, one: Drawn, top: float, tall: float, heading: str) -> None:
    width, height = figure.get_size_inches()

    def axes(left: float, bottom: float, across: float, up: float) -> Axes:
        size = across / width, up / height
        return figure.add_axes((left / width, (top - tall + bottom) / height, *size))

    ax = axes(MARGIN, MARGIN, WIDTH - MARGIN, tall - MARGIN - HEADING)
    _draw_domain(ax, one)
    if heading:
        figure.text(0.08 / width, (top - 0.18) / height, heading, va="bottom")
    acting = next((p for p in one.scene.pulses if p.amplitude), None)
    if acting is not None:
        history = axes(WIDTH + 0.55, tall - HEADING - 1.35, BESIDE - 0.75, 1.05)
        words = f"{acting.kind} wave" if acting.kind in ("P", "S") else acting.kind
        draw_pulse(history, acting, one.scene.time.duration, words)
    beside = axes(WIDTH + 0.2, 0.1, BESIDE - 0.3, tall - HEADING - 1.9)
    beside.set_axis_off()
    handles = _legend(one)
    beside.legend(handles=handles, loc="upper left", frameon=False, fontsize=8, borderpad=0)


def _draw_domain(ax: Axes, one: Drawn) -> None:
    partition, scene = one.partition, one.scene
    low, high = _extent(partition)
    size = high - low
    blocks = np.split(partition.corners, partition.first[1:-1])
    many, rocks = len(partition.contacts) > MANY, (ROCK, *REGIONS)
    tones = [rocks[(k + 1) % len(rocks)] for k in partition.region]
    ax.add_collection(
        PolyCollection(blocks, facecolors=tones, edgecolors="none", zorder=1, rasterized=many)
    )
    for index in range(-1, len(partition.joint_sets)):
        lines = _joint_lines(partition, index)
        style: dict[str, Any] = {"colors": _colour(index), "linewidths": 0.4 if many else 0.9}
        dashes = {"linestyles": (0, (1.0, 2.0))} if index < 0 else {}
        ax.add_collection(LineCollection(list(lines), zorder=2, rasterized=many, **style, **dashes))
    for side, lines in _sides(partition).items():
        thick, dash = SIDES[_held(scene, side)]
        ax.add_collection(
            LineCollection(list(lines), colors=INK, linewidths=thick, linestyles=[dash], zorder=3)
        )
    ax.set_aspect("equal")
    ax.set(xlim=(low[0] - OVER * size[0], high[0] + OVER * size[0]))
    ax.set(ylim=(low[1] - OVER * size[1], high[1] + OVER * size[1]))
    ax.set_xlabel("x (m)")
    ax.set_ylabel("y (m)")
    draw_actions(ax, scene, low, high)
    _draw_receivers(ax, scene, size)


def _draw_receivers(ax: Axes, scene: RockMass, size: np.ndarray) -> None:
    plain = {"facecolor": ROCK, "edgecolor": "none", "pad": 0.5}  # no joint crosses text
    for places, marker in ((scene.record.points, "o"), (scene.record.joints, "^")):
        for x, y in places:
            ax.plot([x], [y], marker, color=RECEIVER, markersize=4.5, zorder=8)
            words = f"[{x:g}, {y:g}]"
            right, above = x + 0.015 * size[0], y + 0.015 * size[1]
            symbols.note(ax, right, above, words, "left", "bottom", zorder=7, bbox=plain)


def _joint_lines(partition: Partition, index: int) -> np.ndarray:
    """Return the contacts of a set [n, 2, 2], m; -1: cuts through intact rock."""
    of = partition.contacts
    own = of.joint_set == index
    return np.stack([of.start[own], of.end[own]], axis=1)


def _sides(partition: Partition) -> dict[str, np.ndarray]:
    """Return the edges of each side [n, 2, 2], m."""
    edges = partition.boundary
    lines = np.stack([edges.start, edges.end], axis=1)
    found = {name: lines[edges.side == k] for k, name in enumerate(partition.sides)}
    return {name: own for name, own in found.items() if len(own)}


def _held(scene: RockMass, side: str) -> str:
    """Return the boundary condition of a side; openings are free."""
    return getattr(scene.boundaries, side, "free")


def _colour(index: int) -> str:
    return EDGE if index < 0 else SETS[index % len(SETS)]


def _legend(one: Drawn) -> list[Line2D]:
    """Return the entries of the legend: joint sets, sides, receivers."""
    partition, scene = one.partition, one.scene
    entries = [
        Line2D([], [], color=_colour(k), linewidth=1.4, label=name)
        for k, name in enumerate(partition.joint_sets)
    ]
    if len(_joint_lines(partition, -1)):
        line: dict[str, Any] = {"color": EDGE, "linewidth": 1.2, "linestyle": (0, (1.0, 2.0))}
        entries.append(Line2D([], [], label="no joint", **line))
    for k, one_region in enumerate(scene.regions):
        patch: dict[str, Any] = {"color": REGIONS[k % len(REGIONS)], "linewidth": 6.0}
        entries.append(Line2D([], [], label=one_region.name, **patch))
    held = {_held(scene, side) for side in _sides(partition)}
    for kind in (name for name in SIDES if name in held):
        thick, dash = SIDES[kind]
        entries.append(
            Line2D([], [], color=INK, linewidth=thick, linestyle=dash, label=f"{kind} side")
        )
    marks = {"o": ("point", scene.record.points), "^": ("point of a joint", scene.record.joints)}
    for marker, (words, places) in marks.items():
        if places:
            dot: dict[str, Any] = {
                "color": RECEIVER,
                "marker": marker,
                "linestyle": "none",
                "markersize": 4.5,
            }
            entries.append(Line2D([], [], label=words, **dot))
    return entries


def caption(scene: RockMass) -> str:
    """Return the description of the drawing."""
    sets = "; ".join(_set_words(one) for one in scene.joint_sets)
    named = zip(scene.regions, rocks_of(scene), strict=False)  # the last is [rock]
    regions = "; ".join(f"{one.name}: {_rock_words(own)}" for one, own in named)
    parts = [
        f"From the scene file: rock of {_rock_words(scene.rock)}, in plane strain.",
        f"Regions: {regions}." if regions else "",
        f"Joints: {sets}." if sets else "No joints.",
        "Circles: points whose motion is recorded; triangles: points of joints.",
    ]
    return " ".join(part for part in parts if part)


def _rock_words(rock: IntactRock) -> str:
    return (
        f"{rock.density:g} kg/m³ with a modulus of {rock.intact_modulus / 1e9:.3g} GPa and a "
        f"Poisson's ratio of {rock.intact_poisson:g}"
    )


def _set_words(one: Any) -> str:
    parts = [
        f"dip {one.dip:g}°",
        f"spacing {one.spacing:g} m" if one.spacing else "one joint",
        f"{one.normal_stiffness / 1e9:.3g} and {one.shear_stiffness / 1e9:.3g} GPa/m",
        law_words(one),
    ]
    return f"{one.name}: {', '.join(part for part in parts if part)}"


def table(one: Drawn) -> pd.DataFrame:
    """Return every drawn line and receiver with its end points."""
    partition, scene = one.partition, one.scene
    rows: list[tuple[Any, ...]] = []
    for index, name in [(-1, "no joint"), *enumerate(partition.joint_sets)]:
        rows += [("joint", *line.ravel(), name) for line in _joint_lines(partition, index)]
    for side, lines in _sides(partition).items():
        rows += [("side", *line.ravel(), f"{side}, {_held(scene, side)}") for line in lines]
    rows += [("receiver", *at, *at, "point") for at in scene.record.points]
    rows += [("receiver", *at, *at, "point of a joint") for at in scene.record.joints]
    columns = ["part", "from x (m)", "from y (m)", "to x (m)", "to y (m)", "what"]
    found = pd.DataFrame(rows, columns=columns)
    found.insert(0, "variant", one.words)
    return found
