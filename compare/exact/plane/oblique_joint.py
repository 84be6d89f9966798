"""P, SV and SH waves at one linear-slip joint at any angle between half-spaces of any rock.

Traction is continuous, [u_n] = tau_n / K_n and [u_s] = tau_s / K_s (Schoenberg, JASA 68, 1980);
with dashpots K becomes K - i omega eta. Axes, polarisations and signs are those of `waves`: the
incident wave travels along +n, reflections along -n. With the traction (n, s) and the velocity (v,
u) of unit P and SV waves along +n before the joint, and primes for the rock behind it,

    n (1 + R) = n' T,   u (1 + R) = (u' + i omega s' / K_s) T,
    s (1 - R) = s' T,   v (1 - R) = (v' + i omega n' / K_n) T,

each equation with K divided by (K - i omega Z) / K. For SH waves, whose traction s and velocity u
are normal to the plane of incidence, the equations of u and s remain. Amplitudes are particle
velocities. Valid for every angle below 90 degrees and every K from 0 (free faces) to inf (welded;
Zoeppritz 1919, Aki & Richards, Quantitative Seismology, 2002, section 5.2.4).
"""

from dataclasses import dataclass

import numpy as np

from jointwave.cases.material.rock import ElasticRock, Values
from jointwave.compare.exact.plane.waves import KINDS, Kind, face


@dataclass(frozen=True)
class Joint:
    """A joint: stiffnesses (Pa/m, 0 to inf) and viscosities (Pa s/m), or arrays of them."""

    normal_stiffness: Values
    shear_stiffness: Values
    normal_viscosity: Values = 0.0
    shear_viscosity: Values = 0.0


def scattering(
    rock: ElasticRock,
    joint: Joint,
    slowness: Values,
    omega: Values,
    behind: ElasticRock | None = None,
    kinds: tuple[Kind, ...] = KINDS,
) -> tuple[np.ndarray, np.ndarray]:
    """Return the matrices R and T, complex arrays [..., out, in] in the order of kinds.

    slowness : p along the joint, s/m, below 1/a for travelling P waves and below 1/b for SV.
    behind : the rock beyond the joint (default: the same).
    """
    here, there = (face(one, slowness, kinds) for one in (rock, behind or rock))
    (moves_n, yields_n), (moves_s, yields_s) = (_weights(rock, joint, omega, k) for k in (0, 1))
    # Waves along +n and -n before the joint, and along +n behind it; tractions over Z_p.
    unit = np.asarray(rock.p_impedance)[..., None]
    n, s, n_behind, s_behind = (
        x / unit for x in (here.normal, here.shear, there.normal, there.shear)
    )
    u, v = moves_s * here.shear_velocity, moves_n * here.normal_velocity
    u_behind = moves_s * there.shear_velocity + yields_s * there.shear
    v_behind = moves_n * there.normal_velocity + yields_n * there.normal
    rows = *(n, n, n_behind), *(u, u, u_behind), *(s, -s, s_behind), *(v, -v, v_behind)
    each = np.broadcast_arrays(*(rows if kinds == KINDS else rows[3:9]))
    incident, back, on = (np.stack(each[k::3], axis=-2) for k in range(3))
    found = np.linalg.solve(np.concatenate([-back, on], axis=-1), incident)
    return found[..., : len(kinds), :], found[..., len(kinds) :, :]


def _weights(
    rock: ElasticRock, joint: Joint, omega: Values, axis: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return the factors [..., 1] of velocity and traction (m/s/Pa) normal to or along a joint."""
    K = (joint.normal_stiffness, joint.shear_stiffness)[axis]
    eta = (joint.normal_viscosity, joint.shear_viscosity)[axis]
    Z, rigid = (rock.p_impedance, rock.s_impedance)[axis], np.isinf(K)
    K = np.where(rigid, 1.0, K) - 1j * np.multiply(omega, eta)
    whole = K - 1j * np.multiply(omega, Z)
    moves = np.where(rigid, 1.0, K / whole)
    return moves[..., None], np.where(rigid, 0.0, 1j * np.asarray(omega) / whole)[..., None]
