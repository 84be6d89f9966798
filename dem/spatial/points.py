"""The law at the contact points of a joint, written out point by point."""

from numba.extending import overload

from dem.spatial import finite
from dem.spatial.kinematics import gap_at, slip_at
from dem.spatial.layout import LANES as L
from dem.spatial.layout import first_cohesion, first_opening, first_slide
from joints.energy import friction_work
from joints.laws import normal_traction, spring_traction
from joints.shear import cohesion_left, shear_return, shear_strength, shear_traction
from numerics.jit import inlined
from numerics.optional import either, given

WRITTEN_OUT = 9  # points at most: 3 x 3
NO_FORCE = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def every_point(xs, zs, areas, p, contact, law, motion, h, drag, i, book, returns):
    """Return force, dashpots' share, points beyond their strength and work done by sliding, summed
    over points p, ...

    Compiled only: a few points are written out one by one, since a loop inside that over the
    blocks would keep several blocks from being worked on at once. Many would compile for minutes.
    """


@overload(every_point)
def _every_point(xs, zs, areas, p, contact, law, motion, h, drag, i, book, returns):
    if len(areas) > WRITTEN_OUT:
        return looped_points
    return last_point if len(areas) == 1 else next_point


def looped_points(xs, zs, areas, p, contact, law, motion, h, drag, i, book, returns):
    """Compute all points in a loop."""
    f, d, over, work = NO_FORCE, NO_FORCE, 0, 0.0
    for k in range(len(areas)):
        one, drags, more, done = at_point(
            xs[k], zs[k], areas[k], k, contact, law, motion, h, drag, i, book, returns
        )
        f, d, over, work = plus(f, one), plus(d, drags), over + more, work + done
    return f, d, over, work


def last_point(xs, zs, areas, p, contact, law, motion, h, drag, i, book, returns):
    """Compute the last point."""
    x, z, area = xs[0], zs[0], areas[0]
    return at_point(x, z, area, p, contact, law, motion, h, drag, i, book, returns)


def next_point(xs, zs, areas, p, contact, law, motion, h, drag, i, book, returns):
    """Compute one point and add the others."""
    x, z, area = xs[0], zs[0], areas[0]
    f, d, over, work = at_point(x, z, area, p, contact, law, motion, h, drag, i, book, returns)
    rest, drags, more, works = every_point(
        xs[1:], zs[1:], areas[1:], p + 1, contact, law, motion, h, drag, i, book, returns
    )
    return plus(f, rest), plus(d, drags), over + more, work + works


@inlined
def at_point(x, z, area, p, contact, law, motion, h, drag, i, book, returns):
    """Return the force of point p with its moment, the dashpots' share, and 1 where beyond."""
    arm, rows = contact.arm, contact.rows
    gap_of = either(contact.finite, gap_at, finite.finite_gap_at)
    slip_of = either(contact.finite, slip_at, finite.finite_slip_at)
    gap, rate = (
        gap_of(arm, motion.g, motion.phi, x, z),
        gap_of(arm, motion.g_mid, motion.phi_mid, x, z),
    )
    slip = slip_of(arm, motion.g, motion.phi, x, z)
    area = either(contact.finite, whole_area, finite.area_in_contact)(
        contact, area, x, z, gap, slip
    )
    at = first_opening(rows) + p * L + i
    opening = given(rows.openings, max(h[at], gap))
    keep_opening(rows.openings, h, at, opening)
    at = first_cohesion(rows) + p * L + i
    cohesion = given(rows.cohesions, h[at])
    t_n = normal_traction(law, gap, rate, opening)
    tau = shear_strength(law, t_n, gap, opening, cohesion)
    t_x, t_z, ex, ez, over, work = shear_at_point(
        x, z, p, contact, slip, law, motion, h, i, tau, cohesion, returns
    )
    force = either(contact.finite, force_at, finite.finite_force_at)
    f = force(x, z, gap, slip, area * t_x, area * t_n, area * t_z)
    t_n, t_x, t_z = dragged(drag, law, gap, opening, t_n, t_x, t_z, ex, ez)
    d = force(x, z, gap, slip, area * t_x, area * t_n, area * t_z)
    return f, d, over, area * work


@inlined
def whole_area(contact, area, x, z, gap, slip):
    """Return a point's area: where rotations are small the faces stay in front of each other."""
    return area


@inlined
def shear_at_point(x, z, p, contact, slip, law, motion, h, i, tau, cohesion, returns):
    """Return the shear traction of a point, its elastic slip, and 1 where it is beyond tau."""
    arm, dt, rows = contact.arm, contact.dt, contact.rows
    slip_of = either(contact.finite, slip_at, finite.finite_slip_at)
    at = first_slide(rows) + 2 * p * L + i
    ex, ez = slip[0] - h[at], slip[1] - h[at + L]
    rate_x, rate_z = slip_of(arm, motion.g_mid, motion.phi_mid, x, z)
    if returns is None:
        t_x, t_z = shear_traction(law, ex, ez, rate_x, rate_z)
        return t_x, t_z, ex, ez, exceeds(tau, t_x, t_z), 0.0
    dx, dz = slip_of(arm, motion.g_rate, motion.phi_rate, x, z)
    dx, dz = dt * dx, dt * dz
    old_x, old_z = ex - dx, ez - dz
    t_x, t_z, ex, ez, slipped = shear_return(law, ex, ez, old_x, old_z, rate_x, rate_z, tau, dt)
    h[at] = slip[0] - ex if slipped else h[at]
    h[at + L] = slip[1] - ez if slipped else h[at + L]
    keep(rows.cohesions, h, first_cohesion(rows) + p * L + i, law, cohesion, slipped)
    work = friction_work(law, old_x, old_z, ex, ez, dx, dz)
    return t_x, t_z, ex, ez, 1 if slipped else 0, work


@inlined
def keep_opening(rows, h, at, opening):
    """Keep the largest opening of a point, with softening."""
    if rows is not None:
        h[at] = opening


@inlined
def keep(rows, h, at, law, cohesion, slipped):
    """Keep the cohesion that slip leaves to a point."""
    if rows is not None:
        h[at] = cohesion_left(law, cohesion, slipped)


@inlined
def exceeds(tau, t_x, t_z):
    """Return 1 where the shear traction is beyond its strength."""
    if tau is None:
        return 0
    return 1 if t_x * t_x + t_z * t_z > tau * tau else 0


@inlined
def plus(f, d):
    """Return the sum of two forces with their moments."""
    return f[0] + d[0], f[1] + d[1], f[2] + d[2], f[3] + d[3], f[4] + d[4], f[5] + d[5]


@inlined
def force_at(x, z, gap, slip, t_x, t_y, t_z):
    """Return a force (N) on the point (x, z) with its moment about the centre."""
    return t_x, t_y, t_z, -z * t_y, z * t_x - x * t_z, x * t_y


@inlined
def dragged(drag, law, gap, opening, t_n, t_x, t_z, ex, ez):
    """Return the dashpots' share of a traction: what is not its springs'."""
    if drag is None:
        return 0.0, 0.0, 0.0
    t_n -= spring_traction(law, gap, opening)
    return t_n, t_x + law.shear_stiffness * ex, t_z + law.shear_stiffness * ez
