"""Dilation: sliding faces ride over each other's asperities and wear them.

The opening w grows with the slip path S of closed faces at the dilation angle psi, whose tangent
falls linearly to zero over the distance D_w:

    w'(S) = tan(psi) (1 - S / D_w),   w(S) = tan(psi) (S - S^2 / (2 D_w))   for S < D_w,

and stays at tan(psi) D_w / 2 beyond (in 3DEC and UDEC the angle drops to zero at a critical slip).
The joint's spring sees the gap less w: between confined faces, slip raises the normal stress. Of
the work of the strength tau over the slip, the part t_n w' goes into the rock and the springs; the
rest is dissipated, and is not negative if tan(psi) is at most the friction.
"""

import numpy as np

from jointwave.joints.formula import formula


@formula
def lift(law, path):
    """Return w (m) after a path of slip (m)."""
    way = path if path < law.dilation_distance else law.dilation_distance
    return law.dilation * way * (1.0 - 0.5 * way / law.dilation_distance)


@formula
def lift_rate(law, path):
    """Return dw/dS after a path of slip (m)."""
    share = 1.0 - path / law.dilation_distance
    return law.dilation * share if share > 0.0 else 0.0


def riding_stiffness(dilation, friction, normal, shear):
    """Return K_n and K_s (Pa/m), numbers or arrays, for the critical step of a dilatant joint.

    A slip ds under tan(phi) adds K_n tan(psi) ds to the normal traction and tan(phi) times that
    along the joint. With the K_n of the gap this is a matrix of rank one, whose only eigenvalue for
    masses m_n and m_s is K_n (1/m_n + k / m_s), k = tan(phi) tan(psi). With r = sqrt(k), springs of
    K_n (1 + r) and K_n r (1 + r) have an eigenvalue of at least this, for any masses.
    """
    r = np.sqrt(dilation * friction)
    return normal * (1 + r), np.where(r > 0, np.maximum(shear, normal * r * (1 + r)), shear)
