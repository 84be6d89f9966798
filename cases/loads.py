"""The load of a scene over time, its means over time steps, and its highest frequency.

Integrals are exact, so an engine applies the mean of the load over each step. Units are those of an
end stress, Pa and Pa s; for the motion of a shaken base m/s and m, or m/s2 and m/s.
"""

from functools import lru_cache
from math import asin, pi, tan
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.histories import (
    Integrated,
    Late,
    LoadHistory,
    Recorded,
    Step,
    periodic,
    triangle,
)
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.sampling import Interpolation
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.pulse import Pulse
from jointwave.cases.schema.scene import Scene

#: Share of a load's energy (the integral of its square) below its "highest" frequency, which is
#: 1.50 / T for a single sine cycle, 1.67 / T for a Ricker wavelet.
SHARE = 0.95
LEAST_BLOCKS = 10.0  #: blocks, or element nodes, that resolve a wavelength
BINS, PADDING, MOST_CYCLES = 4096, 8, 32


def load_history(scene: Scene) -> LoadHistory:
    """Return the scene's load as a function of time: the end stress or the velocity of the base.

    Stress is positive in compression. A wave that enters an absorbing start (compliant base) loads
    it by twice its stress, 2 rho c v: the dashpot takes half (Mejia & Dawson, 4th FLAC Symposium,
    2006).
    """
    load, amplitude = scene.load, scene.load.amplitude
    if load.quantity == "incident-stress":
        amplitude *= 2
    elif load.is_motion and not scene.shakes_base:
        p = calibrate(scene).at_start.at_rest
        amplitude *= 2 * (p.shear_impedance if load.is_across else p.impedance)
    return velocity_of(load, amplitude)


def late_load(scene: Scene, model: str = "blocks") -> LoadHistory:
    """Return the load as it acts on the start of rigid "blocks", "jointed" rock or an "equivalent"
    bar, such that its wave enters there when it does in the bar."""
    return Late(load_history(scene), late_by(scene, model))


def late_by(scene: Scene, model: str) -> float:
    """Return how late that is behind an absorbing start, s: by the travel time through half a rigid
    block, or the half joint of jointed rock alone, where the end is matched; half of that where it
    is quiet. An oblique load is late like its axial part."""
    p, load = calibrate(scene).at_start.at_rest, scene.load
    part = {"matched": 0.5, "quiet": 0.25}.get(scene.ends.start, 0.0)
    impedance, modulus, intact = p.impedance, p.modulus, p.intact_modulus
    if bool(load.direction[1]) == (load.arm is not None):  # shear or torsion
        impedance, modulus, intact = p.shear_impedance, p.shear_modulus, p.intact_shear_modulus
    rock = {"blocks": 0.0, "jointed": 1 / max(intact or modulus, modulus)}.get(model, 1 / modulus)
    return part * p.spacing * impedance * (1 / modulus - rock)


def velocity_of(pulse: Pulse, amplitude: float) -> LoadHistory:
    """Return a pulse as a function of time, an acceleration as its integral."""
    found = history_of(pulse, amplitude)
    return Integrated(found) if pulse.quantity == "acceleration" else found


def history_of(pulse: Pulse, amplitude: float) -> LoadHistory:
    """Return a pulse of this amplitude as a function of time."""
    if pulse.shape == "step":
        return Step(amplitude)
    if pulse.shape == "table":
        assert pulse.history is not None
        return Recorded(pulse.history.time, amplitude * pulse.history.stress)
    if pulse.shape == "triangle":
        assert pulse.rise is not None and pulse.decay is not None
        return triangle(amplitude, pulse.rise, pulse.decay)
    assert pulse.period is not None
    return periodic(pulse.shape, amplitude, pulse.period, pulse.cycles)


def step_means(
    load: LoadHistory, dt: float, steps: np.ndarray, late: np.ndarray | float = 0.0
) -> np.ndarray:
    """Return the mean stress over [(n - 1/2) dt, (n + 1/2) dt] at equally spaced steps n [k], Pa
    [..., k]; late : delay of the load [..., 1], s.

    With this load leapfrog is exact for the bar at c dt = d: the momentum that enters between two
    half steps is exact. Means over consecutive steps add up to the impulse to round-off.
    """
    if len(steps) and steps[-1] - steps[0] == len(steps) - 1:
        edges = dt * (np.append(steps, steps[-1] + 1) - 0.5)
        return np.diff(load.impulse(edges - late), axis=-1) / dt
    before, after = (load.impulse(dt * (steps + half) - late) for half in (-0.5, 0.5))
    return (after - before) / dt


def with_load_itself(
    stress: np.ndarray, scene: Scene, sections: Interpolation, times: np.ndarray, dt: float
) -> np.ndarray:
    """Return stresses (Pa) in which the load itself replaces its mean over steps of dt (s).

    stress : float array [section, time] along y, or [section, axis, time]. sections : interpolation
    between contacts; contact 0 is the loaded face.
    """
    faced = np.flatnonzero((sections.left == 0) & (sections.weight < 1.0))
    if not faced.size or scene.shakes_base or scene.load.arm is not None:
        return stress
    load, found = late_load(scene), stress.copy()
    mean = (load.impulse(times + dt / 2) - load.impulse(times - dt / 2)) / dt
    axes = scene.load.direction[1] if stress.ndim == 2 else np.array(scene.load.direction)
    beside = np.multiply.outer(axes, load.value(times) - mean)
    found[faced] += np.multiply.outer(1.0 - sections.weight[faced], beside)
    return found


def with_walls(waves: dict[str, Any], scene: Scene, times: np.ndarray) -> dict[str, Any]:
    """Return waveforms of rigid blocks, linear from the middle of an end block to a fixed wall.

    waves : velocity, displacement and rotation [receiver, n], or along the axes [receiver, n, 3];
    beyond the middles of the end blocks they are those of the blocks.
    """
    centres, walls = calibrate(scene).centre_y[[0, -1]], (0.0, scene.pillar.length)
    base = velocity_of(scene.load, scene.load.amplitude if scene.shakes_base else 0.0)
    found = dict(waves)
    for (_, kind), wall, centre, moves in zip(scene.ends, walls, centres, (1.0, 0.0), strict=True):
        share = np.clip((np.array(scene.record.velocity) - centre) / (wall - centre), 0.0, 1.0)
        if kind != "fixed" or not share.any():
            continue
        for name, history in {"velocity": base.value, "displacement": base.impulse}.items():
            axes = scene.load.direction[1] if found[name].ndim == 2 else scene.load.direction
            moved = np.multiply.outer(moves * history(times), axes)
            found[name] = found[name] + np.multiply.outer(share, moved)
        for name in {*found} & {"velocity", "displacement", "rotation"}:
            found[name] = found[name] - (share * waves[name].T).T
    return found


def base_steps(pulse: Pulse, dt: float, count: int) -> np.ndarray:
    """Return the displacement of a shaken base in each step [n dt, (n + 1) dt], n = 0 to count - 1,
    m.

    A velocity history is integrated exactly over the step. An acceleration history gives, as
    leapfrog does, dt times the velocity at the half step.
    """
    history = history_of(pulse, pulse.amplitude)
    if pulse.quantity == "velocity":
        return np.diff(history.impulse(dt * np.arange(count + 1)))
    return dt * history.impulse(dt * (np.arange(count) + 0.5))


class ShortestWave(NamedTuple):
    """The slowest wave that a load drives, at the load's highest frequency.

    frequency : Hz. speed : m/s. blocks : per wavelength. cut_off : Hz, of a row of rigid blocks.
    """

    frequency: float
    speed: float
    blocks: float
    cut_off: float

    @property
    def reflection(self) -> float:
        """tan(k d / 4), the reflection from a quiet end on a rigid block (Guo & Li 2002, (9))."""
        if self.frequency >= self.cut_off:
            return 1.0
        return tan(asin(self.frequency / self.cut_off) / 2)


def shortest_wave(scene: Scene, p: Properties) -> ShortestWave | None:
    """Return the shortest wave under a scene's load; None without a load."""
    frequency = highest_frequency(scene)
    if frequency is None:
        return None
    sheared = scene.load.is_across or scene.load.arm is not None
    bar = min((one.at_rest for one in p.each), key=lambda one: one.bar_speed / one.spacing)
    speed = bar.shear_speed if sheared else bar.bar_speed
    blocks = speed / (frequency * bar.spacing)
    return ShortestWave(frequency, speed, blocks, speed / (pi * bar.spacing))


def highest_frequency(scene: AnyScene) -> float | None:
    """Return the frequency (Hz) below which 95 % of the energy of each load or wave lies; None
    without. A step is taken until the end of the scene, a shaken base by its velocity."""
    found = (frequency_of(one, scene.time.duration) for one in scene.pulses)
    return max((one for one in found if one is not None), default=None)


def frequency_of(pulse: Pulse, duration: float) -> float | None:
    """Return that frequency of one load or wave in a scene of this duration (s)."""
    if not pulse.amplitude:
        return None
    if pulse.history is None and (pulse.period or pulse.shape == "step"):
        cycles = min(pulse.cycles or 1, MOST_CYCLES)
        return _at_unit_period(pulse.shape, cycles) / (pulse.period or duration)
    history = history_of(pulse, 1.0)
    assert isinstance(history, Recorded)
    if not history.stress.any():
        return None
    start, end = history.time[[0, -1]].tolist()
    if pulse.quantity == "acceleration":
        return _below(history.impulse(np.linspace(start, end, BINS)), (end - start) / BINS)
    a, b = history.stress[:-1], history.stress[1:]  # piecewise linear
    energy = float(np.diff(history.time) @ (a * a + a * b + b * b)) / 3
    return _below(*_means(history, start, end), energy)


@lru_cache
def _at_unit_period(shape: str, cycles: int) -> float:
    """Return the frequency of a pulse times its period, or of a step times its duration."""
    load = Step(1.0) if shape == "step" else periodic(shape, 1.0, 1.0, cycles)
    return _below(*_means(load, 0.0, load.end or 1.0))


def _means(load: LoadHistory, start: float, end: float) -> tuple[np.ndarray, float]:
    """Return the means of a load in equal bins, and the bin length."""
    edges = np.linspace(start, end, BINS + 1)
    length = (end - start) / BINS
    return np.diff(load.impulse(edges)) / length, length


def _below(values: np.ndarray, length: float, energy: float = 0.0) -> float:
    """Return the frequency below which the share of the energy lies, at most the Nyquist frequency.

    energy : of the load itself, since averaging over bins of a length (s) may lose some.
    """
    count = PADDING * BINS
    power = np.abs(np.fft.rfft(values, count)) ** 2 * 2 * length / count
    power[0] /= 2
    below = np.cumsum(power)  # up to half a line past each frequency
    lines = (np.arange(power.size) + 0.5) / (count * length)
    return float(np.interp(SHARE * max(energy, below[-1]), below, lines))
