"""Snapshots of one scene by both engines, and the settings to draw them: direction of view,
exaggeration, and quantity of the colours."""

from math import ceil, floor, log10
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.validate import checked
from jointwave.compare.engines import ENGINES, Progress, applies
from jointwave.compare.figures.style import UNITS
from jointwave.compare.misfit.metrics import motion
from jointwave.compare.runs.reuse import NOWHERE, SNAPSHOTS, ResultFolder
from jointwave.results.snapshots import Snapshots, snapshots_of

#: Limits of drawn displacements: largest over the size of the scene; approach of two neighbours
#: over the block's thickness; motion of a corner relative to its cell over half the block's size.
FARTHEST, CLOSER, TURNED = 0.04, 0.8, 0.35
THIN = 0.045  # smallest legible ratio of the pillar's height to its length
SILENT = 0.1  # axial stress over impedance times velocity, below which the wave is not axial
DEGENERATE = 1.01  # ratio of squared transverse motions, below which no direction prevails
X, Y, Z = np.eye(3)


class SceneSnapshots(NamedTuple):
    """One scene with each engine's snapshots.

    scene : pillar or rock mass, which records these instants. found : snapshots by engine, at the
    same instants. reasons : why engines do not apply. results : recorded waveforms by engine.
    """

    scene: Any
    found: dict[str, Snapshots]
    reasons: dict[str, str]
    results: dict[str, xr.Dataset]

    @property
    def time(self) -> np.ndarray:
        """The instants, s."""
        return next(iter(self.found.values())).time


def take(
    scene: AnyScene,
    interval: float | None,
    progress: Progress | None = None,
    stored: ResultFolder = NOWHERE,
) -> SceneSnapshots:
    """Simulate a scene with both engines and return their snapshots.

    interval : s; None: the scene's own. stored : a folder of results. Stress is relative to the
    static state. The rock is jointed if that model applies, else homogenised. Raises SceneError and
    UnstableError as the engines do, and SceneError if none applies.
    """
    recorded = scene if interval is None else with_snapshots(scene, interval)
    shown = shown_engines(recorded)
    reasons = {n: answer.reason for n in ENGINES if not (answer := applies(n, recorded))}
    if not shown:
        why = "; ".join(f"{name}: {reason}" for name, reason in reasons.items())
        raise SceneError(scene.where, "", None, f"no engine has snapshots of it: {why}")
    found, results = {}, {}
    suffix = "" if interval is None else SNAPSHOTS
    for name, result in stored.solve(shown, recorded, progress, suffix):
        taken = snapshots_of(result)
        assert taken is not None
        if taken.stress is not None:
            field = result[["field_stress"]].rename(field_time="time", field_stress="stress")
            taken = taken._replace(stress=motion(field)["stress"].values)
        found[name] = taken
        results[name] = result[[q for q in UNITS if q in result]]
    return SceneSnapshots(recorded, found, {} if len(found) > 1 else reasons, results)


def shown_engines(scene: AnyScene) -> list[str]:
    """Return the first two engines that apply: rigid blocks and a model of the rock."""
    return [name for name in ENGINES if applies(name, scene)][:2]


def with_snapshots(scene: AnyScene, interval: float) -> AnyScene:
    """Return a scene that records snapshots at an interval, s, and samples at least as often."""
    between = interval / max(1, ceil(interval / scene.interval - 1e-9))
    record = scene.record.model_copy(update={"fields": interval, "interval": between})
    return checked(scene.model_copy(update={"record": record}))


class Quantity(NamedTuple):
    """The quantity of the colours: name with unit, factor from SI, meaning of the sign, if any."""

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

    up, right : unit vectors [3] of the picture; right is y of a pillar, x of a rock mass.
    scale : factor of displacements. stretch : factor of the thickness. quantity : of the colours.
    side : of the square section with which lines and sheets of a pillar are drawn, m.
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
    """Return the quantities that colours can show, by name; the stress of a pillar is axial."""
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

    scale, quantity : of displacements and colours; None: chosen here. A thin pillar is drawn
    thicker, and turned so that its transverse motion is mostly upwards; a rock mass in space is
    seen from the south.
    """
    view = ViewSettings(Z if scene.in_space else Y, 1.0, 1.0, quantity or SPEED)
    if scene.is_column:
        view = _of_pillar(scene, found, quantity)
    largest = min(_largest_scale(scene, s, view.stretch) for s in found.values())
    steps = 10.0 ** floor(log10(largest)) * np.array([1, 2, 5])  # rounded down to one of them
    rounded = float(steps[steps <= largest * (1 + 1e-12)].max())
    return view._replace(scale=scale or max(1.0, rounded))


def _of_pillar(scene: Any, found: dict[str, Snapshots], quantity: Quantity | None) -> ViewSettings:
    pillar, across = (
        scene.pillar,
        next(iter(found.values())).displacement[..., [0, 2]].reshape(-1, 2),
    )
    squares, axes = np.linalg.eigh(across.T @ across)
    x, z = axes[:, 1] if squares[1] > DEGENERATE * squares[0] else (1.0, 0.0)  # else x
    up, plane = np.array([x, 0.0, z]) * np.sign(x + z or 1.0), calibrate(scene).impedance
    silent = scene.is_spatial and any(  # the wave is transverse
        s.stress is None or np.abs(s.stress).max() < SILENT * plane * np.abs(s.velocity).max()
        for s in found.values()
    )
    ours = quantity or (VELOCITY if silent else STRESS)
    return ViewSettings(up, 1.0, max(1.0, THIN * pillar.length / pillar.side), ours, Y, pillar.side)


def _largest_scale(scene: AnyScene, s: Snapshots, stretch: float) -> float:
    """Return the largest exaggeration of displacements within the limits above."""
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
