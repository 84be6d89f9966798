"""Relative motion of the two faces of a joint, for small rotations.

u and theta are a block's displacement and rotation, h half its thickness. At the centre of the
joint, right block less left block:

    g_x = u2_x - u1_x + h (theta2_z + theta1_z),   g_y = u2_y - u1_y,
    g_z = u2_z - u1_z - h (theta2_x + theta1_x),   phi = theta2 - theta1.

At the point (x, z) of the face the gap is g_y + phi_z x - phi_x z and the slip
(g_x + phi_y z, g_z - phi_y x). The same holds for velocities.
"""

from typing import Any, NamedTuple

from dem.spatial.layout import LANES as L
from dem.spatial.layout import STRIDE as R
from dem.spatial.layout import velocities
from numerics.jit import inlined
from numerics.optional import given


@inlined
def shift(s, at, i, arm):
    """Return the relative displacement (g_x, g_y, g_z) of joint i; `at` is its first row.

    arm : half the thickness, m; None where blocks do not turn.
    """
    gx = s[at + i + 1] - s[at + i]
    gy = s[at + R + i + 1] - s[at + R + i]
    gz = s[at + 2 * R + i + 1] - s[at + 2 * R + i]
    if arm is None:
        return gx, gy, gz
    gx += arm * (s[at + 5 * R + i + 1] + s[at + 5 * R + i])
    gz -= arm * (s[at + 3 * R + i + 1] + s[at + 3 * R + i])
    return gx, gy, gz


@inlined
def turn(s, at, i, arm):
    """Return the relative rotation phi of joint i; zero where blocks do not turn."""
    if arm is None:
        return 0.0, 0.0, 0.0
    px = s[at + 3 * R + i + 1] - s[at + 3 * R + i]
    py = s[at + 4 * R + i + 1] - s[at + 4 * R + i]
    pz = s[at + 5 * R + i + 1] - s[at + 5 * R + i]
    return px, py, pz


@inlined
def gap_at(arm, g, phi, x, z):
    """Return the gap, or its rate, at the point (x, z)."""
    if arm is None:
        return g[1]
    return g[1] + phi[2] * x - phi[0] * z


@inlined
def slip_at(arm, g, phi, x, z):
    """Return the slip, or its rate, at the point (x, z)."""
    if arm is None:
        return g[0], g[2]
    return g[0] + phi[1] * z, g[2] - phi[1] * x


class Relative(NamedTuple):
    """Relative motion of one joint's faces: displacement g and rotation phi at the whole step,
    their rates half a step before, and at the whole step for the dashpots.

    frame, spin : of the right block, for finite rotations alone (`dem.spatial.finite`).
    """

    g: tuple
    phi: tuple
    g_rate: tuple
    phi_rate: tuple
    g_mid: tuple
    phi_mid: tuple
    frame: Any
    spin: Any


@inlined
def relative(contact, m, h, i):
    """Return the relative motion of joint i."""
    arm, damped, v = contact.arm, contact.damped, velocities(contact.rows)
    g_rate, phi_rate = shift(m, v, i, arm), turn(m, v, i, arm)
    return Relative(
        shift(m, 0, i, arm),
        turn(m, 0, i, arm),
        g_rate,
        phi_rate,
        centred(damped, h, 0, i, g_rate),
        centred(given(arm, damped), h, 3, i, phi_rate),
        None,
        None,
    )


@inlined
def centred(damped, h, row, i, g):
    """Return three rates at the whole step, from half a step before it and one and a half."""
    if damped is None:
        return g
    at = row * L + i
    return 1.5 * g[0] - 0.5 * h[at], 1.5 * g[1] - 0.5 * h[at + L], 1.5 * g[2] - 0.5 * h[at + 2 * L]


@inlined
def remember_rates(damped, contact, m, h, n):
    """Keep the rates of the relative motion for the next step."""
    if damped is not None:
        arm, v = contact.arm, velocities(contact.rows)
        for i in range(min(n, L)):
            h[i], h[L + i], h[2 * L + i] = shift(m, v, i, arm)
            remember_turn(arm, h, i, turn(m, v, i, arm))


@inlined
def remember_turn(arm, h, i, phi):
    """Keep the rates of the relative rotation, where blocks turn."""
    if arm is not None:
        h[3 * L + i], h[4 * L + i], h[5 * L + i] = phi
