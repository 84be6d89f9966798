"""Modes of the damped free-free bar, sigma = E (strain + eta strain rate), under a sine.

    q_n'' + eta omega_n^2 q_n' + omega_n^2 q_n = f(t),   omega_n = n pi c / L,   x = y / L,
    u = (1/(rho L)) [int int f + 2 sum_n cos(n pi x) q_n]
    sigma = (2 c / L) sum_n sin(n pi x) omega_n (q_n + eta q_n')

The modal damping ratio is eta omega_n / 2 (Graff, Wave Motion in Elastic Solids, 1975); above 1
the roots r of r^2 + eta omega_n^2 r + omega_n^2 are real. q_n follows from
C(r) = int_0^t f(s) e^{r (t - s)} ds. The limit of high modes, q_n = w / omega_n^2 with
w + eta w' = f, is summed in closed form: sigma = f (1 - x) and
u = (L / E)(1/3 - x + x^2/2) w. The remainder converges as 1/n^3 and 1/n^4.

Valid for shape "sine", free ends, dashpots, no soft layers, every joint carrying tension.

A harmonic wave in this rock has the modulus E (1 + i omega eta), hence attenuation and dispersion.
"""

from math import pi
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.histories import Sine
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar.series import exponentials, rigid
from jointwave.compare.exact.conditions import DAMPED, holds, is_free, static_stress
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

HELD = ("prestress", "thick layers", "fixed start", *DAMPED)
SAFETY = 2.0
ROUND_OFF = 1e-9  # of a waveform's peak
SPLIT = 1e-5  # least distance of a mode's roots: q_n is even in it, so it costs 1e-10


def applies(scene: Scene) -> Answer:
    """Return whether the scene's homogenised bar is damped, free, uniform, and under a sine."""
    return holds(
        scene,
        HELD,
        (not calibrate(scene).time_constant, "the rock is not damped"),
        (not is_free(scene), "an end is not free"),
        (scene.load.shape != "sine", "the load is not a sine"),
    )


def solve(scene: Scene, n_terms: int = 500) -> xr.Dataset:
    """Return stress, velocity and displacement of the damped bar."""
    p, load, times = calibrate(scene), load_history(scene), sample_times(scene)
    assert isinstance(load, Sine) and p.time_constant is not None
    length, record, eta = scene.pillar.length, scene.record, p.time_constant
    sections, points = np.array(record.stress), np.array(record.velocity)
    f, x = load.value(times), points / length
    w = _convolutions(np.ones((1, 1)), np.array([-1 / eta]), load, times)[0] / eta
    w_rate = (f - w) / eta
    static = (length / p.bar_speed) ** 2 * (1 / 3 - x + x**2 / 2)
    rigid_velocity, rigid_displacement = rigid(load, times)
    found: dict[str, Any] = {
        "stress": np.outer(1 - sections / length, f),
        "velocity": rigid_velocity + np.outer(static, w_rate),
        "displacement": rigid_displacement + np.outer(static, w),
    }
    half: dict[str, np.ndarray] = {}
    for n in np.split(np.arange(1, n_terms + 1), [n_terms // 2]):
        half = {name: waves.copy() for name, waves in found.items()}
        wave = n * pi / length
        mode, shape = p.bar_speed * wave, 2 * np.cos(np.outer(points, wave))
        of_stress = 2 * p.bar_speed / length * np.sin(np.outer(sections, wave))
        q, rate = sums(of_stress * mode, mode, eta, load, times)
        found["stress"] += q + eta * rate - np.outer((of_stress / mode).sum(axis=1), f)
        q, rate = sums(shape, mode, eta, load, times)
        tail = (shape / mode**2).sum(axis=1)
        found["velocity"] += rate - np.outer(tail, w_rate)
        found["displacement"] += q - np.outer(tail, w)
    errors = {}
    for name, waves in found.items():
        if name != "stress":
            waves /= p.density * length
            half[name] /= p.density * length
        errors[name] = _left_out(waves, half[name])
    found["stress"] += static_stress(scene)
    return dataset(scene, SOLVER.name, times, **found, errors=errors)


def _left_out(waves: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Return the error bound of sums of modes [receivers, n], from the sums of half of the modes.

    The second half of the terms equals the remainder if they fall as 1/n^2, thrice it for 1/n^3.
    """
    from scipy.ndimage import maximum_filter1d

    last = maximum_filter1d(np.abs(waves - half), 3, axis=1)
    peak = np.abs(waves).max(axis=1, initial=0.0)
    return SAFETY * np.sqrt(np.mean(last**2, axis=1)) + ROUND_OFF * peak


def sums(
    weights: np.ndarray, mode: np.ndarray, eta: float, load: Sine, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return sums [m, times] of weights [m, n] times q_n (Pa s2), and times its rate (Pa s), at
    equally spaced times for modes [n] (rad/s) and a time constant (s)."""
    ratio = eta * mode / 2
    apart = np.sqrt(np.asarray(ratio**2 - 1, dtype=complex))
    split = np.where(np.abs(apart) < SPLIT, SPLIT, apart)
    fast = -mode * (ratio + split)
    slow = np.where(split == apart, mode**2 / fast, -mode * (ratio - split))
    share, roots = weights / (slow - fast), np.concatenate([slow, fast])
    shares = np.concatenate([share, -share], axis=1)
    q, rate = (_convolutions(one, roots, load, times) for one in (shares, shares * roots))
    return q, rate


def _convolutions(
    weights: np.ndarray, roots: np.ndarray, load: Sine, times: np.ndarray
) -> np.ndarray:
    """Return sums [m, times] of weights [m, n] times C(r) = int_0^t f(s) e^{r (t - s)} ds, for
    roots that are real or conjugate."""
    omega, on = 2 * pi / load.period, np.searchsorted(times, load.end)
    k, t = weights * load.amplitude / (roots**2 + omega**2), omega * times[:on]
    during = omega * exponentials(k, roots, times[:on])
    during -= np.outer(omega * k.sum(axis=1), np.cos(t)) + np.outer(k @ roots, np.sin(t))
    k = omega * np.expm1(roots * load.end) * k
    after = exponentials(k, roots, times[on:] - load.end)
    return np.concatenate([during.real, after.real], axis=1)


SOLVER = Solver(
    name="kelvin-voigt",
    rock=Rock.HOMOGENISED,
    label="Kelvin-Voigt bar, exact",
    line=thin("#00a26d", 5, (13.5, 15.5)),
    applies=applies,
    run=solve,
    distances={
        Kind.NUMERICAL: {"continuum-equivalent": "the same, from the damped modes"},
    },
)
