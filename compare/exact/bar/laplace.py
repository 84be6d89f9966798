"""A bar with any joints, layers and ends, in the Laplace variable s = sigma + i omega: what
`jointed_bar` and `equivalent_bar` share.

Rock of modulus E (1 + s eta) has impedance z = sqrt(rho E (1 + s eta)); an interface of
compliance 1/K and time constant eta_j lets the velocity jump by s sigma / (K (1 + s eta_j)). The
reflection coefficient of stress R = (Z - z)/(Z + z), Z the impedance seen towards the far end, is
marched from there (the matrix that carries (v, sigma) from one end overflows):

    segment of length h:  R_left = R_right e^{-2q},  q = s rho h / z,  wave a_right = a_left e^{-q}
    interface:            R_left = (2R - x(1 + R)) / (2 + x(1 + R)),  x = s z / (K (1 + s eta_j)),
                          a_right = 2 a_left / (2 + x(1 + R_right))
    to rock of another Z: R_left = (Z(1 + R) - z(1 - R) - x Z(1 + R)) / D, a_right = 2 z a_left / D,
                          D = Z(1 + R) + z(1 - R) + x Z(1 + R)
    far end:              R = -1 free, (Z - z)/(Z + z) behind a dashpot Z, 1 fixed

The end stress f enters as a = f / (z(1 + R) + Z_start(1 - R)); then sigma = z a (1 + R) and
v = a (1 - R). These are the impedance recursions of Brekhovskikh (Waves in Layered Media, 1980)
with the joint of Schoenberg (JASA 68, 1980).

Inversion by FFT with an exponential window (Wilcox, Int. J. Elect. Eng. Educ. 15, 1978; Kausel &
Roesset, JEM 118, 1992). Its errors, and what bounds them:
- A window of TAIL durations wraps what comes later, reduced to WRAPPED of itself, and multiplies
  round-off by as much as it lets the end of the record grow.
- The load's transform is that of its exact means over the fine steps, over the transform of such a
  step: no digit is lost to the sampling but at the highest frequencies.
- Frequencies end at pi/dt, rounded off by exp(-36 (omega dt/pi)^8) so that no ringing grows under
  the window. What is smooth stays; a kink is off by its change of slope times dt/(0.61 pi^2).
  The steps are finer than they need be, as far as that costs little, and undamped rock carries
  kinks and jumps of the load to and fro in front of its first joint, which returns them as a free
  end does: this part is summed as `images`, and the rest, smoother by one order, is inverted.
The inversion by half of the frequencies, which is off by twice as much or more, tells the error:
twice the most that the two differ by within some fine steps of each sample.
"""

from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import groupby
from math import ceil, log
from typing import NamedTuple

import numpy as np
import xarray as xr

from cases.histories import LoadHistory, Recorded, Step
from cases.loads import load_history
from cases.material.calibrate import Properties
from cases.sampling import sample_times
from cases.schema.scene import Scene
from cases.size import require
from compare.exact.bar.images import images
from compare.exact.conditions import static_stress
from results.dataset import dataset

TAIL = 1.5
WRAPPED = 1e-10
STEPS_PER_PERIOD = 1600
STEPS_PER_DURATION = 20_000  # where the load has no period
FINER = 4  # times, at most: shipped scenes are within 1e-7 of their peaks
CHEAP = 12_000_000  # instants times nodes, about half a second
MOST_TRIPS = 5000  # of the part in front of the first joint, to and fro
SAFETY = 2.0  # on the difference of the two inversions
NEAR = 17  # fine steps in which it is sought
FLOOR = 4e-9  # of a quantity's peak: the window's wrapping and the round-off that it raises


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


class RockFrom(NamedTuple):
    """The rock of a bar from y (m) on: density (kg/m3), modulus (Pa), Kelvin-Voigt eta (s)."""

    y: float
    density: float
    modulus: float
    time_constant: float

    def impedance(self, s: np.ndarray) -> np.ndarray:
        """Return sqrt(rho E (1 + s eta)) at the Laplace variables s, Pa s/m."""
        return np.sqrt(self.density * self.modulus * (1 + s * self.time_constant))


def rocks(p: Properties, moduli: list[float]) -> tuple[RockFrom, ...]:
    """Return the rocks behind the first of a pillar whose segments have these moduli (Pa)."""
    starts = np.cumsum([one.block_count * one.spacing for one in p.each])
    return tuple(
        RockFrom(float(y), one.density, modulus, one.time_constant or 0.0)
        for y, one, modulus in zip(starts[:-1], p.each[1:], moduli[1:], strict=True)
    )


@dataclass(frozen=True)
class Bar:
    """A bar with interfaces.

    Attributes
    ----------
    length, density, modulus : m, kg/m3, Pa.
    time_constant : Kelvin-Voigt eta of the rock, s.
    rocks : other rocks behind the first, in order.
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
    rocks: tuple[RockFrom, ...] = ()

    @property
    def every(self) -> tuple[RockFrom, ...]:
        """All its rocks, in order."""
        return (RockFrom(0.0, self.density, self.modulus, self.time_constant), *self.rocks)


def solved(scene: Scene, name: str, bar: Bar) -> xr.Dataset:
    """Return stress, velocity and displacement of a bar under the scene's load."""
    times, record = sample_times(scene), scene.record
    places = record.stress, record.velocity
    found, bounds = bounded(bar, load_history(scene), times, *places, scene.load.time_scale)
    found[0] = found[0] + static_stress(scene)
    errors = dict(zip(("stress", "velocity", "displacement"), bounds, strict=True))
    return dataset(scene, name, times, *found, errors=errors)


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
    (stress, velocity, displacement), _ = bounded(bar, load, times, stress_y, velocity_y, period)
    return stress, velocity, displacement


def bounded(
    bar: Bar,
    load: LoadHistory,
    times: np.ndarray,
    stress_y: list[float],
    velocity_y: list[float],
    period: float | None = None,
) -> tuple[list[np.ndarray], list[np.ndarray]]:
    """Return what `response` does, and bounds of its root-mean-square errors [receivers]."""
    from scipy.ndimage import maximum_filter1d

    places, front = np.array([*stress_y, *velocity_y]), _front(bar, times[-1])
    dt, stride, count = _fine_step(times, period, len(_nodes(bar, places)[0]) + 4 * len(places))
    require(8.0 * count * (10 + 6 * len(places)), f"{count:,} instants of the load")
    decay = -log(WRAPPED) / (count * dt)
    t = dt * np.arange(count)
    s = decay + 2j * np.pi * np.fft.rfftfreq(count, dt)
    fraction, load_transform = s.imag * dt / np.pi, _transform(load, s, t, decay)
    entering = [load_transform * _rounding(share * fraction) for share in (1, 2)]
    sigma, v = transfer(bar, s, places)
    shares = np.zeros(len(places)) if front is None else front.shares(places)
    sharp = [np.zeros((len(y), len(times))) for y in (stress_y, velocity_y, velocity_y)]
    if front is not None:
        ahead = shares > 0
        sigma[ahead], v[ahead] = (
            x[ahead] - shares[ahead, None] * part
            for x, part in zip((sigma, v), transfer(front.bar, s, places[ahead]), strict=True)
        )
        sharp = front.waves(load, times, stress_y, velocity_y)
    n, growth = len(stress_y), np.exp(decay * dt * stride * np.arange(len(times)))
    found, bounds = [], []
    for part, x in zip(sharp, (sigma[:n], v[n:], v[n:] / s), strict=True):
        both = [np.fft.irfft(x * one, count) for one in entering]
        keep = slice(0, stride * len(times), stride)
        smooth = both[0][:, keep] * growth
        near = maximum_filter1d(np.abs(both[1] - both[0]), NEAR, axis=1)[:, keep] * growth
        off = np.sqrt(np.mean(near**2, axis=1))
        peak = max(np.abs(part).max(initial=0.0), np.abs(smooth).max(initial=0.0))
        found.append(part + smooth)
        bounds.append(SAFETY * off + FLOOR * peak)
    return found, bounds


def _transform(load: LoadHistory, s: np.ndarray, t: np.ndarray, decay: float) -> np.ndarray:
    """Return the load's transform over the fine step, from its means there but for its jumps."""
    dt, jumps = t[1], _jumps(load)
    edges = np.append(t, t[-1] + dt) - dt / 2
    impulse = load.impulse(edges)
    for at, jump in jumps:
        impulse = impulse - jump * np.maximum(edges - at, 0.0)
    step = np.sinh(s * dt / 2) / (s * dt / 2)
    found = np.fft.rfft(np.diff(impulse) / dt * np.exp(-decay * t)) / step
    for at, jump in jumps:
        found += jump * np.exp(-s * at) / (s * dt)
    return found


def _jumps(load: LoadHistory) -> list[tuple[float, float]]:
    """Return when (s) and by how much (Pa) a load jumps."""
    if isinstance(load, Step):
        return [(0.0, load.amplitude)]
    if isinstance(load, Recorded):
        ends = (load.time[0], load.stress[0]), (load.time[-1], -load.stress[-1])
        return [(float(at), float(jump)) for at, jump in ends if jump]
    return []


class Front(NamedTuple):
    """The undamped rock in front of the first joint, `bar`, whose ends return what is sharp.

    start, end : their reflection coefficients of stress. enters : the share of the end stress that
    enters. interface : whether it ends at a joint, not with the whole bar.
    """

    bar: Bar
    start: float
    end: float
    enters: float
    interface: bool

    def shares(self, places: np.ndarray) -> np.ndarray:
        """Return how much of its motion each place takes part in: on a joint, half."""
        off = (places - self.bar.length) / self.bar.length
        on = 0.5 if self.interface else 1.0
        return np.where(np.abs(off) < 1e-9, on, np.where(off < 0, 1.0, 0.0))

    def waves(
        self, load: LoadHistory, times: np.ndarray, stress_y: list[float], velocity_y: list[float]
    ) -> list[np.ndarray]:
        """Return its stress, velocity and displacement [receivers, n]."""
        rock = self.bar
        z = np.sqrt(rock.density * rock.modulus)
        found = []
        for signal, places, sign, scale in (
            (load.value, stress_y, 1, 1.0),
            (load.value, velocity_y, -1, z),
            (load.impulse, velocity_y, -1, z),
        ):
            y, out = np.array(places), np.zeros((len(places), len(times)))
            shares = self.shares(y)
            ahead = shares > 0
            there, back = images(
                signal, y[ahead], times, rock.length, z / rock.density, self.start, self.end
            )
            out[ahead] = shares[ahead, None] * self.enters / scale * (there + sign * back)
            found.append(out)
        return found


def _front(bar: Bar, duration: float) -> Front | None:
    """Return the part of a bar that kinks of the load run to and fro in; None without one."""
    if bar.time_constant:
        return None
    z = np.sqrt(bar.density * bar.modulus)
    joints = np.flatnonzero(bar.joint_compliance)
    length, far = bar.length, bar.end
    if len(joints):
        if bar.joint_time_constant[joints].any():
            return None
        length, far = float(bar.joint_y[joints[0]]), End(0.0)
    if bar.rocks and bar.rocks[0].y < length * (1 - 1e-9):
        behind = bar.rocks[0]
        stiff = np.inf if behind.time_constant else np.sqrt(behind.density * behind.modulus)
        length, far = behind.y, End(stiff)
    if duration * z / bar.density > 2 * length * MOST_TRIPS:
        return None
    near, far = (End(0.0) if end.compliance else end for end in (bar.start, far))
    none = np.zeros(0)
    rock = replace(
        bar,
        length=length,
        joint_y=none,
        joint_compliance=none,
        joint_time_constant=none,
        start=near,
        end=far,
        rocks=(),
    )
    start, end = (
        1.0 if np.isinf(e.dashpot) else (e.dashpot - z) / (e.dashpot + z) for e in (near, far)
    )
    return Front(rock, start, end, z / (z + near.dashpot), length < bar.length)


def _fine_step(times: np.ndarray, period: float | None, nodes: int) -> tuple[float, int, int]:
    """Return the fine step (s), steps per sample, and steps in the window.

    nodes : that each instant costs.
    """
    from scipy.fft import next_fast_len

    interval, duration = times[1] - times[0], times[-1]
    longest = duration / STEPS_PER_DURATION
    if period is not None:
        longest = period / STEPS_PER_PERIOD
    stride = ceil(interval / longest * (1 - 1e-9))
    stride *= max(1, min(FINER, int(CHEAP / (TAIL * stride * len(times) * nodes))))
    count = ceil(TAIL * stride * len(times))
    return interval / stride, stride, 2 * next_fast_len(ceil(count / 2))


def _rounding(fraction: np.ndarray) -> np.ndarray:
    """Return the filter at these fractions of the highest frequency (order 8, 1e-16 there)."""
    return np.exp(-36 * np.minimum(fraction, 1.5) ** 8)


class Cell(NamedTuple):
    """A part of a bar between two places: reflection from its near and its far side, and the
    waves that pass to the far side, and back, arrays of Laplace variables."""

    near: np.ndarray
    far: np.ndarray
    passed: np.ndarray
    back: np.ndarray

    def before(self, R: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the reflection with R behind it, and the wave that then reaches R."""
        share = self.passed / (1 - self.far * R)
        return self.near + self.back * share * R, share

    def twice(self) -> "Cell":
        """Return two such parts of one rock in a row."""
        near, share = self.before(self.near)
        passed = share * self.passed
        return Cell(near, self.far + self.passed * share * self.far, passed, passed)


def transfer(bar: Bar, s: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return stress and velocity [places, len(s)] at `places` (m) for an end stress of 1.

    s : complex array of Laplace variables, 1/s, with positive real parts. Equal joints at equal
    spacings with no place among them are passed by doubling.
    """
    every = bar.every
    zs = [rock.impedance(s) for rock in every]
    slowness = [s * rock.density / z for rock, z in zip(every, zs, strict=True)]
    R = _end_reflection(bar.end, s, zs[-1])
    stress, velocity = np.zeros((2, len(places), len(s)), dtype=complex)
    passed = np.zeros(len(places), dtype=bool)
    nodes, joint_of = _nodes(bar, places)

    @lru_cache(16)  # of joints that all differ, some
    def cell(kind: Kind, doublings: int) -> Cell:
        if doublings:
            return cell(kind, doublings - 1).twice()
        z, q = zs[kind.rock], np.exp(-kind.h * slowness[kind.rock])
        x = s * z * kind.compliance / (1 + s * kind.time_constant)
        if kind.rock == kind.behind:
            return Cell(-x / (2 + x) * q**2, -x / (2 + x), 2 / (2 + x) * q, 2 / (2 + x) * q)
        Z = zs[kind.behind]
        off, whole = Z - z, Z + z + x * Z
        near, far = (off - x * Z) / whole, (-off - x * Z) / whole
        return Cell(near * q**2, far, 2 * z / whole * q, 2 * Z / whole * q)

    for members in _runs(bar, nodes, joint_of, places):
        i, kind = members[0]
        here = np.abs(places - nodes[i]) < 1e-9 * bar.length
        if here.any():
            stress[here], velocity[here] = zs[kind.behind] * (1 + R), 1 - R
            if kind.compliance or kind.rock != kind.behind:
                R, share = cell(kind._replace(h=0.0), 0).before(R)
                stress[passed | here] *= share
                velocity[passed | here] *= share
                velocity[here] = (velocity[here] + 1 - R) / 2
                kind = Kind(0.0, 0.0, kind.h, kind.rock, kind.rock)
            passed |= here
        for doublings in range(len(members).bit_length()):
            if len(members) >> doublings & 1:
                R, share = cell(kind, doublings).before(R)
                stress[passed] *= share
                velocity[passed] *= share
    entering = 1 / (zs[0] * (1 + R) + bar.start.impedance(s) * (1 - R))
    return stress * entering, velocity * entering


class Kind(NamedTuple):
    """A joint, or none, and the rock from it to the node before: m/Pa, s, m, and the number of
    that rock and of the one behind."""

    compliance: float
    time_constant: float
    h: float
    rock: int
    behind: int


def _runs(bar: Bar, nodes: np.ndarray, joint_of: dict[int, int], places: np.ndarray) -> list[list]:
    """Return the nodes with their kinds from the far end on, alike ones together; those with a
    place are alone."""
    held = (np.abs(places[:, None] - nodes) < 1e-9 * bar.length).any(axis=0)
    h = np.append(0.0, np.diff(nodes)).round(12)
    starts, close = [rock.y for rock in bar.rocks], 1e-9 * bar.length
    before, behind = (np.searchsorted(starts, nodes + off) for off in (-close, close))
    kinds = []
    for i in range(len(nodes) - 1, -1, -1):
        j = joint_of.get(i)
        C, eta = (0.0, 0.0) if j is None else (bar.joint_compliance[j], bar.joint_time_constant[j])
        rocks = int(before[i]), int(behind[i])
        kinds.append((i, Kind(float(C), float(eta), float(h[i]), *rocks)))
    runs = groupby(kinds, key=lambda one: (one[1], one[0] if held[one[0]] else -1))
    return [list(members) for _, members in runs]


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
    for rock in bar.rocks:
        if np.abs(nodes - rock.y).min() > 1e-9 * bar.length:
            nodes = np.insert(nodes, np.searchsorted(nodes, rock.y), rock.y)
    return nodes, dict(zip(np.searchsorted(nodes, own).tolist(), joints.tolist(), strict=True))
