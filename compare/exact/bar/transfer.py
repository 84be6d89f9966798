"""Motion of a bar with joints, layers and ends under a unit end stress, in the Laplace variable s =
sigma + i omega.

Rock of modulus E(s) (E (1 + s eta), or that of its relaxation mechanisms,
`cases.material.constant_q`) has impedance z = sqrt(rho E(s)); at an interface of compliance 1/K and
time constant eta_j the velocity jumps by s sigma / (K (1 + s eta_j)). The reflection coefficient of
stress R = (Z - z)/(Z + z), Z the impedance seen towards the far end, is computed from there
backwards (the matrix that carries (v, sigma) from one end overflows):

    segment of length h:  R_left = R_right e^{-2q},  q = s rho h / z,  wave a_right = a_left e^{-q}
    to rock of another Z: R_left = (p - z(1 - R) - x p) / D,  p = Z(1 + R),
    over an interface     D = p + z(1 - R) + x p,  x = s z / (K (1 + s eta_j)),
                          a_right = 2 z a_left / D
    far end:              R = -1 free, (Z - z)/(Z + z) behind a dashpot Z, 1 fixed

The end stress f enters as a = f / (z(1 + R) + Z_start(1 - R)); then sigma = z a (1 + R) and v = a
(1 - R). These are the impedance recursions of Brekhovskikh (Waves in Layered Media, 1980) with the
joint of Schoenberg (JASA 68, 1980).
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.material.calibrate import Properties

NEAR = 1e-9  # distance over a bar's length below which nodes coincide


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

    def reflection(self, s: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Return the reflection coefficient of stress at the end of rock of impedance z, Pa s/m."""
        Z = self.impedance(s)
        return np.ones_like(z) if np.isinf(self.dashpot) else (Z - z) / (Z + z)


def end_of(kind: str, impedance: float, compliance: float = 0.0, time_constant: float = 0.0) -> End:
    """Return the end of this kind; only a matched end has a spring in front of its dashpot."""
    if kind == "matched":
        return End(impedance, compliance, time_constant)
    return End({"free": 0.0, "fixed": np.inf, "quiet": impedance}[kind])


class RockFrom(NamedTuple):
    """The rock of a bar from y (m) on: density (kg/m3), modulus (Pa), Kelvin-Voigt eta (s), and
    relaxation mechanisms (`constant_q.Mechanisms`) of its modulus, or None."""

    y: float
    density: float
    modulus: float
    time_constant: float
    relaxation: Any = None

    def impedance(self, s: np.ndarray) -> np.ndarray:
        """Return sqrt(rho E(s)) at the Laplace variables s, Pa s/m."""
        modulus = self.modulus * (1 + s * self.time_constant)
        if self.relaxation is not None:
            modulus = modulus * self.relaxation.modulus(s)
        return np.sqrt(self.density * modulus)


def rocks(p: Properties, moduli: list[float], relaxation: Any) -> tuple[RockFrom, ...]:
    """Return the rocks of a pillar whose segments have these moduli (Pa); with relaxation
    mechanisms only joints have dashpots."""
    starts = np.cumsum([0.0, *(one.block_count * one.spacing for one in p.each)])
    etas = [one.time_constant or 0.0 if relaxation is None else 0.0 for one in p.each]
    return tuple(
        RockFrom(float(y), one.density, modulus, eta, relaxation)
        for y, one, modulus, eta in zip(starts[:-1], p.each, moduli, etas, strict=True)
    )


@dataclass(frozen=True)
class Bar:
    """A bar with interfaces.

    length : m.
    rocks : in order, the first from the start.
    joint_y, joint_compliance, joint_time_constant : float arrays [joints], sorted; m, m/Pa, s.
    start, end : supports of the ends; the start cannot be fixed.
    """

    length: float
    rocks: tuple[RockFrom, ...]
    joint_y: np.ndarray
    joint_compliance: np.ndarray
    joint_time_constant: np.ndarray
    start: End
    end: End

    @property
    def interfaces(self) -> np.ndarray:
        """Places (m), compliances (m/Pa) and time constants (s) of compliant joints [3, n]."""
        every = np.array([self.joint_y, self.joint_compliance, self.joint_time_constant])
        return every[:, every[1] != 0]


def transfer(bar: Bar, s: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return stress and velocity [places, len(s)] at `places` (m) for an end stress of 1.

    s : complex array of Laplace variables, 1/s, with positive real parts.
    """
    zs = [rock.impedance(s) for rock in bar.rocks]
    nodes, starts, close = nodes_of(bar, places), [y for y, *_ in bar.rocks[1:]], NEAR * bar.length
    lengths = np.diff(nodes, prepend=0.0).round(12)
    before, behind = (np.searchsorted(starts, nodes + off) for off in (-close, close))
    joints, compliances, etas = bar.interfaces
    joint_of = dict(zip(np.searchsorted(nodes, joints).tolist(), range(len(joints)), strict=True))

    @lru_cache(16)  # keeps memory small if all joints differ
    def jump(compliance: float, time_constant: float) -> np.ndarray:
        return s * compliance / (1 + s * time_constant)

    @lru_cache(16)
    def delay(rock: int, length: float) -> np.ndarray:
        return np.exp(-length * s * bar.rocks[rock].density / zs[rock])

    R = bar.end.reflection(s, zs[-1])
    stress, velocity = np.zeros((2, len(places), len(s)), dtype=complex)
    # Places from the far end on, each with the ratio of the wave at the next place to that here.
    reached: list[tuple[np.ndarray, np.ndarray]] = []
    passing = np.ones_like(R)
    for i in range(len(nodes) - 1, -1, -1):
        z, here, j = zs[before[i]], np.abs(places - nodes[i]) < close, joint_of.get(i)
        pressed, moved, share = zs[behind[i]] * (1 + R), 1 - R, 1.0
        if j is not None or before[i] != behind[i]:
            x = 0.0 if j is None else z * jump(compliances[j], etas[j])
            whole = (1 + x) * pressed + z * moved
            R, share = ((1 - x) * pressed - z * moved) / whole, 2 * z / whole
            passing = passing * share
        if here.any():
            stress[here], velocity[here] = share * pressed, (share * moved + 1 - R) / 2
            reached.append((here, passing))
            passing = np.ones_like(R)
        late = delay(before[i], lengths[i])
        R, passing = R * late**2, passing * late
    entering = passing / (zs[0] * (1 + R) + bar.start.impedance(s) * (1 - R))
    for here, beyond in reversed(reached):
        stress[here] *= entering
        velocity[here] *= entering
        entering = entering * beyond
    return stress, velocity


def nodes_of(bar: Bar, places: np.ndarray) -> np.ndarray:
    """Return the ends, interfaces and receivers in order, m."""
    found = [0.0, bar.length, *bar.interfaces[0]]
    for y in (*(rock.y for rock in bar.rocks[1:]), *places):
        if np.abs(np.array(found) - y).min() > NEAR * bar.length:
            found.append(y)
    return np.sort(found)
