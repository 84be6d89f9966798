"""The layout of a three-dimensional view: bodies and camera."""

from typing import NamedTuple

import numpy as np

from cases.schema.scene import Scene
from compare.figures.animation.snapshots import SceneSnapshots
from compare.figures.animation.surface import Y, solid
from compare.figures.animation.view_settings import ViewSettings
from results.snapshots import Snapshots

APART = 3.0  # least distance of two pillars' axes, in thicknesses as drawn
BESIDE = 1.1  # distance of two rock masses, in widths as drawn
TILT = 0.35, 0.3  # offset of the viewer of pillars to the right and up, of the distance
ABOVE = 0.04  # height of the name above a rock mass, relative to its size
TALL = 1.5  # picture's height over that of a rock mass: text above, colours below


class Layout(NamedTuple):
    """Positions of the bodies of a view, m.

    found : by engine, the snapshots whose cells are drawn. stretch : of a body by axis [3]. middle
    : of the first body [3]. apart : offset of successive bodies [3]. name : position of a body's
    name relative to the body [3]. towards : direction to the viewer [3]. size : width and height
    that the picture must show.
    """

    found: dict[str, Snapshots]
    stretch: tuple[float, float, float]
    middle: np.ndarray
    apart: np.ndarray
    name: np.ndarray
    towards: np.ndarray
    size: tuple[float, float]


def layout_of(simulated: SceneSnapshots, settings: ViewSettings) -> Layout:
    """Return the layout of both engines' bodies: pillars one above the other, rock masses side by
    side."""
    if isinstance(simulated.scene, Scene):
        return _of_pillars(simulated.scene, simulated.found, settings)
    return _of_rock_masses(simulated.found, settings)


def _of_pillars(scene: Scene, found: dict[str, Snapshots], settings: ViewSettings) -> Layout:
    side, length, up = scene.pillar.side, scene.pillar.length, settings.up
    found = {name: solid(s, side) for name, s in found.items()}
    drawn = [s.points + settings.scale * s.displacement for s in found.values()]
    reach = max(float(np.ptp(x @ up)) for x in drawn)
    apart = settings.stretch * max(APART * side, reach + side)
    right, above = TILT
    return Layout(
        found,
        (settings.stretch, 1.0, settings.stretch),
        Y * length / 2,
        -apart * up,
        0.8 * settings.stretch * side * up,
        np.cross(Y, up) + right * Y + above * up,
        (length, apart * len(found)),
    )


def _of_rock_masses(found: dict[str, Snapshots], settings: ViewSettings) -> Layout:
    points = np.concatenate([s.points for s in found.values()])
    low, high = points.min(axis=0), points.max(axis=0)
    wide, tall, _ = high - low
    return Layout(
        found,
        (1.0, 1.0, 1.0),
        (low + high) / 2,
        np.array([BESIDE * wide, 0.0, 0.0]),
        np.array([low[0], high[1] + ABOVE * max(wide, tall), 0.0]),
        np.cross([1.0, 0.0, 0.0], settings.up),
        (BESIDE * wide * len(found), TALL * tall),
    )
