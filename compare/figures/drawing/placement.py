"""Position of the pillar in its drawing, whose unit is the inch."""

from typing import NamedTuple

from cases.schema.scene import Scene

WIDTH, HEIGHT = 7.3, 1.82  # inches of the drawing
SIDES = 0.95  # inches beside the pillar, for its load and supports
THICK, SQUAT = 0.42, 0.6  # inches across the pillar: at least, and at most
BASE = 0.6  # inches below the pillar, for its scale


class Placement(NamedTuple):
    """Position of the pillar: x of its start (inches), inches per metre along it, inches across."""

    start: float
    scale: float
    thick: float

    def x(self, y: float) -> float:
        """Return the x of a section, inches."""
        return self.start + self.scale * y

    @property
    def bottom(self) -> float:
        """The lower side."""
        return BASE

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
