"""The section of the pillar at its start, to scale: contact points and point of the load."""

from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from cases.effects import is_spatial
from cases.material.face import face_points
from cases.schema.scene import Scene
from compare.figures.drawing import symbols
from compare.figures.drawing.symbols import EDGE, INK, ROCK, SOFT

SIZE = 0.8  # inches of a side
WIDTH, HEIGHT = 1.5, 1.68  # inches of the drawing
MIDDLE = 0.75, 0.87


def appearance(scene: Scene) -> tuple[object, ...]:
    """Return everything that determines the drawing of a scene's section."""
    joints = scene.joints.contact_points, scene.joints.point_rule
    return (*joints, scene.pillar.side, scene.load.model_dump(), is_spatial(scene))


def draw_section(ax: Axes, scene: Scene) -> None:
    """Draw the section viewed against y, x up and z to the right, in axes of WIDTH x HEIGHT inches.

    Contact points, one part each of the SVG's group `contacts`, are drawn only for spatial motion:
    in axial motion all points of a face behave the same.
    """
    ax.set(xlim=(0, WIDTH), ylim=(0, HEIGHT), aspect="equal")
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
