"""Linear slip weakening: friction of faces in compression falls with their accumulated slip S:

    mu(S) = mu_s - (mu_s - mu_d) S / D   for S < D,   mu_d beyond

(Ida, J. Geophys. Res. 77, 1972; Andrews, J. Geophys. Res. 81, 1976). Slip in any direction counts.

A step whose trial traction T* exceeds the strength tau(S) slides by l until spring and dashpot
carry the strength that is left. With a = K_s + C_s / dt and h = t_n (mu_s - mu_d) / D

    T* - a l = tau(S) - h l,   l = (T* - tau(S)) / (a - h),

or, if S + l is beyond D, until they carry tau(D). If a <= h, friction falls faster than the joint
unloads, and drops to mu_d within the step.
"""

from jointwave.joints.formula import formula


@formula
def friction_left(law, parts, t_n, path):
    """Return tan(phi) under t_n (Pa) after a path (m); the static value without compression."""
    if not parts.weakening:
        return law.friction
    share = 1.0 - path / law.weakening_distance
    share = share if share > 0.0 else 0.0
    left = law.dynamic_friction + (law.friction - law.dynamic_friction) * share
    return left if t_n > 0.0 else law.friction


@formula
def strength_fall(law, t_n, path):
    """Return h (Pa/m), the loss of strength per slip at this path (m): zero beyond D."""
    pressed = t_n if t_n > 0.0 and path < law.weakening_distance else 0.0
    return pressed * (law.friction - law.dynamic_friction) / law.weakening_distance


@formula
def weakened(law, t_n, path, tau, size, stiffness):
    """Return the strength (Pa) and the path (m) after a step.

    path, tau : m and Pa, before the step. size, stiffness : |T*|, Pa, and a, Pa/m.
    """
    fall, left = strength_fall(law, t_n, path), law.weakening_distance - path
    left = left if left > 0.0 else 0.0
    excess = size - tau if size > tau else 0.0
    lost = excess / (stiffness - fall) if stiffness > fall else left
    lost = lost if lost < left else left
    after = tau - fall * lost if excess > 0.0 else tau
    return after, path + (excess + tau - after) / stiffness
