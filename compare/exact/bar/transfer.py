"""The motion of a bar with any joints, layers and ends under an end stress of 1, in the Laplace
variable s = sigma + i omega.

Rock of modulus E(s), E (1 + s eta) or the modulus of its relaxation mechanisms
(`cases.material.constant_q`), has impedance z = sqrt(rho E(s)); an interface of
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
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.material.calibrate import Properties


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
    """The rock of a bar from y (m) on: density (kg/m3), modulus (Pa), Kelvin-Voigt eta (s), and the
    mechanisms (`constant_q.Mechanisms`) that make its modulus depend on the Laplace variable, None
    without."""

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
    """Return the rocks of a pillar whose segments have these moduli (Pa); in relaxing rock only
    joints have dashpots."""
    starts = np.cumsum([0.0, *(one.block_count * one.spacing for one in p.each)])
    etas = [one.time_constant or 0.0 if relaxation is None else 0.0 for one in p.each]
    return tuple(
        RockFrom(float(y), one.density, modulus, eta, relaxation)
        for y, one, modulus, eta in zip(starts[:-1], p.each, moduli, etas, strict=True)
    )


@dataclass(frozen=True)
class Bar:
    """A bar with interfaces.

    Attributes
    ----------
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


class Cell(NamedTuple):
    """A part of a bar between two places: reflection from its near and its far side, and
    transmission to the far side and back, arrays over the Laplace variables."""

    near: np.ndarray
    far: np.ndarray
    passed: np.ndarray
    back: np.ndarray

    def before(self, R: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the reflection with R behind this part, and the wave that then reaches R."""
        share = self.passed / (1 - self.far * R)
        return self.near + self.back * share * R, share


def transfer(bar: Bar, s: np.ndarray, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return stress and velocity [places, len(s)] at `places` (m) for an end stress of 1.

    s : complex array of Laplace variables, 1/s, with positive real parts.
    """
    zs = [rock.impedance(s) for rock in bar.rocks]
    slowness = [s * rock.density / z for rock, z in zip(bar.rocks, zs, strict=True)]
    z, Z = zs[-1], bar.end.impedance(s)
    R = np.ones_like(z) if np.isinf(bar.end.dashpot) else (Z - z) / (Z + z)
    stress, velocity = np.zeros((2, len(places), len(s)), dtype=complex)
    # Places from the far end on, each with the transmission from it to those farther on, and the
    # transmission to the last of them.
    reached: list[tuple[np.ndarray, np.ndarray]] = []
    passing = np.ones_like(R)
    nodes, joint_of = nodes_of(bar, places)

    @lru_cache(16)  # of joints that all differ, some
    def cell(kind: Kind) -> Cell:
        z, q = zs[kind.rock], np.exp(-kind.h * slowness[kind.rock])
        x = s * z * kind.compliance / (1 + s * kind.time_constant)
        if kind.rock == kind.behind:
            return Cell(-x / (2 + x) * q**2, -x / (2 + x), 2 / (2 + x) * q, 2 / (2 + x) * q)
        Z = zs[kind.behind]
        off, whole = Z - z, Z + z + x * Z
        near, far = (off - x * Z) / whole, (-off - x * Z) / whole
        return Cell(near * q**2, far, 2 * z / whole * q, 2 * Z / whole * q)

    for i, kind in _kinds(bar, nodes, joint_of):
        here = np.abs(places - nodes[i]) < 1e-9 * bar.length
        if here.any():
            stress[here], velocity[here] = zs[kind.behind] * (1 + R), 1 - R
            if kind.compliance or kind.rock != kind.behind:
                R, share = cell(kind._replace(h=0.0)).before(R)
                passing = passing * share
                stress[here] *= share
                velocity[here] = (velocity[here] * share + 1 - R) / 2
                kind = Kind(0.0, 0.0, kind.h, kind.rock, kind.rock)
            reached.append((here, passing))
            passing = np.ones_like(R)
        R, share = cell(kind).before(R)
        passing = passing * share
    entering = passing / (zs[0] * (1 + R) + bar.start.impedance(s) * (1 - R))
    for here, beyond in reversed(reached):
        stress[here] *= entering
        velocity[here] *= entering
        entering = entering * beyond
    return stress, velocity


class Kind(NamedTuple):
    """A joint, or none, and the rock from it to the previous node: m/Pa, s, m, and the numbers of
    that rock and of the one behind."""

    compliance: float
    time_constant: float
    h: float
    rock: int
    behind: int


def _kinds(bar: Bar, nodes: np.ndarray, joint_of: dict[int, int]) -> Iterator[tuple[int, Kind]]:
    """Yield the nodes with their kinds from the far end on."""
    h = np.append(0.0, np.diff(nodes)).round(12)
    starts, close = [rock.y for rock in bar.rocks[1:]], 1e-9 * bar.length
    before, behind = (np.searchsorted(starts, nodes + off) for off in (-close, close))
    for i in range(len(nodes) - 1, -1, -1):
        j = joint_of.get(i)
        C, eta = (0.0, 0.0) if j is None else (bar.joint_compliance[j], bar.joint_time_constant[j])
        rocks = int(before[i]), int(behind[i])
        yield i, Kind(float(C), float(eta), float(h[i]), *rocks)


def nodes_of(bar: Bar, places: np.ndarray) -> tuple[np.ndarray, dict[int, int]]:
    """Return the ends, interfaces and receivers in order, and the joints by node."""
    joints = np.flatnonzero(bar.joint_compliance)
    own = bar.joint_y[joints]
    near = np.abs(places[:, None] - np.concatenate([own, [0.0, bar.length]])).min(axis=1)
    apart = np.unique(places[near > 1e-9 * bar.length])
    nodes = np.sort(np.concatenate([[0.0, bar.length], own, apart]))
    for rock in bar.rocks[1:]:
        if np.abs(nodes - rock.y).min() > 1e-9 * bar.length:
            nodes = np.insert(nodes, np.searchsorted(nodes, rock.y), rock.y)
    return nodes, dict(zip(np.searchsorted(nodes, own).tolist(), joints.tolist(), strict=True))
