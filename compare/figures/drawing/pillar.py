"""The pillar from the side, y to the right and x up, and its section."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from jointwave.cases.effects import is_spatial
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.contacts import contacts, welds
from jointwave.cases.material.face import face_points
from jointwave.cases.schema.joint import SoftLayer
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.segment import regions
from jointwave.compare.figures.drawing.pulses import law_words
from jointwave.compare.figures.drawing.sketch import (
    EDGE,
    INK,
    LAYER,
    LOAD,
    REGIONS,
    ROCK,
    SOFT,
    Arrow,
    Lines,
    Sketch,
    gravity_words,
    pushing,
    shaking,
    side_style,
)
from jointwave.compare.figures.units import unit_for

MOST = 400  # blocks that are drawn individually
THIN, THICK = 0.07, 0.12  # limits of the pillar's thickness over the width of the drawing
ROOM = 0.11  # beside the pillar, of the width of the drawing
UNIT = 0.06  # length of arrows, of the width of the drawing

#: What a drawing shows.
SEEN = (
    *("pillar", "soft_layers", "segments", "scatter", "load", "ends", "gravity", "prestress"),
    *("record", "motion"),
)


def sketch_of(scene: Scene) -> Sketch:
    """Return the sketch of a pillar, its thickness stretched if it were too thin."""
    pillar, edges = scene.pillar, np.array(block_edges(scene))
    stretch = max(1.0, THIN * pillar.length / (1 - 2 * ROOM) / pillar.side)
    width = max(pillar.length / (1 - 2 * ROOM), stretch * pillar.side / THICK)
    half, unit = pillar.side / 2, UNIT * width * np.array([1.0, 1 / stretch])
    stops = [one.stop for one in regions(scene)] if scene.segments else [np.inf]
    tones = (ROCK, *REGIONS)
    blocks = [np.array([(a, -half), (b, -half), (b, half), (a, half)]) for a, b in pairwise(edges)]
    middles = (edges[1:] + edges[:-1]) / 2
    thin = {"color": EDGE, "linewidth": min(0.8, 40 / len(edges))}
    lines = {"_joints": Lines(_across(edges[1:-1], half), thin)}
    for k, layer in enumerate(scene.soft_layers):
        style = {"color": LAYER, "linewidth": 2.2, "linestyle": "-" if k == 0 else (0, (2, 1))}
        words = f"y = {layer.y:g} m: {_of_layer(layer, pillar.block)}"
        lines[words] = Lines(_across([layer.y], half), style)
    along = np.array([[(0, level), (pillar.length, level)] for level in (-half, half)])
    lines["_sides"] = Lines(along, {"color": INK, "linewidth": 1.0})
    for y, name, end in ((0.0, "start", scene.ends.start), (pillar.length, "end", scene.ends.end)):
        lines[f"{end} {name}"] = Lines(_across([y], half), side_style(end))
    arrows, notes = _actions(scene, half, unit)
    beside = (width - pillar.length) / 2
    times = f"; thickness × {stretch:.2g}" if stretch > 1.01 else ""
    marks = {
        "section: stress": ("v", [(y, half + 0.15 * unit[1]) for y in scene.record.stress]),
        "point: velocity": ("o", [(y, 0.0) for y in scene.record.velocity]),
    }
    return Sketch(
        np.array([-beside, -half - 0.5 * unit[1]]),
        np.array([pillar.length + beside, half + 1.4 * unit[1]]),
        stretch,
        ("y", "x"),
        f"{_size(scene)}{times}",
        blocks,
        [tones[int(np.searchsorted(stops, y)) % len(tones)] for y in middles],
        {},
        lines,
        {name: (mark, np.array(places)) for name, (mark, places) in marks.items() if places},
        arrows,
        notes,
    )


def block_edges(scene: Scene) -> list[float]:
    """Return y of the edges of drawn blocks, m: of all, or a single one for a pillar with many; one
    per segment for segments without joints or with many blocks."""
    if not scene.is_uniform:
        every = contacts(scene)
        edges = every[np.r_[True, ~welds(scene), True]]
        starts = [one.start for one in regions(scene)]
        return np.union1d(edges if len(edges) <= MOST else every[[0, -1]], starts).tolist()
    count, length = scene.block_count, scene.pillar.length
    return np.linspace(0, length, (count if count <= MOST else 1) + 1).tolist()


def _across(places, half: float) -> np.ndarray:
    """Return lines across the pillar at some y [n, 2, 2], m."""
    return np.array([[(y, -half), (y, half)] for y in places]).reshape(-1, 2, 2)


def _actions(scene: Scene, half: float, unit: np.ndarray) -> tuple[list[Arrow], list]:
    """Return the arrows and notes of load, gravity and prestress."""
    above, length = half + unit[1], scene.pillar.length
    arrows, notes = _of_load(scene, half, unit)
    if scene.gravity is not None and scene.gravity.acceleration:
        across, along, _ = scene.gravity.direction
        tip = np.array([length, above])
        arrows.append(pushing(tip, np.array([along, across]), 0.6 * unit, SOFT))
        notes.append((tip - 0.8 * unit * [1, 0], gravity_words(scene.gravity), "right"))
    if scene.prestress is not None and scene.prestress.normal:
        normal = scene.prestress.normal
        notes.append(
            (np.array([length / 2, above]), f"prestress {_number(normal, 'Pa')}", "center")
        )
    return arrows, notes


def _of_load(scene: Scene, half: float, unit: np.ndarray) -> tuple[list[Arrow], list]:
    """Return the load on the start: arrows over its face, a single one if eccentric or transverse;
    in words what acts across the drawing or turns."""
    load = scene.load
    across, along, depth = load.direction
    direction, start = np.array([along, across]), np.zeros(2)
    if not load.amplitude:
        return [], []
    beside = np.array([-0.3 * unit[0], half + unit[1]])
    if load.arm is not None:
        return [], [(beside, f"couple about {_axis(load.direction)}", "left")]
    in_plane = np.hypot(*direction) > 0.05
    words = "load also along z" if in_plane else "load along z"
    notes = [(beside, words, "left")] if abs(depth) > 0.05 else []
    if not in_plane:
        return [], notes
    if scene.shakes_base:
        return [shaking(start - unit * [0.7, 0], direction, unit)], notes
    if load.is_eccentric:
        return [pushing(np.array([0.0, load.at[0]]), direction, unit)], notes
    if abs(along) < 0.3:
        return [pushing(start + direction * unit / 2, direction, unit)], notes
    levels = half * np.array([-0.7, 0.0, 0.7])
    return [pushing(np.array([0.0, level]), direction, unit) for level in levels], notes


def _axis(direction: Sequence[float]) -> str:
    """Return the name of an axis, or the components of another direction."""
    axes = [axis for axis, part in zip("xyz", direction, strict=True) if abs(part) > 1 - 1e-9]
    return axes[0] if axes else f"({', '.join(f'{part:.3g}' for part in direction)})"


def _size(scene: Scene) -> str:
    pillar = scene.pillar
    blocks = f"in {len(regions(scene))} segments" if scene.segments else f"of {pillar.block:g} m"
    average = " on average" if scene.scatter else ""
    return f"{scene.block_count:,} blocks {blocks}{average}, {pillar.side:g} m × {pillar.side:g} m"


def _of_layer(layer: SoftLayer, spacing: float) -> str:
    """Return the differing property of a joint: its stiffness, else its own strength."""
    stiffness = layer.own_stiffness(spacing)
    if stiffness is not None:
        return f"layer, {_number(stiffness, 'Pa/m')}"
    own = [
        f"{words} {_number(getattr(layer, key), 'Pa')}"
        for key, words in (("cohesion", "cohesion"), ("tensile_strength", "strength"))
        if getattr(layer, key) is not None
    ]
    if layer.friction_angle is not None:
        own.append(f"friction {layer.friction_angle:g}°")
    return ", ".join(own) or "joint with its own law"


def _number(value: float, si: str) -> str:
    unit = unit_for(si, abs(value))
    return f"{value / unit.size:.3g} {unit.name}"


def draw_section(ax: Axes, scene: Scene) -> None:
    """Draw the start face of a pillar that moves in space, viewed against y: x up, z to the right;
    its contact points and where the load acts."""
    joints, side, load = scene.joints, scene.pillar.side, scene.load
    ax.add_patch(Rectangle((-side / 2, -side / 2), side, side, facecolor=ROCK, edgecolor=INK))
    x, z, area = face_points(side, joints.contact_points, joints.point_rule)
    ax.scatter(z, x, s=120 * area / side**2 + 4, color=EDGE)
    if load.amplitude and load.arm is None:
        at = (0.0, 0.0) if load.is_motion else load.at
        ax.plot([at[1]], [at[0]], "x", color=LOAD)
    ax.set(aspect="equal", anchor="N", xlabel="z (m)", ylabel="x (m)")
    ax.set_title("start face")
    ax.margins(0.05)


def caption(scene: Scene) -> str:
    """Return the description of the drawing."""
    rock = scene.rock
    if rock.p_speed is not None:
        speeds = f"waves of {rock.p_speed:g} and {rock.s_speed:g} m/s"
    else:
        speeds = f"a modulus of {calibrate(scene).modulus / 1e9:.3g} GPa"
    count = len(scene.segments)
    segments = f"; other rock in {count} segment{'s' * (count > 1)}" if count else ""
    return (
        f"From the scene file: rock mass of {rock.density:g} kg/m³ with {speeds}; "
        f"joints: {law_words(scene.joints) or 'elastic'}{segments}. Triangles: sections whose "
        "stress is recorded; circles: points whose velocity is."
    )


def appearance(scene: Scene) -> str:
    """Return everything that determines the drawing of a pillar."""
    joints = scene.joints.contact_points, scene.joints.point_rule, is_spatial(scene)
    return str([getattr(scene, key) for key in SEEN] + list(joints))
