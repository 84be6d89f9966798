"""Modal series of the undamped free-free bar under whole cycles of a sine.

Guo & Li (2002), appendix (5a), (5b), with the prefactor of a stress and t > T in (5b):

    sigma = (2 p0 c / L) sum_n sin(n pi y / L) g_n(t),   omega_n = n pi c / L,   T_e = cycles T
    g_n = (omega sin(omega_n t) - omega_n sin(omega t)) / (omega^2 - omega_n^2)          t < T_e
    g_n = omega (sin(omega_n t) - sin(omega_n (t - T_e))) / (omega^2 - omega_n^2)        t > T_e

and at omega_n = omega the limits (sin(omega t)/omega - t cos(omega t))/2 and -T_e cos(omega t)/2.
Velocity has cos(n pi y / L), the time derivative of g_n over rho c, and the rigid mode, to which
displacement adds its integral. The paper stops at n = 100. What a sum leaves out is measured by
`images`.

Holds for shape "sine", free ends, no dashpots, no soft layers, every joint carrying tension.
"""

from math import cos, pi, sin, sqrt

import numpy as np
import xarray as xr

from cases.histories import Sine
from cases.loads import load_history
from cases.material.calibrate import calibrate
from cases.sampling import sample_times
from cases.schema.scene import Scene
from compare.exact.bar import images
from compare.exact.conditions import is_free, static_stress
from compare.solvers.record import BAR, Answer, Rock, Solver, Words, no, thin
from results.dataset import dataset

PAPER_TERMS = 100
ROUND_OFF = 1e-12  # of the sum, by a waveform's peak
NEAR = sqrt(np.finfo(float).eps)  # relative distance to resonance below which the limit is nearer


def applies(scene: Scene) -> Answer:
    """Return whether the paper's series holds: an undamped free-free bar under a sine."""
    answer = images.applies(scene)
    if not answer:
        return answer
    if not is_free(scene):
        return no("an end is not free")
    if 0.0 in scene.record.stress:
        return no("every term is zero at the loaded end")
    return answer if scene.load.shape == "sine" else no("the load is not a sine")


def solve(scene: Scene, n_terms: int = 2000) -> xr.Dataset:
    """Return stress, velocity and displacement of the series after `n_terms` terms."""
    p, load, times = calibrate(scene), load_history(scene), sample_times(scene)
    assert isinstance(load, Sine)
    length, speed, record = scene.pillar.length, p.bar_speed, scene.record
    stress = np.zeros((len(record.stress), len(times)))
    velocity, displacement = np.zeros((2, len(record.velocity), len(times)))
    turn = np.exp(1j * pi * speed / length * np.maximum(times, 0.0))
    turned = np.ones_like(turn)
    for n in range(1, n_terms + 1):
        # Powers by products, which lose a unit of round-off each: few before they start afresh.
        turned = turned * turn if n % 32 else turn**n
        wave, (g, rate) = n * pi / length, amplitude(n * pi * speed / length, load, times, turned)
        stress += 2 * speed / length * np.outer(np.sin(wave * np.array(record.stress)), g)
        shape = 2 / (p.density * length) * np.cos(wave * np.array(record.velocity))
        velocity += np.outer(shape, rate)
        displacement += np.outer(shape, g / (wave * speed))
    rigid_velocity, rigid_displacement = rigid(load, times)
    velocity += rigid_velocity / (p.density * length)
    displacement += rigid_displacement / (p.density * length)
    found = {
        "stress": stress + static_stress(scene),
        "velocity": velocity,
        "displacement": displacement,
    }
    errors = _left_out(found, images.solve(scene), scene.load.scale)
    return dataset(scene, SOLVER.name, times, **found, errors=errors, terms=n_terms)


def _left_out(found: dict, exact: xr.Dataset, scale: float) -> dict[str, np.ndarray]:
    """Return the root-mean-square errors of waveforms by the closed form, with its round-off."""
    errors = {}
    for name, waves in found.items():
        closed = exact[name].values.reshape(waves.shape) / scale
        off = np.sqrt(np.mean((waves - closed) ** 2, axis=1))
        errors[name] = off + ROUND_OFF * np.abs(closed).max(axis=1, initial=0.0)
    return errors


def amplitude(
    mode: float, load: Sine, times: np.ndarray, turned: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return g_n p0 (Pa s) and its rate over omega_n (Pa s) at `times` for the mode (rad/s).

    turned : e^{i mode t}, t the time since the start.
    """
    omega, end, t = 2 * pi / load.period, load.end, np.maximum(times, 0.0)
    on = t < end
    if abs(mode - omega) < NEAR * omega:
        g = np.where(
            on, np.sin(omega * t) / omega - t * np.cos(omega * t), -end * np.cos(omega * t)
        )
        rate = np.where(on, t, end) * np.sin(omega * t)
        return load.amplitude * g / 2, load.amplitude * rate / 2
    sine, cosine = turned.imag, turned.real
    # sin(m t) - sin(m (t - end)) by angle addition, likewise the cosines.
    c, s = cos(mode * end), sin(mode * end)
    g, rate = sine - (sine * c - cosine * s), cosine - (cosine * c + sine * s)
    g[on] = sine[on] - mode / omega * np.sin(omega * t[on])
    rate[on] = cosine[on] - np.cos(omega * t[on])
    factor = load.amplitude * omega / (omega**2 - mode**2)
    return factor * g, factor * rate


def rigid(load: Sine, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the first and second time integrals of the load (Pa s, Pa s2)."""
    omega, t = 2 * pi / load.period, np.clip(times, 0.0, load.end)
    return load.impulse(times), load.amplitude / omega * (t - np.sin(omega * t) / omega)


SOLVER = Solver(
    name="series",
    rock=Rock.HOMOGENISED,
    words=Words(BAR, "homogenised bar, series", "等效杆（级数解）"),
    line=thin("#b0307e", 4, (16, 18), (12, 3)),
    applies=applies,
    run=solve,
    arguments=("n_terms",),
)
