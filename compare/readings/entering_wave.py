"""The plane waves that a scene's loads and waves send into its rock, before any run."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.histories import Gabor, Integrated, LoadHistory, Ricker, Step
from jointwave.cases.incident import WITHIN, plane_wave
from jointwave.cases.loads import velocity_of
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.quiet_sides import impedances
from jointwave.cases.partition.joints import region_at, rocks_of
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import Wave
from jointwave.compare.exact.rock_mass.effective_medium import MediumField
from jointwave.compare.exact.rock_mass.field import field_of

SAMPLES = 20_000  # of a pulse: gives its peak to 1e-7, its energy to 1e-6
ABSORBS = "quiet", "matched"  # ends or sides that take half of a pressure
SEEN = 0.01  # of its peak, the threshold for a wavelet's length


class EnteringWave(NamedTuple):
    """A plane wave as it enters: source, peak stress (Pa) and particle velocity (m/s), length of
    the pulse (m; None for a step) and energy per area of the front (J/m2), up to the scene's end.

    A wavelet's length is where it exceeds a hundredth of its peak.
    """

    source: str
    stress: float
    velocity: float
    length: float | None
    energy: float


def entering_waves(scene: AnyScene) -> list[EnteringWave]:
    """Return the plane waves that enter a scene; none from couples, point forces, or pressures on
    an opening or on part of a side."""
    found, sources = [*_of_waves(scene)], dict[str, Any](scene.sources)
    for key, load in sources.items():
        part = getattr(load, "arm", None) or getattr(load, "between", None)  # or a couple
        if not isinstance(load, Wave) and load.side and load.amplitude and not part:
            found += _of_load(scene, key, load)
    return found


def _of_waves(scene: Any) -> Iterator[EnteringWave]:
    try:
        field = field_of(scene) if scene.waves else None
    except SceneError:  # engines refuse the scene with this error
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


def _of_load(scene: Any, key: str, load: Any) -> Iterator[EnteringWave]:
    """Yield the waves of a load along and across the normal of the first face that it acts on."""
    if load.kind == "load":
        p, out, held = calibrate(scene).at_start, np.array([0.0, -1.0, 0.0]), scene.ends.start
        p = p.at_rest
        density, dashpot = p.density, np.diag([p.shear_impedance, p.impedance, p.shear_impedance])
        kinds = "along the axis", "across the axis"
    else:
        outline, held = shape_of(scene.domain), getattr(scene.boundaries, load.side)
        corners, out = outline.faces_of(load.side)[0]
        inside = (corners.mean(axis=0) - WITHIN * outline.size * out)[None]
        region = region_at(scene.regions, inside)
        density = rocks_of(scene)[region[0]].density
        dashpot = impedances(scene, out[None], inside, region)[0]
        kinds = "P", "S"
    history, moved = velocity_of(load, load.amplitude), np.array(load.direction or -out)
    along, halved = (out @ moved) * out, held in ABSORBS and load.quantity != "incident-stress"
    for part, kind in zip((along, moved - along), kinds, strict=True):
        share = float(np.linalg.norm(part))
        if share > WITHIN:
            Z = float(part @ dashpot @ part) / share**2
            moves = load.quantity in ("velocity", "acceleration")
            gain = share * (1.0 if moves else (0.5 if halved else 1.0) / Z)
            yield _wave(f"{key}, {kind}", history, gain, density, Z / density, scene.time.duration)


def _wave(
    source: str, history: LoadHistory, gain: float, density: float, speed: float, duration: float
) -> EnteringWave:
    """Return the wave whose particle velocity (m/s) is `gain` times a history."""
    end = min(duration, history.end or duration)
    breaks = [t for t in history.breaks if 0 <= t <= end]
    if isinstance(history, Integrated):  # the velocity remains after the acceleration ends
        breaks.append(duration)
    times = np.union1d(np.linspace(0.0, end, SAMPLES), breaks)
    values = gain * np.asarray(history.value(times))
    peak = float(np.abs(values).max())
    least = SEEN if isinstance(history, Ricker | Gabor) else WITHIN
    felt = np.flatnonzero(np.abs(values) > least * peak)
    first, last = max(felt[0] - 1, 0), min(felt[-1] + 1, len(times) - 1)
    with np.errstate(over="ignore", under="ignore"):
        square = values**2
        energy = density * speed * float(np.diff(times) @ (square[1:] + square[:-1])) / 2
    length = None if isinstance(history, Step) else speed * float(times[last] - times[first])
    return EnteringWave(source, density * speed * peak, peak, length, energy)
