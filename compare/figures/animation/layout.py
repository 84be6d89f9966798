"""The layout of a three-dimensional view: bodies and camera."""

from typing import NamedTuple

import numpy as np

from cases.schema.scene import Scene
from compare.figures.animation.snapshots import SceneSnapshots
from compare.figures.animation.surface import Y, solid
from compare.figures.animation.view_settings import ViewSettings
from results.snapshots import Snapshots

APART = 3.0  # from one pillar's axis to the next, in thicknesses as drawn, at least
BESIDE = 1.1  # from one rock mass to the next, in widths as drawn
TILT = 0.35, 0.3  # how far who looks at pillars stands to the right and above, of the distance
ABOVE = 0.04  # of the size of a rock mass, that its name stands above it
TALL = 1.5  # the picture's height over that of a rock mass: text above, colours below


class Layout(NamedTuple):
    """Where the bodies of a view are drawn, m.

    found : by engine, the snapshots whose cells are drawn. stretch : of a body by axis [3]. middle
    : of the first body [3]. apart : from one body to the next [3]. name : where a body's name
    stands, beside the place of the body [3]. towards : direction to the viewer [3]. size : width
    and height that the picture must show.
    """

    found: dict[str, Snapshots]
    stretch: tuple[float, float, float]
    middle: np.ndarray
    apart: np.ndarray
    name: np.ndarray
    towards: np.ndarray
    size: tuple[float, float]


def layout_of(simulated: SceneSnapshots, settings: ViewSettings) -> Layout:
    """Return how both engines' bodies are laid out: pillars one above the other, rock masses side
    by side."""
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
