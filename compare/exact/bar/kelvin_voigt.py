"""Modes of the damped free-free bar, sigma = E (strain + eta strain rate), under a sine.

    q_n'' + eta omega_n^2 q_n' + omega_n^2 q_n = f(t),   omega_n = n pi c / L,   x = y / L,
    u = (1/(rho L)) [int int f + 2 sum_n cos(n pi x) q_n]
    sigma = (2 c / L) sum_n sin(n pi x) omega_n (q_n + eta q_n')

The modal damping ratio is eta omega_n / 2 (Graff, Wave Motion in Elastic Solids, 1975); above 1
the roots r of r^2 + eta omega_n^2 r + omega_n^2 are real. q_n follows from
C(r) = int_0^t f(s) e^{r (t - s)} ds. What high modes tend to, q_n = w / omega_n^2 with
w + eta w' = f, is summed in closed form: sigma = f (1 - x) and
u = (L / E)(1/3 - x + x^2/2) w. What is left converges as 1/n^3 and 1/n^4.

Holds for shape "sine", free ends, dashpots, no soft layers, every joint carrying tension.

A harmonic wave in this rock has the modulus E (1 + i omega eta), hence attenuation and dispersion.
"""

from math import pi

import numpy as np
import xarray as xr

from cases.histories import Sine
from cases.loads import load_history
from cases.material.calibrate import calibrate
from cases.sampling import sample_times
from cases.schema.scene import Scene
from compare.exact.bar.series import rigid
from compare.exact.conditions import DAMPED, holds, is_free, static_stress
from compare.solvers.record import BAR, Answer, Kind, Rock, Solver, Words, thin
from results.dataset import dataset

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
    w = _convolution(-1 / eta, load, times).real / eta
    w_rate = (f - w) / eta
    stress = np.outer(1 - sections / length, f)
    static = (length / p.bar_speed) ** 2 * (1 / 3 - x + x**2 / 2)
    rigid_velocity, rigid_displacement = rigid(load, times)
    velocity = rigid_velocity + np.outer(static, w_rate)
    displacement = rigid_displacement + np.outer(static, w)
    found = {"stress": stress, "velocity": velocity, "displacement": displacement}
    half = {}
    for n in range(1, n_terms + 1):
        mode, shape = n * pi * p.bar_speed / length, 2 * np.cos(n * pi * x)
        q, rate = response(mode, eta, load, times)
        excess = 2 * p.bar_speed / length * (mode * (q + eta * rate) - f / mode)
        found["stress"] += np.outer(np.sin(n * pi * sections / length), excess)
        found["velocity"] += np.outer(shape, rate - w_rate / mode**2)
        found["displacement"] += np.outer(shape, q - w / mode**2)
        if n == n_terms // 2:
            half = {name: waves.copy() for name, waves in found.items()}
    errors = {}
    for name, waves in found.items():
        if name != "stress":
            waves /= p.density * length
            half[name] /= p.density * length
        errors[name] = _left_out(waves, half[name])
    found["stress"] += static_stress(scene)
    return dataset(scene, SOLVER.name, times, **found, errors=errors)


def _left_out(waves: np.ndarray, half: np.ndarray) -> np.ndarray:
    """Return the bound of the errors of sums of modes [receivers, n] by the sums of half of them.

    The second half of terms that fall as 1/n^2 is as large as what is left out, of 1/n^3 thrice.
    """
    from scipy.ndimage import maximum_filter1d

    last = maximum_filter1d(np.abs(waves - half), 3, axis=1)
    peak = np.abs(waves).max(axis=1, initial=0.0)
    return SAFETY * np.sqrt(np.mean(last**2, axis=1)) + ROUND_OFF * peak


def response(
    mode: float, eta: float, load: Sine, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return q_n (Pa s2) and its rate (Pa s) for a mode (rad/s) and a time constant (s)."""
    ratio = eta * mode / 2
    if ratio**2 <= 1 - SPLIT**2:  # two roots that are conjugate, and so are their convolutions
        root = mode * complex(-ratio, np.sqrt(1 - ratio**2))
        a = _convolution(root, load, times)
        return a.imag / root.imag, (root * a).imag / root.imag
    split = np.sqrt(complex(ratio**2 - 1))
    if abs(split) < SPLIT:
        split = complex(SPLIT)
    fast = -mode * (ratio + split)
    slow = mode**2 / fast if abs(ratio**2 - 1) >= SPLIT**2 else -mode * (ratio - split)
    a, b = _convolution(slow, load, times), _convolution(fast, load, times)
    q, rate = (a - b) / (slow - fast), (slow * a - fast * b) / (slow - fast)
    return q.real, rate.real


def _convolution(root: complex, load: Sine, times: np.ndarray) -> np.ndarray:
    """Return C(r) = int_0^t f(s) e^{r (t - s)} ds at `times`."""
    omega, t, end = 2 * pi / load.period, np.maximum(times, 0.0), load.end
    on = t < end
    found = omega * np.exp(root * np.where(on, t, t - end))
    found[on] -= omega * np.cos(omega * t[on]) + root * np.sin(omega * t[on])
    found[~on] *= np.expm1(root * end)
    return load.amplitude / (root**2 + omega**2) * found


def wavenumber(omega: np.ndarray | float, speed: float, eta: float) -> np.ndarray:
    """Return k (1/m) of e^{i(omega t - k y)}: k = omega / (c sqrt(1 + i omega eta)).

    The phase speed is omega / Re k and the attenuation -Im k, about omega^2 eta / 2c.
    """
    return np.asarray(omega / (speed * np.sqrt(1 + 1j * np.asarray(omega) * eta)))


SOLVER = Solver(
    name="kelvin-voigt",
    rock=Rock.HOMOGENISED,
    words=Words(BAR, "Kelvin-Voigt bar, exact", "黏弹性杆（精确解）"),
    line=thin("#00a26d", 5, (13.5, 15.5), (4, 2, 1.2, 2, 1.2, 2)),
    applies=applies,
    run=solve,
    distances={
        Kind.NUMERICAL: {"continuum-equivalent": "the same, against the damped modes"},
    },
    arguments=("n_terms",),
)
