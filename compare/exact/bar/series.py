"""Modal series of the undamped free-free bar under whole cycles of a sine.

Guo & Li (2002), appendix (5a), (5b), with the prefactor of a stress and t > T in (5b):

    sigma = (2 p0 c / L) sum_n sin(n pi y / L) g_n(t),   omega_n = n pi c / L,   T_e = cycles T
    g_n = (omega sin(omega_n t) - omega_n sin(omega t)) / (omega^2 - omega_n^2)          t < T_e
    g_n = omega (sin(omega_n t) - sin(omega_n (t - T_e))) / (omega^2 - omega_n^2)        t > T_e

and at omega_n = omega the limits (sin(omega t)/omega - t cos(omega t))/2 and -T_e cos(omega t)/2.
Velocity has cos(n pi y / L), the time derivative of g_n over rho c, and the rigid mode, to which
displacement adds its integral. The paper stops at n = 100. The truncation error is measured
against `images`.

Valid for shape "sine", free ends, no dashpots, no soft layers, every joint carrying tension.
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
from jointwave.compare.exact.conditions import is_free, static_stress
from jointwave.compare.solvers.record import Answer, Rock, Solver, thin
from jointwave.results.dataset import dataset

PAPER_TERMS = 100
ROUND_OFF = 1e-12  # of the sum, relative to a waveform's peak
RUN = 64  # samples
NEAR = sqrt(np.finfo(float).eps)  # relative distance to resonance below which the limit is nearer


def applies(scene: Scene) -> Answer:
    """Return whether the paper's series applies: an undamped free-free bar under a sine."""
    answer = images.applies(scene)
    if not answer:
        return answer
    if not is_free(scene):
        return Answer("an end is not free")
    if 0.0 in scene.record.stress:
        return Answer("every term is zero at the loaded end")
    return answer if scene.load.shape == "sine" else Answer("the load is not a sine")


def solve(scene: Scene, n_terms: int = 2000) -> xr.Dataset:
    """Return stress, velocity and displacement of the series after `n_terms` terms."""
    p, load, times = calibrate(scene), load_history(scene), sample_times(scene)
    assert isinstance(load, Sine)
    length, speed, record = scene.pillar.length, p.bar_speed, scene.record
    wave = np.arange(1, n_terms + 1) * pi / length
    shape = 2 / (p.density * length) * np.cos(np.outer(record.velocity, wave))
    of_stress = 2 * speed / length * np.sin(np.outer(record.stress, wave))
    stress, _ = amplitudes(of_stress, wave * speed, load, times)
    displacement, _ = amplitudes(shape / (wave * speed), wave * speed, load, times)
    _, velocity = amplitudes(shape, wave * speed, load, times)
    rigid_velocity, rigid_displacement = rigid(load, times)
    velocity += rigid_velocity / (p.density * length)
    displacement += rigid_displacement / (p.density * length)
    found: dict[str, Any] = {
        "stress": stress + static_stress(scene),
        "velocity": velocity,
        "displacement": displacement,
    }
    errors = _left_out(found, images.solve(scene))
    return dataset(scene, SOLVER.name, times, **found, errors=errors)


def _left_out(found: dict, exact: xr.Dataset) -> dict[str, np.ndarray]:
    """Return root-mean-square errors of waveforms from the closed form, with its round-off."""
    errors = {}
    for name, waves in found.items():
        closed = exact[name].values.reshape(waves.shape)
        off = np.sqrt(np.mean((waves - closed) ** 2, axis=1))
        errors[name] = off + ROUND_OFF * np.abs(closed).max(axis=1, initial=0.0)
    return errors


def amplitudes(
    weights: np.ndarray, mode: np.ndarray, load: Sine, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return sums [m, times] of weights [m, n] times g_n p0 (Pa s), and times its rate over omega_n
    (Pa s), at equally spaced `times` for modes [n] (rad/s)."""
    omega, t = 2 * pi / load.period, np.minimum(times, load.end)
    resonant, on = np.abs(mode - omega) < NEAR * omega, np.searchsorted(times, load.end)
    factor = load.amplitude * omega / np.where(resonant, 1.0, omega**2 - mode**2)
    share = weights * np.where(resonant, 0.0, factor)
    # e^{i m t} - e^{i m (t - end)}; without the second term while the load lasts.
    after = share * (1 - np.exp(-1j * mode * load.end))
    parts = ((share, times[:on]), (after, times[on:]))
    turned = np.concatenate([exponentials(k, 1j * mode, some) for k, some in parts], axis=1)
    g, rate = turned.imag.copy(), turned.real.copy()
    g[:, :on] -= np.outer(share @ mode / omega, np.sin(omega * times[:on]))
    rate[:, :on] -= np.outer(share.sum(axis=1), np.cos(omega * times[:on]))
    limit = load.amplitude / 2 * weights[:, resonant].sum(axis=1)
    g += np.outer(limit, np.sin(omega * t) / omega - t * np.cos(omega * times))
    rate += np.outer(limit, t * np.sin(omega * times))
    return g, rate


def exponentials(weights: np.ndarray, roots: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Return sums [m, times] of weights [m, n] times e^{r t} at equally spaced times for roots [n],
    1/s: the exponentials within a run of times, multiplied by those at the starts of runs."""
    starts, run = times[::RUN], times[:RUN] - times[:1]
    first = weights[:, None] * np.exp(np.outer(starts, roots))
    found = first @ np.exp(np.outer(roots, run))
    return found.reshape(len(weights), found.shape[1] * found.shape[2])[:, : len(times)]


def rigid(load: Sine, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the first and second time integrals of the load (Pa s, Pa s2)."""
    omega, t = 2 * pi / load.period, np.clip(times, 0.0, load.end)
    return load.impulse(times), load.amplitude / omega * (t - np.sin(omega * t) / omega)


SOLVER = Solver(
    name="series",
    rock=Rock.HOMOGENISED,
    label="homogenised bar, series",
    line=thin("#b0307e", 4, (16, 18)),
    applies=applies,
    run=solve,
)
