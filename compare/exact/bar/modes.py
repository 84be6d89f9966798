"""Modes of the homogenised free-free bar, sigma = E (strain + eta strain rate), under a sine.

    q_n'' + eta omega_n^2 q_n' + omega_n^2 q_n = f(t),   omega_n = n pi c / L,   x = y / L,
    u = (1/(rho L)) [int int f + 2 sum_n cos(n pi x) q_n]
    sigma = (2 c / L) sum_n sin(n pi x) omega_n (q_n + eta q_n')

The modal damping ratio is eta omega_n / 2 (Graff, Wave Motion in Elastic Solids, 1975); above 1 the
roots r of r^2 + eta omega_n^2 r + omega_n^2 are real. q_n follows from C(r) = int_0^t f(s) e^{r (t
- s)} ds.

Without damping this is the series of Guo & Li (2002), appendix (5a), (5b), with the prefactor of a
stress and t > T in (5b): with T_e = cycles T, omega_n q_n = p0 g_n,

    g_n = (omega sin(omega_n t) - omega_n sin(omega t)) / (omega^2 - omega_n^2)          t < T_e
    g_n = omega (sin(omega_n t) - sin(omega_n (t - T_e))) / (omega^2 - omega_n^2)        t > T_e

and at omega_n = omega the limits (sin(omega t)/omega - t cos(omega t))/2 and -T_e cos(omega t)/2.
The paper stops at n = 100. The truncation error is measured against `images`.

With damping the limit of high modes, q_n = w / omega_n^2 with w + eta w' = f, is summed in closed
form: sigma = f (1 - x) and u = (L / E)(1/3 - x + x^2/2) w. The remainder converges as 1/n^3 and
1/n^4. A harmonic wave in this rock has the modulus E (1 + i omega eta), hence attenuation and
dispersion.

Valid for shape "sine", free ends, no soft layers, every joint carrying tension.
"""

from math import pi, sqrt
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.histories import Sine
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar import images
from jointwave.compare.exact.conditions import DAMPED, holds
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

Waves = dict[str, Any]
SAFETY = 2.0
ROUND_OFF = 1e-12, 1e-9  # over a waveform's peak, without and with damping
RUN = 64  # samples whose exponentials share factors
NEAR = sqrt(np.finfo(float).eps)  # relative distance to resonance below which its limit is used
SPLIT = 1e-5  # least separation of a mode's roots: q_n is even in it, so the error is 1e-10


def applies(scene: Scene) -> Answer:
    """Return whether the paper's series applies: an undamped free-free bar under a sine."""
    if (answer := images.applies(scene) and _under_a_sine(scene)) and 0.0 in scene.record.stress:
        return Answer("every term is zero at the loaded end")
    return answer


def applies_damped(scene: Scene) -> Answer:
    """Return whether the scene's homogenised bar is damped, free, uniform and under a sine."""
    held = ("prestress", "thick layers", "fixed start", *DAMPED)
    undamped = not calibrate(scene).time_constant, "the rock is not damped"
    return holds(scene, held, undamped) and _under_a_sine(scene)


def _under_a_sine(scene: Scene) -> Answer:
    return Answer.unless(
        ({scene.ends.start, scene.ends.end} != {"free"}, "an end is not free"),
        (scene.load.shape != "sine", "the load is not a sine"),
    )


def solve(scene: Scene, n_terms: int = 2000) -> xr.Dataset:
    """Return stress, velocity and displacement of the paper's series after `n_terms` terms, with
    root-mean-square errors against the closed form."""
    (_, found), closed, errors = _summed(scene, n_terms), images.solve(scene), {}
    found["stress"] += calibrate(scene).prestress
    for name, waves in found.items():
        exact = closed[name].values.reshape(waves.shape)
        off = np.sqrt(np.mean((waves - exact) ** 2, axis=1))
        errors[name] = off + ROUND_OFF[0] * np.abs(exact).max(axis=1, initial=0.0)
    return dataset(scene, SERIES.name, sample_times(scene), found, errors=errors)


def solve_damped(scene: Scene, n_terms: int = 500) -> xr.Dataset:
    """Return stress, velocity and displacement of the damped bar. The second half of the modes
    bounds the error: it equals the remainder of modes as 1/n^2, and is thrice that of modes as
    1/n^3."""
    from scipy.ndimage import maximum_filter1d

    (half, found), errors = _summed(scene, n_terms), {}
    for name, waves in found.items():
        last = maximum_filter1d(np.abs(waves - half[name]), 3, axis=1)
        peak = np.abs(waves).max(axis=1, initial=0.0)
        errors[name] = SAFETY * np.sqrt(np.mean(last**2, axis=1)) + ROUND_OFF[1] * peak
    found["stress"] += calibrate(scene).prestress
    return dataset(scene, DAMPED_BAR.name, sample_times(scene), found, errors=errors)


def _summed(scene: Scene, n_terms: int) -> list[Waves]:
    """Return stress, velocity and displacement [receivers, n] after half and all of the terms,
    without the static stress."""
    p, load, times = calibrate(scene), load_history(scene), sample_times(scene)
    assert isinstance(load, Sine)
    length, eta, mass = scene.pillar.length, p.time_constant or 0.0, p.density * scene.pillar.length
    sections, points = np.array(scene.record.stress), np.array(scene.record.velocity)
    stress, f = np.zeros((len(sections), len(times))), load.value(times)
    rigid = load.impulse(times), load.double_impulse(times)
    velocity, displacement = (np.tile(one, (len(points), 1)) for one in rigid)
    w = w_rate = 0 * f
    if eta:
        x = points / length
        static = (length / p.bar_speed) ** 2 * (1 / 3 - x + x**2 / 2)
        w = _convolutions(np.ones((1, 1)), np.array([-1 / eta]), load, times)[0] / eta
        w_rate = (f - w) / eta
        stress += np.outer(1 - sections / length, f)
        velocity += np.outer(static, w_rate)
        displacement += np.outer(static, w)
    found = []
    for n in np.split(np.arange(1, n_terms + 1), [n_terms // 2]):
        wave = n * pi / length
        mode, shape = p.bar_speed * wave, 2 * np.cos(np.outer(points, wave))
        of_stress = 2 * p.bar_speed / length * np.sin(np.outer(sections, wave))
        q, rate = sums(of_stress * mode, mode, eta, load, times)
        stress = stress + q + eta * rate
        if eta:
            stress -= np.outer((of_stress / mode).sum(axis=1), f)
        q, rate = sums(shape, mode, eta, load, times)
        tail = (shape / mode**2).sum(axis=1)
        velocity = velocity + rate - np.outer(tail, w_rate)
        displacement = displacement + q - np.outer(tail, w)
        waves = stress, velocity / mass, displacement / mass
        found.append(dict(zip(("stress", "velocity", "displacement"), waves, strict=True)))
    return found


def sums(
    weights: np.ndarray, mode: np.ndarray, eta: float, load: Sine, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return sums [m, times] of weights [m, n] times q_n (Pa s2) and times q_n' (Pa s), at equally
    spaced times, for modes [n] (rad/s) and a time constant (s)."""
    omega, t = 2 * pi / load.period, np.minimum(times, load.end)
    resonant = (np.abs(mode - omega) < NEAR * omega) & (eta == 0)
    limit = load.amplitude / 2 * weights[:, resonant].sum(axis=1)
    weights, mode = np.where(resonant, 0.0, weights), np.where(resonant, 2 * omega, mode)
    ratio = eta * mode / 2
    apart = np.sqrt(np.asarray(ratio**2 - 1, dtype=complex))
    split = np.where(np.abs(apart) < SPLIT, SPLIT, apart)
    fast = -mode * (ratio + split)
    slow = np.where(split == apart, mode**2 / fast, -mode * (ratio - split))
    share, roots = weights / (slow - fast), np.concatenate([slow, fast])
    shares = np.concatenate([share, -share], axis=1)
    q, rate = (_convolutions(one, roots, load, times) for one in (shares, shares * roots))
    q += np.outer(limit / omega, np.sin(omega * t) / omega - t * np.cos(omega * times))
    return q, rate + np.outer(limit, t * np.sin(omega * times))


def _convolutions(
    weights: np.ndarray, roots: np.ndarray, load: Sine, times: np.ndarray
) -> np.ndarray:
    """Return sums [m, times] of weights [m, n] times C(r) = int_0^t f(s) e^{r (t - s)} ds, for
    roots that are real or in conjugate pairs."""
    omega, on = 2 * pi / load.period, np.searchsorted(times, load.end)
    k, t = weights * load.amplitude / (roots**2 + omega**2), omega * times[:on]
    during = omega * _exponentials(k, roots, times[:on])
    during -= np.outer(omega * k.sum(axis=1), np.cos(t)) + np.outer(k @ roots, np.sin(t))
    k = omega * np.expm1(roots * load.end) * k
    after = _exponentials(k, roots, times[on:] - load.end)
    return np.concatenate([during.real, after.real], axis=1)


def _exponentials(weights: np.ndarray, roots: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Return sums [m, times] of weights [m, n] times e^{r t} at equally spaced times for roots [n],
    1/s, as products of exponentials at the starts of runs and within a run."""
    starts, run = times[::RUN], times[:RUN] - times[:1]
    first = weights[:, None] * np.exp(np.outer(starts, roots))
    found = first @ np.exp(np.outer(roots, run))
    return found.reshape(len(weights), found.shape[1] * found.shape[2])[:, : len(times)]


SERIES = Solver(
    name="series",
    rock=Rock.HOMOGENISED,
    label="homogenised bar, series",
    line=thin("#b0307e", 4, (16, 18)),
    applies=applies,
    run=solve,
)
DAMPED_BAR = Solver(
    name="kelvin-voigt",
    rock=Rock.HOMOGENISED,
    label="Kelvin-Voigt bar, exact",
    line=thin("#00a26d", 5, (13.5, 15.5)),
    applies=applies_damped,
    run=solve_damped,
    distances={Kind.NUMERICAL: {"continuum-equivalent": "the same, from the damped modes"}},
)
