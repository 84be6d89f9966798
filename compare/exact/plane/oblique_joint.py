"""P and SV waves at one linear-slip joint at any angle between two half-spaces.

Traction is continuous, [u_n] = tau_n / K_n and [u_s] = tau_s / K_s (Schoenberg, JASA 68, 1980);
dashpots take K to K - i omega eta. Axes, polarisations and signs are those of `waves`: waves come
along +n, reflections leave along -n. Between equal half-spaces the mirror symmetry about the joint
splits the 4 x 4 system: with equal waves from both sides no shear stress acts and the joint opens
(r), with opposite ones no normal stress acts and it slides (q), R = (r + q)/2, T = (r - q)/2. For
P, with C = cos 2 phi,
S = sin 2 phi, X = 2 s c,

    opening:  X (1 - r_p) - C r_s = 0
              i omega (Z_p C (1 + r_p) - Z_s S r_s) = -2 K_n (c (1 - r_p) + s r_s)
    sliding:  Z_p C (1 + q_p) - Z_s S q_s = 0
              i omega Z_s (X (1 - q_p) - C q_s) = -2 K_s (a' (1 + q_p) + k q_s)

and the same with the columns of SV. Amplitudes are those of particle velocity. Valid for every
angle below 90 degrees and every K from 0 (free faces) to inf (none).

Between unlike half-spaces the sum and the difference d +- u of the waves before the joint follow
from those, t, behind it: continuity of normal stress and the jump of velocity along the joint give
d + u = P t, that of shear stress and the jump across it d - u = M t, so that T = 2 (P + M)^-1 and
R = (P - M) T / 2, for every K above 0. K = inf is a welded contact (Zoeppritz 1919; Aki & Richards,
Quantitative Seismology, 2002, section 5.2.4).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from jointwave.cases.material.rock import ElasticRock, Values
from jointwave.compare.exact.plane.pulse import Axes, Layers
from jointwave.compare.exact.plane.waves import KINDS, Kind, face, is_evanescent, solve_pair


@dataclass(frozen=True)
class Joint:
    """A joint: stiffnesses (Pa/m, 0 to inf) and viscosities (Pa s/m), or arrays of them."""

    normal_stiffness: Values
    shear_stiffness: Values
    normal_viscosity: Values = 0.0
    shear_viscosity: Values = 0.0


class Coefficients(NamedTuple):
    """Complex amplitudes of particle velocity, relative to the incident wave."""

    R_p: np.ndarray
    R_s: np.ndarray
    T_p: np.ndarray
    T_s: np.ndarray


def picked(R: np.ndarray, T: np.ndarray, incidence: Kind) -> Coefficients:
    """Return the column of one incidence of matrices [..., out, in]."""
    i = KINDS.index(incidence)
    return Coefficients(R[..., 0, i], R[..., 1, i], T[..., 0, i], T[..., 1, i])


def scattering(
    rock: ElasticRock,
    joint: Joint,
    slowness: Values,
    omega: Values,
    behind: ElasticRock | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the matrices R and T, complex arrays [..., out, in] in the order P, SV.

    slowness : p along the joint, s/m, below 1/a for travelling P waves and below 1/b for SV.
    behind : the rock beyond the joint (default: the same).
    """
    if behind is not None and behind != rock:
        return _between(rock, behind, joint, slowness, omega)
    w = face(rock, slowness)
    normal, opening = _weighed(w.normal, w.normal_velocity, rock.p_impedance, omega, joint, 0)
    shear, sliding = _weighed(w.shear, w.shear_velocity, rock.s_impedance, omega, joint, 1)
    r = solve_pair((w.shear, normal - opening), (w.shear, -normal - opening))
    q = solve_pair((w.normal, shear - sliding), (-w.normal, shear + sliding))
    return (r + q) / 2, (r - q) / 2


def _between(
    rock: ElasticRock, behind: ElasticRock, joint: Joint, slowness: Values, omega: Values
) -> tuple[np.ndarray, np.ndarray]:
    here, there = face(rock, slowness), face(behind, slowness)
    x_n, x_s = _softness(joint, omega)
    side = there.shear_velocity + x_s[..., None] * there.shear
    P = _solved(here.normal, here.shear_velocity, there.normal, side)
    side = there.normal_velocity + x_n[..., None] * there.normal
    M = _solved(here.shear, here.normal_velocity, there.shear, side)
    both = P + M
    identity = np.broadcast_to(np.eye(2), both.shape)
    T = 2 * _solved(both[..., 0, :], both[..., 1, :], identity[..., 0, :], identity[..., 1, :])
    return (P - M) @ T / 2, T


def _softness(joint: Joint, omega: Values) -> list[np.ndarray]:
    """Return i omega / (K - i omega eta), velocity jump per traction (m/s/Pa), normal and shear."""
    found = []
    for K, eta in (
        (joint.normal_stiffness, joint.normal_viscosity),
        (joint.shear_stiffness, joint.shear_viscosity),
    ):
        rigid = np.isinf(K)
        resists = np.where(rigid, 1.0, K) - 1j * np.multiply(omega, eta)
        found.append(np.where(rigid, 0.0, 1j * np.asarray(omega) / resists))
    return found


def _solved(one, two, left, right) -> np.ndarray:
    """Return the matrices A of d = A t where rows one . d = left . t and two . d = right . t."""
    rows = np.broadcast_arrays(one, two, left, right)
    return solve_pair((rows[0], rows[1]), (rows[2], rows[3]))


def _weighed(traction, velocity, impedance, omega, joint, axis) -> tuple[np.ndarray, np.ndarray]:
    """Return the two terms of -i omega traction = 2 K velocity, over 2 K - i omega Z."""
    K = (joint.normal_stiffness, joint.shear_stiffness)[axis]
    eta = (joint.normal_viscosity, joint.shear_viscosity)[axis]
    rigid = np.isinf(K)
    K = np.where(rigid, 1.0, K) - 1j * np.multiply(omega, eta)
    inertia = -1j * np.multiply(omega, impedance)
    soft = np.where(rigid, 0, inertia / (inertia + 2 * K))
    return (soft / impedance)[..., None] * traction, (1 - soft)[..., None] * velocity


def layers_at_once(rocks: Sequence[ElasticRock], first: Joint, axes: Axes) -> Layers:
    """Return the reflection and transmission without delay at the first joint between layers of
    these rocks: the limit of high frequencies, in which springs do not act. Where P is evanescent
    only the incident wave is real.
    """
    down, up = np.zeros((2, len(rocks), 2))
    down[0] = axes.incident
    if not is_evanescent(rocks[0], axes.slowness):
        bare = without_springs(first)
        acts = bool(bare.normal_stiffness or bare.normal_viscosity)
        behind = rocks[1] if acts else rocks[0]
        R, T = scattering(rocks[0], bare, axes.slowness, 1.0, behind)
        up[0], down[1] = (R @ axes.incident).real, (T @ axes.incident).real
    return Layers(down, up)


def without_springs(joint: Joint) -> Joint:
    """Return a joint with its dashpots only; infinite stiffness is kept."""
    K_n, K_s = (
        np.where(np.isinf(K), K, 0.0) for K in (joint.normal_stiffness, joint.shear_stiffness)
    )
    return Joint(K_n, K_s, joint.normal_viscosity, joint.shear_viscosity)
