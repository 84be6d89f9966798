"""A bar with any joints, layers and ends, in the Laplace variable s = sigma + i omega: what
`jointed_bar` and `equivalent_bar` share.

Rock of modulus E (1 + s eta) has impedance z = sqrt(rho E (1 + s eta)); an interface of
compliance 1/K and time constant eta_j lets the velocity jump by s sigma / (K (1 + s eta_j)). The
reflection coefficient of stress R = (Z - z)/(Z + z), Z the impedance seen towards the far end, is
marched from there (the matrix that carries (v, sigma) from one end overflows):

    segment of length h:  R_left = R_right e^{-2q},  q = s rho h / z,  wave a_right = a_left e^{-q}
    interface:            R_left = (2R - x(1 + R)) / (2 + x(1 + R)),  x = s z / (K (1 + s eta_j)),
                          a_right = 2 a_left / (2 + x(1 + R_right))
    far end:              R = -1 free, (Z - z)/(Z + z) behind a dashpot Z, 1 fixed

The end stress f enters as a = f / (z(1 + R) + Z_start(1 - R)); then sigma = z a (1 + R) and
v = a (1 - R). These are the impedance recursions of Brekhovskikh (Waves in Layered Media, 1980)
with the joint of Schoenberg (JASA 68, 1980).

Inversion by FFT with an exponential window (Wilcox, Int. J. Elect. Eng. Educ. 15, 1978; Kausel &
Roesset, JEM 118, 1992). Its three errors and the rules that bound them:
- A window of TAIL durations wraps what comes later, reduced to WRAPPED of itself.
- The load enters as its exact mean over each fine step: (omega dt)^2 / 24, 6e-7 at the period.
- Frequencies end at pi/dt, rounded off by exp(-36 (omega dt/pi)^8) so that no ringing grows under
  the window. What is smooth stays; a kink is off by its change of slope times dt/(0.61 pi^2) (the
  spectrum 1/omega^2 above half the filter), at STEPS_PER_PERIOD 6.5e-4 of a sine's amplitude. With
  both kinks of a one-cycle sine on samples, 200 a period, that is 0.009 % in relative L2 at most.
  A jump (a step load on an undamped bar) is off by half of itself within one or two fine steps.
"""

from dataclasses import dataclass
from math import ceil, log

import numpy as np
import xarray as xr

from cases.loads import LoadHistory, load_history
from cases.result import dataset
from cases.sampling import sample_times
from cases.scene import Scene
from cases.size import require
from compare.exact.conditions import static_stress

TAIL = 1.5
WRAPPED = 1e-10
STEPS_PER_PERIOD = 1600
STEPS_PER_DURATION = 20_000  # where the load has no period


@dataclass(frozen=True)
class End:
    """A dashpot (Pa s/m; 0 free, inf fixed) behind a spring of compliance C (m/Pa) and eta (s)."""

    dashpot: float
    compliance: float = 0.0
    time_constant: float = 0.0

    def impedance(self, s: np.ndarray) -> np.ndarray:
        """Return Z / (1 + s Z C / (1 + s eta)) at the Laplace variables s, Pa s/m."""
        if self.compliance == 0:
            return np.full_like(s, self.dashpot)
        compliance = self.compliance / (1 + s * self.time_constant)
        return self.dashpot / (1 + s * self.dashpot * compliance)


def end_of(kind: str, impedance: float, compliance: float = 0.0, time_constant: float = 0.0) -> End:
    """Return the end of this kind; only a matched one has a spring in front of its dashpot."""
    if kind == "matched":
        return End(impedance, compliance, time_constant)
    return End({"free": 0.0, "fixed": np.inf, "quiet": impedance}[kind])


@dataclass(frozen=True)
class Bar:
    """A bar of one rock with interfaces.

    Attributes
    ----------
    length, density, modulus : m, kg/m3, Pa.
    time_constant : Kelvin-Voigt eta of the rock, s.
    joint_y, joint_compliance, joint_time_constant : float arrays [joints], sorted; m, m/Pa, s.
    start, end : what holds each end; the start cannot be fixed.
    """

    length: float
    density: float
    modulus: float
    time_constant: float
    joint_y: np.ndarray
    joint_compliance: np.ndarray
    joint_time_constant: np.ndarray
    start: End
    end: End


def solved(scene: Scene, name: str, bar: Bar) -> xr.Dataset:
    """Return stress, velocity and displacement of a bar under the scene's load."""
    times, record = sample_times(scene), scene.record
    load = load_history(scene)
    stress, *motion = response(bar, load, times, record.stress, record.velocity, scene.load.period)
    return dataset(scene, name, times, stress + static_stress(scene), *motion)


def response(
    bar: Bar,
    load: LoadHistory,
    times: np.ndarray,
    stress_y: list[float],
    velocity_y: list[float],
    period: float | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return stress (Pa), velocity (m/s) and displacement (m) [receivers, n] at `times`.

    `times` are equally spaced from 0; `period` (s) is that of the load, if it has one. The
    velocity on an interface is the mean of both sides.
    """
    dt, stride, count = _fine_step(times, period)
    places = np.array([*stress_y, *velocity_y])
    require(8.0 * count * (10 + 4 * len(places)), f"{count:,} instants of the load")
    decay = -log(WRAPPED) / (count * dt)
    t = dt * np.arange(count)
    mean = np.diff(load.impulse(dt * (np.arange(count + 1) - 0.5))) / dt
    s = decay + 2j * np.pi * np.fft.rfftfreq(count, dt)
    load_transform = np.fft.rfft(mean * np.exp(-decay * t)) * _rounding(s.imag * dt / np.pi)
    sigma, v = (x * load_transform for x in transfer(bar, s, places))
    transforms = [sigma[: len(stress_y)], v[len(stress_y) :], v[len(stress_y) :] / s]
    keep = slice(0, stride * len(times), stride)
    growth = np.exp(decay * t[keep])
    stress, velocity, displacement = (
        np.fft.irfft(x, count, axis=-1)[:, keep] * growth for x in transforms
    )
    return stress, velocity, displacement


def _fine_step(times: np.ndarray, period: float | None) -> tuple[float, int, int]:
    """Return the fine step (s), steps per sample, and steps in the window."""
    from scipy.fft import next_fast_len

    interval, duration = times[1] - times[0], times[-1]
    longest = duration / STEPS_PER_DURATION
    if period is not None:
        longest = period / STEPS_PER_PERIOD
    stride = ceil(interval / longest * (1 - 1e-9))
    count = ceil(TAIL * stride * len(times))
    return interval / stride, stride, 2 * next_fast_len(ceil(count / 2))


def _rounding(fraction: np.ndarray) -> np.ndarray:
    """Return the filter at these fractions of the highest frequency (order 8, 1e-16 there)."""
    return np.exp(-36 * fraction**8)


def transfer(bar: Bar, s: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return stress and velocity [places, len(s)] at `places` (m) for an end stress of 1.

    s : complex array of Laplace variables, 1/s, with positive real parts.
    """
    z = np.sqrt(bar.density * bar.modulus * (1 + s * bar.time_constant))
    slowness = s * bar.density / z
    R = _end_reflection(bar.end, s, z)
    stress, velocity = np.zeros((2, len(places), len(s)), dtype=complex)
    passed, decays = np.zeros(len(places), dtype=bool), {}
    nodes, joint_of = _nodes(bar, places)
    for i in range(len(nodes) - 1, -1, -1):
        here = np.abs(places - nodes[i]) < 1e-9 * bar.length
        stress[here], velocity[here] = z * (1 + R), 1 - R
        if (j := joint_of.get(i)) is not None:
            x = s * z * bar.joint_compliance[j] / (1 + s * bar.joint_time_constant[j])
            share = 2 / (2 + x * (1 + R))
            R = (R - x * (1 + R) / 2) * share
            stress[passed | here] *= share
            velocity[passed | here] *= share
            velocity[here] = (velocity[here] + 1 - R) / 2
        passed |= here
        if i == 0:
            break
        h = round(nodes[i] - nodes[i - 1], 12)
        if h not in decays:
            decays[h] = np.exp(-h * slowness)
        stress[passed] *= decays[h]
        velocity[passed] *= decays[h]
        R = R * decays[h] ** 2
    entering = 1 / (z * (1 + R) + bar.start.impedance(s) * (1 - R))
    return stress * entering, velocity * entering


def _end_reflection(end: End, s: np.ndarray, z: np.ndarray) -> np.ndarray:
    if np.isinf(end.dashpot):
        return np.ones_like(z)
    Z = end.impedance(s)
    return (Z - z) / (Z + z)


def _nodes(bar: Bar, places: np.ndarray) -> tuple[np.ndarray, dict[int, int]]:
    """Return the ends, interfaces and receivers in order, and which node holds which joint."""
    joints = np.flatnonzero(bar.joint_compliance)
    own = bar.joint_y[joints]
    near = np.abs(places[:, None] - np.concatenate([own, [0.0, bar.length]])).min(axis=1)
    apart = np.unique(places[near > 1e-9 * bar.length])
    nodes = np.sort(np.concatenate([[0.0, bar.length], own, apart]))
    return nodes, dict(zip(np.searchsorted(nodes, own).tolist(), joints.tolist(), strict=True))
