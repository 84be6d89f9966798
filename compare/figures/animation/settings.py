"""Settings of an animation: direction, exaggeration, and the quantity of the colours."""

from math import floor, log10
from typing import NamedTuple

import numpy as np
import pandas as pd

from jointwave.cases.effects import is_spatial
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import AnyScene
from jointwave.results.snapshots import Snapshots

#: Limits of drawn displacements: of any over the size of the scene; approach of two neighbours over
#: the block's thickness; motion of a corner with respect to its cell over half the block's size.
FARTHEST, CLOSER, TURNED = 0.04, 0.8, 0.35
THIN = 0.045  # smallest legible ratio of the pillar's height to its length
SILENT = 0.1  # axial stress over that of a plane wave of this motion: below it no axial wave
DEGENERATE = 1.01  # ratio of the squared motions across the axis below which neither prevails
X, Y, Z = np.eye(3)


class Quantity(NamedTuple):
    """The quantity of the colours with its unit, the factor from SI to it, and the meaning of its
    sign, "" if unsigned."""

    name: str
    factor: float = 1.0
    sign: str = ""

    @property
    def label(self) -> str:
        """The title of the colour bar."""
        return ", ".join(part for part in (self.name, self.sign) if part)


STRESS = Quantity("axial stress (MPa)", 1e-6, "compression positive")
VELOCITY = Quantity("velocity across (m/s)", 1.0, "upwards positive")
SPEED = Quantity("particle speed (m/s)")
PEAK = Quantity("peak particle velocity (m/s)")
PRINCIPAL = Quantity("larger principal stress (MPa)", 1e-6, "compression positive")
SLIP = Quantity("slip of joints (mm)", 1e3)


class ViewSettings(NamedTuple):
    """Settings for drawing a scene.

    up, right : unit vectors [3] of the picture: y of a pillar is to the right, x of a rock mass.
    scale : of the displacements. stretch : of the thickness as seen. quantity : shown by the
    colours. side : of the section of a pillar, m, which its lines and sheets are drawn with.
    """

    up: np.ndarray
    scale: float
    stretch: float
    quantity: Quantity
    right: np.ndarray = X
    side: float = 0.0

    @property
    def caption(self) -> str:
        """The exaggeration, in words."""
        thicker = f", thickness × {self.stretch:.2g}" * (self.stretch != 1)
        return f"displacements × {self.scale:,g}{thicker}"


def quantities_of(scene: AnyScene) -> dict[str, Quantity]:
    """Return what the colours can show of a pillar or of a rock mass, by name; the stress of a
    pillar is that along it."""
    if scene.is_column:
        return {"stress": STRESS, "speed": SPEED, "across": VELOCITY}
    return {"speed": SPEED, "stress": PRINCIPAL}


def settings_for(
    scene: AnyScene,
    found: dict[str, Snapshots],
    scale: float | None = None,
    quantity: Quantity | None = None,
) -> ViewSettings:
    """Return the view settings for snapshots by engine.

    scale, quantity : of displacements and of the colours, instead of ours. A pillar is seen so that
    most of its motion across the axis is upwards, a rock mass in its plane or, in space, from the
    south.
    """
    up, stretch = Z if scene.in_space else Y, 1.0
    if scene.is_column:  # a thin one is drawn thicker
        stretch = max(1.0, THIN * scene.pillar.length / scene.pillar.side)
    largest = min(_largest_scale(scene, s, stretch) for s in found.values())
    view = ViewSettings(up, scale or max(1.0, round_down(largest)), stretch, quantity or SPEED)
    if not scene.is_column:
        return view
    across = next(iter(found.values())).displacement[..., [0, 2]].reshape(-1, 2)
    squares, axes = np.linalg.eigh(across.T @ across)
    x, z = axes[:, 1] if squares[1] > DEGENERATE * squares[0] else (1.0, 0.0)  # else x
    up, plane = np.array([x, 0.0, z]) * np.sign(x + z or 1.0), calibrate(scene).impedance
    silent = is_spatial(scene) and any(  # then the wave is transverse
        s.stress is None or np.abs(s.stress).max() < SILENT * plane * np.abs(s.velocity).max()
        for s in found.values()
    )
    ours = quantity or (VELOCITY if silent else STRESS)
    return view._replace(up=up, right=Y, quantity=ours, side=scene.pillar.side)


def _largest_scale(scene: AnyScene, s: Snapshots, stretch: float) -> float:
    """Return the largest exaggeration of displacements that keeps a scene recognisable."""
    moved = float(np.abs(s.displacement).max(axis=(0, 1)) @ [stretch, 1.0, stretch])
    limits = [(FARTHEST * float(np.ptp(s.points, axis=0).max()), moved)]
    if scene.is_column:
        p = calibrate(scene)
        along = pd.DataFrame(s.displacement[:, s.cells, 1].mean(axis=2).T).groupby(s.block).mean()
        limits.append((CLOSER * p.spacing, -float(along.diff().min().min())))
        corners = (u[s.cells] for u in s.displacement)
        turned = [np.linalg.norm(u - u.mean(axis=1, keepdims=True), axis=2).max() for u in corners]
        limits.append((TURNED * max(p.spacing, p.side) / 2, float(max(turned))))
    return min((most / found for most, found in limits if found > 0), default=1.0)


def round_down(value: float) -> float:
    """Return the largest of 1, 2 or 5 times a power of ten that is at most `value`."""
    power = 10.0 ** floor(log10(value))
    return power * max(k for k in (1, 2, 5) if k * power <= value * (1 + 1e-12))
