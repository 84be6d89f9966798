"""Settings of a view: its direction, its exaggeration, and the quantity of its colours."""

from math import floor, log10
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.effects import is_spatial
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.scene import Scene
from jointwave.results.snapshots import Snapshots

#: Limits of drawn displacements: approach of two neighbours over the block's thickness; motion of a
#: node along and across, over the pillar's length; rotation of a corner over half the largest side.
CLOSER, FARTHER, ASIDE, TURNED = 0.8, 0.1, 0.04, 0.35
THIN = 0.045  # smallest legible ratio of the pillar's height to its length
FARTHEST = 0.04  # largest displacement as drawn, relative to the size of a rock mass
SILENT = 0.1  # axial stress over that of a plane wave of this motion: below it no axial wave


class Quantity(NamedTuple):
    """The quantity of the colours: its name, the factor from SI to its unit, and the meaning of its
    sign, "" if unsigned."""

    name: str
    unit: str
    factor: float
    sign: str

    @property
    def label(self) -> str:
        """The title of the colour bar."""
        return ", ".join(part for part in (f"{self.name} ({self.unit})", self.sign) if part)


STRESS = Quantity("axial stress", "MPa", 1e-6, "compression positive")
VELOCITY = Quantity("velocity across", "m/s", 1.0, "upwards positive")
DISPLACEMENT = Quantity("displacement magnitude", "mm", 1e3, "")
SPEED = Quantity("particle speed", "m/s", 1.0, "")


class ViewSettings(NamedTuple):
    """Settings for drawing a scene.

    up : unit vector [3], upward direction of the picture; y is to the right, x for a rock mass.
    scale : of the displacements. stretch : of the pillar's thickness. quantity : shown by the
    colours.
    """

    up: np.ndarray
    scale: float
    stretch: float
    quantity: Quantity


def caption(scene: AnyScene, settings: ViewSettings) -> str:
    """Return the caption of a picture: its exaggeration, and the static state subtracted."""
    parts = [f"displacements × {settings.scale:,g}"]
    if settings.stretch != 1:
        parts.append(f"thickness × {settings.stretch:.2g}")
    if settings.quantity != STRESS:
        return ", ".join(parts)
    if scene.gravity is not None:
        parts.append("stress change from the static state")
    elif isinstance(scene, Scene) and scene.prestress and scene.prestress.normal:
        parts.append(f"stress change from the prestress of {scene.prestress.normal / 1e6:g} MPa")
    return ", ".join(parts)


def settings_for(
    scene: AnyScene,
    found: dict[str, Snapshots],
    scale: float | None = None,
    of_mass: Quantity = SPEED,
) -> ViewSettings:
    """Return the view settings for snapshots by engine.

    scale : of displacements, instead of ours. of_mass : the quantity shown in a rock mass.
    A row of blocks is viewed normal to the plane in which it is driven, so that its motion along
    and across its axis lies in the plane of the picture, as does a rock mass.
    """
    if not isinstance(scene, Scene):
        up, stretch, quantity = np.array([0.0, 1.0, 0.0]), 1.0, of_mass
        largest = [
            FARTHEST * np.ptp(s.points, axis=0).max() / np.linalg.norm(s.displacement, axis=2).max()
            for s in found.values()
            if s.displacement.any()
        ]
    else:
        up, quantity = _upwards(scene), _quantity(scene, found)
        stretch = max(1.0, THIN * scene.pillar.length / scene.pillar.side)
        largest = [_largest_scale(scene, s, stretch) for s in found.values()]
    chosen = scale or max(1.0, round_down(min(largest, default=1.0)))
    return ViewSettings(up, chosen, stretch, quantity)


def _upwards(scene: Scene) -> np.ndarray:
    """Return the direction across the axis in which the scene is driven, by default x."""
    load = scene.load
    drives = [np.array(load.direction), np.array([load.at[0], 0.0, load.at[1]])]
    if load.arm is not None:  # blocks bend across the axis of the couple
        drives = [np.cross(load.direction, [0.0, 1.0, 0.0])]
    if scene.gravity is not None:
        drives.append(np.array(scene.gravity.direction))
    for drive in drives:
        across = drive * [1, 0, 1]
        if (size := np.linalg.norm(across)) > 1e-9:
            return across / size
    return np.array([1.0, 0.0, 0.0])


def round_down(value: float) -> float:
    """Return the largest of 1, 2 or 5 times a power of ten that is at most `value`."""
    if not 0 < value < np.inf:
        return 1.0
    power = 10.0 ** floor(log10(value))
    return power * max(k for k in (1, 2, 5) if k * power <= value * (1 + 1e-12))


def _largest_scale(scene: Scene, s: Snapshots, stretch: float) -> float:
    """Return the largest exaggeration of displacements that keeps the pillar recognisable."""
    p, length = calibrate(scene), scene.pillar.length
    owner = np.zeros(len(s.points), dtype=int)
    owner[s.cells] = s.block[:, None]
    share = csr_matrix((1 / np.bincount(owner)[owner], (owner, np.arange(len(owner)))))
    centres = np.stack([share @ u for u in s.displacement])
    limits = [
        (-np.diff(centres[..., 1], axis=1), CLOSER * p.spacing),
        (np.abs(s.displacement[..., 1]), FARTHER * length),
        (np.abs(s.displacement[..., [0, 2]]), ASIDE * length / stretch),
        (
            np.linalg.norm(s.displacement - centres[:, owner], axis=2),
            TURNED * max(p.spacing, p.side) / 2,
        ),
    ]
    return min((bound / x.max() for x, bound in limits if x.size and x.max() > 0), default=np.inf)


def _quantity(scene: Scene, found: dict[str, Snapshots]) -> Quantity:
    """Return the axial stress, or the transverse motion if the wave is transverse."""
    if not is_spatial(scene):
        return STRESS
    impedance = calibrate(scene).impedance
    for s in found.values():
        stress = 0.0 if s.stress is None else float(np.abs(s.stress).max())
        if stress < SILENT * impedance * float(np.abs(s.velocity).max()):
            return VELOCITY
    return STRESS
