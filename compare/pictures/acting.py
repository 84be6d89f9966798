"""What acts on the pillar, in the drawing of its side: load, gravity, prestress."""

from matplotlib.axes import Axes

from cases.scene import Gravity, Scene
from compare.pictures import symbols
from compare.pictures.frame import HEIGHT, WIDTH, Frame
from compare.pictures.symbols import ROCK, SOFT
from compare.pictures.units import unit_for

LENGTH, GRAVITY = 0.42, 0.3  # inches of arrows


def draw_load(ax: Axes, scene: Scene, place: Frame) -> None:
    """Draw the load on the start: arrows over its face, one where it is eccentric or across; a
    double arrow along the axis of a couple, and one beside a base that moves."""
    load, start = scene.load, place.x(0)
    if not load.amplitude:
        return
    across, along, depth = load.direction
    if load.shakes_base:
        x, reach = start - 0.35, 0.2
        ends = [(x + s * reach * along, place.middle + s * reach * across) for s in (-1, 1)]
        symbols.arrow(ax, ends[0], ends[1], style="<|-|>")
        return
    if load.arm is not None:
        level = place.middle + 0.36 * place.thick
        for tip in (0.14, 0.05):
            symbols.arrow(ax, (start - 0.5, level), (start - tip, level))
        return
    # z points into the drawing; what acts across ends as far over the axis as it began below it.
    if load.is_eccentric or abs(along) < 0.3:
        over = load.at[0] / scene.pillar.side * place.thick
        over += 0.0 if load.is_eccentric else LENGTH / 2 * across
        at = (start - 0.08 * (1 - abs(along)), place.middle + over)
        symbols.along_or_across(ax, at, (along, across), -depth, LENGTH)
        return
    held = scene.ends.start in ("quiet", "matched")
    for level in (-0.36, 0.36) if held else (-0.36, 0.0, 0.36):
        at = (start, place.middle + level * place.thick)
        symbols.along_or_across(ax, at, (along, across), -depth, LENGTH)


def draw_forces(ax: Axes, scene: Scene, place: Frame) -> None:
    """Draw gravity beside the pillar, and a prestress within it."""
    if scene.gravity is not None and scene.gravity.acceleration:
        _draw_gravity(ax, scene.gravity, place.x(scene.pillar.length))
    if scene.prestress is not None and scene.prestress.normal:
        _draw_prestress(ax, scene.prestress.normal, place.x(scene.pillar.length / 2), place.middle)


def _draw_gravity(ax: Axes, gravity: Gravity, end: float) -> None:
    across, along, depth = gravity.direction
    x, level = min(end + 1.5, WIDTH - 0.5), HEIGHT - 0.35
    tip = (x + GRAVITY * along, level + GRAVITY * across)
    symbols.along_or_across(ax, tip, (along, across), -depth, GRAVITY)
    words = f"{gravity.acceleration:g} m/s²"
    ax.text(x - 0.08, level, words, ha="right", va="center", fontsize=8)


def _draw_prestress(ax: Axes, normal: float, x: float, level: float) -> None:
    """Draw two arrows, towards each other in compression."""
    unit = unit_for("Pa", abs(normal))
    ax.text(
        x,
        level,
        f"prestress {normal / unit.size:g} {unit.name}",
        ha="center",
        va="center",
        fontsize=8,
        zorder=7,
        bbox={"facecolor": ROCK, "edgecolor": "none", "pad": 1.5},
    )
    for side in (-1, 1):
        far, near = (x + side * 1.25, level), (x + side * 0.85, level)
        tail, tip = (far, near) if normal > 0 else (near, far)
        symbols.arrow(ax, tail, tip, SOFT)
