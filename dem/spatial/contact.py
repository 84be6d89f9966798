"""Forces of the joints of one tile: the law at every contact point, summed over the face.

Each joint leaves in the scratch the force on its right block and the moment about the centre of
the contact, N and N m, with r = (x, 0, z) over the face:

    F = sum A t,   M = sum A r x t = sum A (-z t_y, z t_x - x t_z, x t_y).

The lane of a joint's force is one beyond that of its left block: a block finds the force of its
left joint in its own lane, that of its right joint in the next.
"""

from typing import Any, NamedTuple

from dem.spatial import finite
from dem.spatial.book import FRICTION
from dem.spatial.kinematics import relative, remember_rates
from dem.spatial.layout import LANES as L
from dem.spatial.layout import STRIDE as R
from dem.spatial.points import NO_FORCE, every_point, plus
from dem.spatial.scratch import DRAG, SLID
from joints.laws import Law
from numerics.jit import inlined
from numerics.optional import either, given


class Points(NamedTuple):
    """The contact points of a face: place, m, and area, m2, as tuples of one number each."""

    x: tuple
    z: tuple
    area: tuple


class Section(NamedTuple):
    """The face of a joint that always holds, where only sums over its points count.

    area, m2; across : sum A x^2 = sum A z^2, m4; along : sum A (x^2 + z^2), m4.
    """

    area: float
    across: float
    along: float


class Contact(NamedTuple):
    """The constants of all joints.

    law : per unit area; its parts are numbers where all joints are alike. table : float array
    [tiles, parts * LANES], the parts in the order of `Law` where they differ, else None.
    points : the contact points, None where the joints are linear. section : None where not.
    rows : of a tile. arm : half the block thickness, m; None where blocks do not turn.
    dt : s. damped : whether there are dashpots, None where not.
    finite : (1 / I_t, 1 / I_a - 1 / I_t) of a block that turns by any angle, 1/(kg m2); else None.
    half_side : of the section, m.
    """

    law: Law
    table: Any
    points: Any
    section: Any
    rows: Any
    arm: Any
    dt: float
    damped: Any
    finite: Any
    half_side: float


@inlined
def law_at(law, table, i):
    """Return the law of the joint in lane i of a tile's table."""
    if table is None:
        return law
    return Law(
        table[i],
        given(law.normal_viscosity, table[L + i]),
        given(law.carries_tension, table[2 * L + i] != 0.0),
        given(law.shear_stiffness, table[3 * L + i]),
        given(law.shear_viscosity, table[4 * L + i]),
        given(law.cohesion, table[5 * L + i]),
        given(law.friction, table[6 * L + i]),
        given(law.residual_cohesion, table[7 * L + i]),
        given(law.tensile_strength, table[8 * L + i]),
        given(law.critical_opening, table[9 * L + i]),
    )


@inlined
def forces(contact, table, m, h, q, drag, n, book, slides):
    """Compute the forces of the first n joints of a tile into the scratch q.

    drag, book : whether the dashpots' share and the work done by sliding are left there too, None
    where no ledger asks for them. slides : see `of_points`; None where none can.
    """
    of_section(contact, contact.section, table, m, h, q, drag, n)
    of_points(contact, contact.points, table, m, h, q, drag, n, book, slides)
    remember = either(contact.finite, remember_rates, finite.finite_remember_rates)
    remember(contact.damped, contact, m, h, n)


@inlined
def of_section(contact, section, table, m, h, q, drag, n):
    """Compute the forces of joints that always hold."""
    if section is not None:
        linear_forces(contact, section, table, m, h, q, drag, n)


@inlined
def of_points(contact, points, table, m, h, q, drag, n, book, slides):
    """Compute the forces of joints that may open, slide or break.

    Where none slid in the step before, none is taken to slide until one does: that needs no root.
    slides : int64 [1], how many points of the tile slid in its last step.
    """
    if points is not None:
        beyond = slides[0]
        if beyond == 0:
            beyond = point_forces(contact, points, table, m, h, q, drag, n, None, None)
        if beyond > 0:
            slides[0] = point_forces(
                contact, points, table, m, h, q, drag, n, given(book, True), True
            )
            book_slides(book, q, n)


@inlined
def book_slides(book, q, n):
    """Book the work done by sliding, where there is a ledger."""
    if book is not None:
        for i in range(min(n, L)):
            book[FRICTION * R + i] += q[SLID + i]


@inlined
def point_forces(contact, points, table, m, h, q, drag, n, book, returns):
    """Sum the tractions over the contact points; return how many are beyond their shear strength.

    returns : None to leave those as they are, which needs no root; true to bring them back to
    the strength and to remember what has slid.
    """
    beyond = 0
    for i in range(min(n, L)):
        law = law_at(contact.law, table, i)
        motion = either(contact.finite, relative, finite.finite_relative)(contact, m, h, i)
        f, d, over, work = every_point(
            points.x, points.z, points.area, 0, contact, law, motion, h, drag, i, book, returns
        )
        beyond += over
        either(contact.finite, leave, finite.finite_leave)(q, i, contact, motion, f)
        leave_drag(drag, q, i, contact, motion, d)
        leave_work(book, q, i, work)
    return beyond


@inlined
def linear_forces(contact, section, table, m, h, q, drag, n):
    """Compute the forces of joints that always hold, from their stiffness as a whole."""
    for i in range(min(n, L)):
        law, motion = law_at(contact.law, table, i), relative(contact, m, h, i)
        f = resist(section, law.normal_stiffness, law.shear_stiffness, motion.g, motion.phi)
        d = resist_rates(contact.damped, section, law, motion)
        leave(q, i, contact, motion, plus(f, d))
        leave_drag(drag, q, i, contact, motion, d)


@inlined
def resist(section, k_n, k_s, g, phi):
    """Return the force and moment of springs k_n and k_s, Pa/m, over a face."""
    area, across = section.area, section.across
    return (
        -k_s * area * g[0],
        -k_n * area * g[1],
        -k_s * area * g[2],
        -k_n * across * phi[0],
        -k_s * section.along * phi[1],
        -k_n * across * phi[2],
    )


@inlined
def resist_rates(damped, section, law, motion):
    """Return the force and moment of the dashpots over a face."""
    if damped is None:
        return NO_FORCE
    k_n, k_s = law.normal_viscosity, law.shear_viscosity
    return resist(section, k_n, k_s, motion.g_mid, motion.phi_mid)


@inlined
def leave(q, i, contact, motion, f):
    """Leave the force and moment of joint i in the scratch, one lane beyond its left block."""
    q[i + 1], q[R + i + 1], q[2 * R + i + 1] = f[0], f[1], f[2]
    leave_moment(contact.arm, q, i, f)


@inlined
def leave_moment(arm, q, i, f):
    """Leave the moment, where blocks turn."""
    if arm is not None:
        q[3 * R + i + 1], q[4 * R + i + 1], q[5 * R + i + 1] = f[3], f[4], f[5]


@inlined
def leave_drag(drag, q, i, contact, motion, d):
    """Leave the dashpots' share, where a ledger asks for it."""
    if drag is not None:
        either(contact.finite, leave, finite.finite_leave)(q, DRAG + i, contact, motion, d)


@inlined
def leave_work(book, q, i, work):
    """Leave the work done by sliding, where a ledger asks for it."""
    if book is not None:
        q[SLID + i] = work
