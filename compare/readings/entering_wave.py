"""The plane waves that the loads and waves of a scene send into its rock, before any run."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.histories import Gabor, LoadHistory, Ricker, Step
from jointwave.cases.incident import WITHIN, plane_wave
from jointwave.cases.loads import load_history, velocity_of
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.quiet_sides import impedances
from jointwave.cases.partition.joints import region_at, rocks_of
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.sources import PlaneLoad
from jointwave.compare.exact.bar.images import ENTERS
from jointwave.compare.exact.rock_mass.effective_medium import MediumField
from jointwave.compare.exact.rock_mass.field import field_of

SAMPLES = 20_000  # of a pulse: its peak to 1e-7, its energy to 1e-6
SEEN = 0.01  # of the peak of a wavelet, which never quite begins or ends


class EnteringWave(NamedTuple):
    """A plane wave as it enters: its source, peak stress (Pa) and particle velocity (m/s), the
    length of its pulse (m; None of a step) and its energy over the area of its front (J/m2).

    A wavelet is as long as it exceeds a hundredth of its peak. What goes on is cut where the scene
    ends.
    """

    source: str
    stress: float
    velocity: float
    length: float | None
    energy: float


def entering_waves(scene: AnyScene) -> list[EnteringWave]:
    """Return the plane waves that enter a scene; none of a couple, a force at a point, or a
    pressure on an opening or on a part of a side."""
    if scene.is_column:
        return list(_along_pillar(scene))
    loads = (
        wave
        for i, one in enumerate(scene.loads)
        if one.amplitude and one.side is not None and one.between is None
        for wave in _through_side(scene, f"loads[{i}]", one)
    )
    return [*_of_waves(scene), *loads]


def _along_pillar(scene: Scene) -> Iterator[EnteringWave]:
    load, p, history = scene.load, calibrate(scene).at_start, load_history(scene)
    if not load.amplitude or load.arm is not None:
        return
    x, y, z = load.direction
    parts = [(abs(y), p.bar_speed, "along"), (float(np.hypot(x, z)), p.shear_speed, "across")]
    for share, speed, way in parts:
        if scene.shakes_base:
            history, gain = velocity_of(load, load.amplitude), 1.0
        else:
            gain = ENTERS[scene.ends.start] / (p.density * speed)
        if share:
            gains = share * gain, p.density, speed
            yield _wave(f"load, {way} the axis", history, *gains, scene.time.duration)


def _of_waves(scene: RockMass) -> Iterator[EnteringWave]:
    try:
        field = field_of(scene) if scene.waves else None
    except SceneError:  # no engine takes them, which says why
        field = None
    for i, one in enumerate(scene.waves):
        if isinstance(field, MediumField):
            density, speed, pulse = scene.rock.density, field.waves[i].speed, field.waves[i].pulse
        else:
            wave = plane_wave(scene, one)
            density, speed, pulse = float(wave.rock.density), wave.speed, wave.pulse
        if one.amplitude:
            name = f"waves[{i}], {one.kind}"
            yield _wave(name, pulse, 1.0, density, speed, scene.time.duration)


def _through_side(scene: RockMass, table: str, load: PlaneLoad) -> Iterator[EnteringWave]:
    """Yield the P and the S wave of a load on the first face of a side."""
    outline = shape_of(scene.domain)
    corners, out = outline.faces_of(load.side)[0]
    normal = out[None]
    inside = corners.mean(axis=0) - WITHIN * outline.size * normal
    region = region_at(scene.regions, inside)
    density = rocks_of(scene)[region[0]].density
    quiet = getattr(scene.boundaries, load.side or "") == "quiet"
    history, moved = velocity_of(load, load.amplitude), np.array(load.direction or -normal[0])
    along = (normal[0] @ moved) * normal[0]
    dashpot = impedances(scene, normal, region)[0]
    for part, kind in zip((along, moved - along), "PS", strict=True):
        share = float(np.linalg.norm(part))
        if share > WITHIN:
            Z = part @ dashpot @ part / share**2
            gain = 1.0 if load.kind == "base" else (0.5 if quiet else 1.0) / Z
            gains = share * gain, density, float(Z) / density
            yield _wave(f"{table}, {kind}", history, *gains, scene.time.duration)


def _wave(
    source: str, history: LoadHistory, gain: float, density: float, speed: float, duration: float
) -> EnteringWave:
    """Return the wave whose particle velocity (m/s) is `gain` times a history."""
    end = min(duration, history.end or duration)
    breaks = [t for t in history.breaks if 0 <= t <= end]
    times = np.union1d(np.linspace(0.0, end, SAMPLES), breaks)
    values = gain * np.asarray(history.value(times))
    peak = float(np.abs(values).max())
    least = SEEN * peak if isinstance(history, Ricker | Gabor) else 0.0
    felt = np.flatnonzero(np.abs(values) > least)
    first, last = max(felt[0] - 1, 0), min(felt[-1] + 1, len(times) - 1)
    with np.errstate(over="ignore", under="ignore"):
        square = values**2
        energy = density * speed * float(np.diff(times) @ (square[1:] + square[:-1])) / 2
    length = None if isinstance(history, Step) else speed * float(times[last] - times[first])
    return EnteringWave(source, density * speed * peak, peak, length, energy)
