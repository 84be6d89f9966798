"""Forces of the joints of one tile: the law at every contact point, summed over the face.

u and theta are a block's displacement and rotation, h half its thickness. At the centre of the
joint, right block less left block, for small rotations:

    g_x = u2_x - u1_x + h (theta2_z + theta1_z),   g_y = u2_y - u1_y,
    g_z = u2_z - u1_z - h (theta2_x + theta1_x),   phi = theta2 - theta1.

At the point (x, z) of the face the gap is g_y + phi_z x - phi_x z and the slip
(g_x + phi_y z, g_z - phi_y x); the same holds for velocities. Each joint leaves in the buffer the
force on its right block and the moment about the centre of the contact, N and N m:

    F = sum A t,   M = sum A r x t = sum A (-z t_y, z t_x - x t_z, x t_y),   r = (x, 0, z).

`dem.spatial.finite` has what differs for rotations of any size.
"""

from collections.abc import Callable

from dem.spatial.finite import (
    FIRST,
    SECOND,
    cross,
    finite_relative,
    put_rates,
    three,
    to_centroids,
)
from dem.spatial.layout import (
    ABOUT_X,
    ABOUT_Y,
    ABOUT_Z,
    CENTRED,
    DRAG,
    FORCE,
    RATE,
    RELATIVE,
    SLID,
    Form,
    X,
    Y,
    Z,
)
from dem.spatial.layout import LANES as L
from dem.spatial.layout import STRIDE as R
from dem.spatial.motion import FACE
from joints.dilation import lift
from joints.energy import friction_work, lift_work
from joints.formula import formula
from joints.law import Law
from joints.normal import normal_traction, spring_traction
from joints.shear import cohesion_left, shear_return, shear_strength, shear_traction
from joints.slide import after_slide


@formula
def law_at(table, i):
    """Return the law of the joint in lane i of a tile's table; of all joints for i = 0."""
    return Law(
        table[i], table[L + i], table[2 * L + i], table[3 * L + i], table[4 * L + i],
        table[5 * L + i], table[6 * L + i], table[7 * L + i], table[8 * L + i], table[9 * L + i],
        table[10 * L + i], table[11 * L + i], table[12 * L + i], table[13 * L + i],
        table[14 * L + i], table[15 * L + i], table[16 * L + i], table[17 * L + i],
        table[18 * L + i], table[19 * L + i], table[20 * L + i],
    )  # fmt: skip


@formula
def relative(m, i, arm, turns):
    """Return g and phi of a joint, or their rates, from the rows that begin at its block m[i]."""
    x, y, z = m[i + 1] - m[i], m[Y + i + 1] - m[Y + i], m[Z + i + 1] - m[Z + i]
    if not turns:
        return x, y, z, 0.0, 0.0, 0.0
    x += arm * (m[ABOUT_Z + i + 1] + m[ABOUT_Z + i])
    z -= arm * (m[ABOUT_X + i + 1] + m[ABOUT_X + i])
    about_x, about_y = m[ABOUT_X + i + 1] - m[ABOUT_X + i], m[ABOUT_Y + i + 1] - m[ABOUT_Y + i]
    return x, y, z, about_x, about_y, m[ABOUT_Z + i + 1] - m[ABOUT_Z + i]


@formula
def centred(h, i, x, y, z):
    """Return three rates at the whole step, from half a step before it and, in h, one and a half;
    remember them for the next step."""
    old_x, old_y, old_z = h[i], h[L + i], h[2 * L + i]
    h[i], h[L + i], h[2 * L + i] = x, y, z
    return 1.5 * x - 0.5 * old_x, 1.5 * y - 0.5 * old_y, 1.5 * z - 0.5 * old_z


@formula
def put(q, i, f, turns):
    """Put three numbers, or six where blocks turn, into rows that begin at q[i]."""
    q[X + i], q[Y + i], q[Z + i] = f[0], f[1], f[2]
    if turns:
        q[ABOUT_X + i], q[ABOUT_Y + i], q[ABOUT_Z + i] = f[3], f[4], f[5]


@formula
def face_force(face, k_n, k_s, g):
    """Return force and moment of springs or dashpots k_n and k_s, per area, over a whole face.

    face : A, the sum of A x^2 or A z^2, and that of A (x^2 + z^2).
    """
    area, across, along = face
    return (
        -k_s * area * g[0],
        -k_n * area * g[1],
        -k_s * area * g[2],
        -k_n * across * g[3],
        -k_s * along * g[4],
        -k_n * across * g[5],
    )


@formula
def at_point(q, i, x, z, turns, finite):
    """Return gap and slip at the point (x, z), or their rates, from the rows of relative motion
    that begin at q[i] for this joint."""
    slip_x, gap, slip_z = three(q, 0, i)
    if finite:
        first, second = three(q, FIRST, i), three(q, SECOND, i)
        gap = gap + x * first[1] + z * second[1]
        slip_x = slip_x + x * first[0] + z * second[0]
        slip_z = slip_z + x * first[2] + z * second[2]
    elif turns:
        phi = three(q, ABOUT_X, i)
        gap = gap + phi[2] * x - phi[0] * z
        slip_x, slip_z = slip_x + phi[1] * z, slip_z - phi[1] * x
    return gap, slip_x, slip_z


@formula
def area_in_contact(b, area, x, z, gap, slip_x, slip_z):
    """Return a point's area, none where it is off the other block's face or behind the block."""
    off_x, off_z = abs(x - slip_x) - b.half_side, abs(z - slip_z) - b.half_side
    # One condition, not three in a row: a branch would keep blocks from being worked on together.
    return area if max(off_x, off_z, -2.0 * b.arm - gap) <= 0.0 else 0.0


def joints_for(form: Form) -> Callable:
    """Return the formula of the forces of a tile's joints."""
    parts, by_points = form.parts, form.points
    turns, finite, ledger = form.turns, form.finite, form.ledger
    dashpots, varied, limited = parts.dashpots, parts.varied, parts.limited
    softening, residual, drags = parts.softening, parts.residual, parts.dashpots and form.ledger
    velocity = rows = form.freedoms * R
    first_point, point_rows = form.rate_rows * L, form.point_rows * L
    cohesions, worn, dilation = (2 + softening) * L, parts.path, parts.dilation
    rated = parts.rate_state
    paths = cohesions + residual * L

    @formula
    def centred_rates(b, m, h, i):
        """Return the rates of joint i's small relative motion at the whole step."""
        rate = relative(m, velocity + i, b.arm, turns)
        x, y, z = centred(h, i, rate[0], rate[1], rate[2])
        if not turns:
            return x, y, z, 0.0, 0.0, 0.0
        about_x, about_y, about_z = centred(h, 3 * L + i, rate[3], rate[4], rate[5])
        return x, y, z, about_x, about_y, about_z

    @formula
    def face_forces(b, law, table, m, h, q, n):
        """Compute the forces of joints that always hold, from their stiffness as a whole, and keep
        their relative motion for the ledger."""
        face = b.rows[FACE, 0], b.rows[FACE, 3], b.rows[FACE, 4]
        for i in range(min(n, L)):
            if varied:
                law = law_at(table, i)
            g = relative(m, i, b.arm, turns)
            f = face_force(face, law.normal_stiffness, law.shear_stiffness, g)
            if dashpots:
                rate = centred_rates(b, m, h, i)
                d = face_force(face, law.normal_viscosity, law.shear_viscosity, rate)
                f = f[0] + d[0], f[1] + d[1], f[2] + d[2], f[3] + d[3], f[4] + d[4], f[5] + d[5]
                if ledger:
                    put(q, DRAG + i + 1, d, turns)
            if ledger:
                put(q, RELATIVE + i, g, turns)
            put(q, i + 1, f, turns)

    @formula
    def relative_motion(b, m, h, q, n):
        """Leave the relative motion of all joints in the buffer, for the points of their faces."""
        for i in range(min(n, L)):
            if finite:
                rate, spin = finite_relative(b, m, q, i)
                put_rates(q, RATE, i, rate, spin)
                if dashpots:
                    rate = centred(h, i, rate[0], rate[1], rate[2])
                    spin = centred(h, 3 * L + i, spin[0], spin[1], spin[2])
                    put_rates(q, CENTRED, i, rate, spin)
            else:
                put(q, RELATIVE + i, relative(m, i, b.arm, turns), turns)
                if dashpots:
                    put(q, CENTRED + i, centred_rates(b, m, h, i), turns)

    @formula
    def small_rates(b, m, q, n):
        """Leave the rates of small relative motion in the buffer, for joints that slide."""
        for i in range(min(n, L)):
            put(q, RATE + i, relative(m, velocity + i, b.arm, turns), turns)

    @formula
    def add_force(b, q, i, x, z, gap, slip_x, slip_z, t_x, t_y, t_z):
        """Add the force at a point, and its moment about the face's centre."""
        q[X + i] += t_x
        q[Y + i] += t_y
        q[Z + i] += t_z
        if finite:
            moment = cross((x - slip_x, -gap, z - slip_z), (t_x, t_y, t_z))
            q[ABOUT_X + i] += moment[0]
            q[ABOUT_Y + i] += moment[1]
            q[ABOUT_Z + i] += moment[2]
        elif turns:
            q[ABOUT_X + i] += -z * t_y
            q[ABOUT_Y + i] += z * t_x - x * t_z
            q[ABOUT_Z + i] += x * t_y

    @formula
    def point_forces(b, law, table, points, h, q, n, slides):
        """Sum the forces over the contact points; return how many are beyond their shear strength.

        slides : whether those are brought back to the strength, which needs a root, and remember
        what has slid; else they are left as they are.
        """
        beyond = 0
        q[FORCE : FORCE + rows] = 0.0
        if drags:
            q[DRAG : DRAG + rows] = 0.0
        for p in range(points.shape[1] - 1, -1, -1):
            x, z, whole = points[0, p], points[1, p], points[2, p]
            # A slice, for the compiler must know that no index is negative.
            own = h[first_point + p * point_rows :]
            for i in range(min(n, L)):
                if varied:
                    law = law_at(table, i)
                gap, slip_x, slip_z = at_point(q, RELATIVE + i, x, z, turns, finite)
                area = whole
                if finite:
                    area = area_in_contact(b, whole, x, z, gap, slip_x, slip_z)
                rate, rate_x, rate_z, opening, cohesion, path = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
                if dashpots:
                    rate, rate_x, rate_z = at_point(q, CENTRED + i, x, z, turns, finite)
                here = gap
                if worn:
                    path = own[paths + i]
                if dilation:
                    here = gap - lift(law, path)
                if softening:
                    opening = max(own[2 * L + i], here)
                    own[2 * L + i] = opening
                if residual:
                    cohesion = own[cohesions + i]
                t_n = normal_traction(law, parts, here, rate, opening)
                tau = shear_strength(law, parts, t_n, here, opening, cohesion, path)
                ex, ez = slip_x - own[i], slip_z - own[L + i]
                if slides:
                    moved, dx, dz = at_point(q, RATE + i, x, z, turns, finite)
                    dx, dz = b.dt * dx, b.dt * dz
                    old_x, old_z = ex - dx, ez - dz
                    if worn:
                        t_n, tau, further = after_slide(
                            law, parts, t_n, tau, here, rate, opening, cohesion, path,
                            ex, ez, rate_x, rate_z, b.dt,
                        )  # fmt: skip
                        own[paths + i] = further
                        if dilation:
                            up = lift(law, further) - lift(law, path)
                            if ledger:
                                q[SLID + i] -= area * lift_work(
                                    law, parts, here - b.dt * moved, here - up, opening, up
                                )
                            here = here - up
                    t_x, t_z, ex, ez, slipped = shear_return(
                        law, parts, ex, ez, old_x, old_z, rate_x, rate_z, tau, b.dt
                    )
                    own[i] = slip_x - ex if slipped else own[i]
                    own[L + i] = slip_z - ez if slipped else own[L + i]
                    if residual:
                        own[cohesions + i] = cohesion_left(law, parts, cohesion, slipped)
                    if ledger:
                        q[SLID + i] += area * friction_work(law, old_x, old_z, ex, ez, dx, dz)
                else:
                    t_x, t_z = shear_traction(law, parts, ex, ez, rate_x, rate_z)
                    slipped = limited and t_x * t_x + t_z * t_z > tau * tau
                beyond += 1 if slipped else 0
                add_force(
                    b, q, i + 1, x, z, gap, slip_x, slip_z, area * t_x, area * t_n, area * t_z
                )
                if drags:  # what is not the springs'
                    t_n = t_n - spring_traction(law, parts, here, opening)
                    t_x, t_z = t_x + law.shear_stiffness * ex, t_z + law.shear_stiffness * ez
                    at = DRAG + i + 1
                    add_force(
                        b, q, at, x, z, gap, slip_x, slip_z, area * t_x, area * t_n, area * t_z
                    )
        return beyond

    @formula
    def joint_forces(b, law, table, points, m, h, q, n, sliding):
        """Compute the forces of the first n joints of a tile into its buffer q.

        table : of the tile's joints where they vary, else `law` is that of all. points : x, z (m)
        and area (m2) of the contact points [3, points]. m, h : motion and history of the tile.
        sliding : int64 [1], how many points of the tile slid in its last step: where none did,
        none is taken to slide until one does.
        """
        if not by_points:
            face_forces(b, law, table, m, h, q, n)
        else:
            relative_motion(b, m, h, q, n)
            if ledger:
                q[SLID : SLID + L] = 0.0
            beyond = sliding[0]
            # Friction that depends on the rate ages where nothing slides.
            if rated:
                beyond = 1
            if beyond == 0:
                beyond = point_forces(b, law, table, points, h, q, n, False)
            if beyond > 0:
                if not finite:
                    small_rates(b, m, q, n)
                sliding[0] = point_forces(b, law, table, points, h, q, n, True)
            if finite:
                for i in range(min(n, L)):
                    to_centroids(b, m, q, FORCE, i)
                    if drags:
                        to_centroids(b, m, q, DRAG, i)

    return joint_forces
