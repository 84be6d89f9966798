"""The load of a scene over time, and its values at an engine's steps.

Its integral is exact, so an engine applies the mean of the load over each of its steps. Units are
those of an end stress, Pa and Pa s; the motion of a shaken base has m/s and m, or m/s2 and m/s, in
their place.
"""

import numpy as np

from jointwave.cases.histories import (
    Integrated,
    LoadHistory,
    Recorded,
    Step,
    periodic,
    triangle,
)
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import Interpolation
from jointwave.cases.schema.pulse import Pulse
from jointwave.cases.schema.scene import Scene


def load_history(scene: Scene) -> LoadHistory:
    """Return the scene's load as a function of time: its end stress or the motion of its base.

    Stress is positive in compression. Without a load the stress is zero. A wave that comes up to
    an absorbing start, a compliant base, is twice its stress, 2 rho c v: the dashpot takes half of
    it, and the other half enters (Mejia & Dawson, 4th FLAC Symposium, 2006).
    """
    load, amplitude = scene.load, scene.load.amplitude
    if not load.is_motion or scene.shakes_base:
        return history_of(load, amplitude * (2 if load.quantity == "incident-stress" else 1))
    p = calibrate(scene).at_start
    return velocity_of(load, 2 * amplitude * (p.shear_impedance if load.is_across else p.impedance))


def velocity_of(pulse: Pulse, amplitude: float) -> LoadHistory:
    """Return the velocity of a pulse of this amplitude that is one, or an acceleration."""
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
    load: LoadHistory, dt: float, count: int, first: int = 0, stride: int = 1
) -> np.ndarray:
    """Return the mean stress over [(n - 1/2) dt, (n + 1/2) dt] for `count` steps n from the first
    on, one in `stride`, Pa.

    This is the load that makes leapfrog exact for the bar at c dt = d: the momentum that enters
    between two half steps is the true one.
    """
    steps = first + stride * np.arange(count)
    before, after = (load.impulse(dt * (steps + half)) for half in (-0.5, 0.5))
    return (after - before) / dt


def with_load_itself(
    stress: np.ndarray, scene: Scene, sections: Interpolation, times: np.ndarray, dt: float
) -> np.ndarray:
    """Return stresses (Pa) that hold the load itself where steps of dt (s) took its mean.

    stress : float array [section, time] along y, or [section, axis, time]. sections : between
    contacts, of which 0 is the loaded face.
    """
    faced = np.flatnonzero((sections.left == 0) & (sections.weight < 1.0))
    if not faced.size or scene.shakes_base or scene.load.arm is not None:
        return stress
    load, found = load_history(scene), stress.copy()
    mean = (load.impulse(times + dt / 2) - load.impulse(times - dt / 2)) / dt
    axes = scene.load.direction[1] if stress.ndim == 2 else np.array(scene.load.direction)
    beside = np.multiply.outer(axes, load.value(times) - mean)
    found[faced] += np.multiply.outer(1.0 - sections.weight[faced], beside)
    return found


def base_steps(pulse: Pulse, dt: float, count: int) -> np.ndarray:
    """Return the displacement of the base that a pulse shakes in each step [n dt, (n + 1) dt],
    n = 0 .. count - 1, m.

    A velocity history is integrated exactly over the step. An acceleration history gives, as
    leapfrog does, dt times the velocity at the half step.
    """
    history = history_of(pulse, pulse.amplitude)
    if pulse.quantity == "velocity":
        return np.diff(history.impulse(dt * np.arange(count + 1)))
    return dt * history.impulse(dt * (np.arange(count) + 0.5))
