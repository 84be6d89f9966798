"""The pillar from the side, in inches: its position, and the actions on it (load, gravity ...)."""

from typing import NamedTuple

from matplotlib.axes import Axes

from cases.schema.plane import GravityInPlane
from cases.schema.scene import Scene
from cases.schema.tables import Gravity
from compare.figures.drawing import symbols
from compare.figures.drawing.symbols import CHARACTER, SOFT
from compare.figures.units import unit_for

WIDTH, HEIGHT = 7.3, 1.82  # inches of the drawing
SIDES = 0.95  # inches beside the pillar, for its load and supports
THICK, SQUAT = 0.42, 0.6  # inches across the pillar: at least, and at most
BASE = 0.6  # inches below the pillar, for its scale

LENGTH, GRAVITY = 0.42, 0.3  # inches of arrows
LEVEL = HEIGHT - 0.1  # inches of a prestress
ASIDE = GRAVITY / 2 + 0.05  # inches from the gravity arrow to its number


class Placement(NamedTuple):
    """Position of the pillar: x of its start (inches), inches per metre along it, inches across."""

    start: float
    scale: float
    thick: float

    def x(self, y: float) -> float:
        """Return the x of a section, inches."""
        return self.start + self.scale * y

    @property
    def middle(self) -> float:
        """The axis."""
        return BASE + self.thick / 2

    @property
    def top(self) -> float:
        """The upper side."""
        return BASE + self.thick


def placement(scene: Scene) -> Placement:
    """Return the placement of a pillar, to scale in both directions if it is then visible."""
    room, pillar = WIDTH - 2 * SIDES, scene.pillar
    scale = min(room / pillar.length, SQUAT / pillar.side)
    return Placement(SIDES, scale, max(THICK, scale * pillar.side))


def draw_load(ax: Axes, scene: Scene, place: Placement) -> None:
    """Draw the load on the start: arrows over its face, a single one if eccentric or transverse; a
    double arrow along the axis of a couple, and one beside a moving base."""
    load, start = scene.load, place.x(0)
    if not load.amplitude:
        return
    across, along, depth = load.direction
    if scene.shakes_base:
        x, reach = start - 0.35, 0.2
        ends = [(x + s * reach * along, place.middle + s * reach * across) for s in (-1, 1)]
        symbols.arrow(ax, ends[0], ends[1], style="<|-|>")
        return
    if load.arm is not None:
        level = place.middle + 0.36 * place.thick
        for tip in (0.14, 0.05):
            symbols.arrow(ax, (start - 0.5, level), (start - tip, level))
        return
    # z points into the drawing; transverse arrows are centred on the axis.
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


def draw_forces(ax: Axes, scene: Scene, place: Placement) -> None:
    """Draw gravity beside the pillar, and a prestress above it and its labels."""
    if scene.gravity is not None and scene.gravity.acceleration:
        x = gravity_at(scene, place)
        across, along, depth = scene.gravity.direction
        level = LEVEL - GRAVITY / 2
        tip = (x + GRAVITY / 2 * along, level + GRAVITY / 2 * across)
        symbols.along_or_across(ax, tip, (along, across), -depth, GRAVITY)
        symbols.note(ax, x - ASIDE, level, gravity_words(scene.gravity), "right")
    if scene.prestress is not None and scene.prestress.normal:
        _draw_prestress(ax, scene.prestress.normal, place.x(scene.pillar.length / 2), LEVEL)


def gravity_at(scene: Scene, place: Placement) -> float:
    """Return the position of the gravity arrow, inches."""
    return min(place.x(scene.pillar.length) + 1.5, WIDTH - 0.3)


def gravity_words(gravity: Gravity | GravityInPlane) -> str:
    """Return the label of the gravity arrow."""
    return f"{gravity.acceleration:g} m/s²"


def _draw_prestress(ax: Axes, normal: float, x: float, level: float) -> None:
    """Draw two arrows, towards each other in compression, beside the number."""
    unit = unit_for("Pa", abs(normal))
    words = f"prestress {normal / unit.size:g} {unit.name}"
    symbols.note(ax, x, level, words)
    inner = CHARACTER * len(words) / 2 + 0.1
    for side in (-1, 1):
        far, near = (x + side * (inner + 0.4), level), (x + side * inner, level)
        tail, tip = (far, near) if normal > 0 else (near, far)
        symbols.arrow(ax, tail, tip, SOFT)
