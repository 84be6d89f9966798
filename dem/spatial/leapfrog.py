"""One leapfrog step of one tile of a row: forces of its joints, load and ends, then its motion.

u and theta are a block's displacement and rotation at whole steps, h half its thickness; velocities
live half a step before. At the centre of a joint, right block less left block, for small rotations:

    g_x = u2_x - u1_x + h (theta2_z + theta1_z),   g_y = u2_y - u1_y,
    g_z = u2_z - u1_z - h (theta2_x + theta1_x),   phi = theta2 - theta1.

At the point (x, z) of the face the gap is g_y + phi_z x - phi_x z and the slip
(g_x + phi_y z, g_z - phi_y x); the same holds for velocities. Each joint leaves in the buffer the
force on its right block and the moment about the centre of the contact, N and N m:

    F = sum A t,   M = sum A r x t = sum A (-z t_y, z t_x - x t_z, x t_y),   r = (x, 0, z),
    m v' = F_left - F_right + m g,   I omega' = M_left - M_right + h y x (-(F_left + F_right)),

with y x F = (F_z, 0, -F_x): the shear forces of both joints turn a block the same way.
`dem.spatial.finite` has what differs for rotations of any size, `dem.spatial.ends` the ends.

The ledger: the work of a force from one whole step to the next is the mean of its two values times
the displacement. So a force at step n acts over the half step before it and over the one after it,
which are accounted for apart: at a sample only the first half has been done. The kinetic energy
v[n-1/2] m v[n+1/2] / 2 is what leapfrog conserves.
"""

from collections.abc import Callable
from functools import cache
from math import copysign
from typing import Any

from jointwave.dem.spatial.ends import (
    BASE,
    CLOSURE,
    DECAY,
    GAIN,
    MATRIX,
    MEAN,
    REACTION,
    STEADY,
    STIFFNESS,
    VELOCITY,
    VISCOSITY,
)  # fmt: skip
from jointwave.dem.spatial.finite import (
    FIRST,
    QUATERNION,
    SECOND,
    angular_velocity,
    centred,
    cross,
    dot,
    finite_relative,
    less,
    put_rates,
    put_three,
    three,
    to_centroids,
    turn_by_momentum,
)  # fmt: skip
from jointwave.dem.spatial.layout import (
    ABOUT_X,
    ABOUT_Y,
    ABOUT_Z,
    AFTER,
    BEFORE,
    BOUNDARY,
    CENTRED,
    DRAG,
    ELASTIC,
    FORCE,
    FRACTURE,
    FRICTION,
    GRAVITY,
    KINETIC,
    LEFT,
    RATE,
    RELATIVE,
    ROTATION,
    SLIDING,
    VISCOUS,
    WORK,
    KernelFlags,
    X,
    Y,
    Z,
)  # fmt: skip
from jointwave.dem.spatial.layout import LANES as L
from jointwave.dem.spatial.layout import STRIDE as R
from jointwave.dem.spatial.model import DIRECTION, FACE, FALL, INERTIA, PUSH, WEIGHT, constants_of
from jointwave.joints.dilation import lift
from jointwave.joints.energy import elastic_energy, fracture_energy_spent, friction_work, lift_work
from jointwave.joints.formula import formula
from jointwave.joints.law import Law, law_at
from jointwave.joints.normal import normal_traction, spring_traction
from jointwave.joints.shear import cohesion_left, shear_return, shear_strength, shear_traction
from jointwave.joints.slide import after_slide
from jointwave.numerics.divergence import EVERY, SPEED, note

CHECK = 64  # steps between two checks of a tile's speeds: others run ahead of it by some more
#: Rows of the law's table that a face as a whole needs: of its springs, then of its dashpots.
NORMAL, SHEAR = L * Law._fields.index("normal_stiffness"), L * Law._fields.index("shear_stiffness")
DASHPOT = L * Law._fields.index("normal_viscosity") - NORMAL


def contacts_for(form: KernelFlags) -> Callable:
    """Return the formula of the law at the contact points of a tile's joints."""
    parts, turns, finite, has_ledger = form.parts, form.turns, form.finite, form.ledger
    dashpots, varied, limited = parts.dashpots, parts.varied, parts.limited
    softening, residual, drags = parts.softening, parts.residual, parts.dashpots and form.ledger
    path_dependent, dilation, returns = parts.path, parts.dilation, parts.dashpots or form.ledger
    first_point, point_rows = form.rate_rows * L, form.point_rows * L
    cohesions, paths = (2 + softening) * L, (2 + softening + residual) * L
    kinds = 2 if drags else 1
    at_point, contact_area = at_point_for(form)

    @formula
    def add_force(q, i, x, z, gap, slip_x, slip_z, t_x, t_y, t_z):
        """Add the force at a point, and its moment about the face's centre."""
        if turns:
            q[X + i], q[Y + i], q[Z + i] = q[X + i] + t_x, q[Y + i] + t_y, q[Z + i] + t_z
            m_x, m_y, m_z = -z * t_y, z * t_x - x * t_z, x * t_y
            if finite:
                m_x, m_y, m_z = cross((x - slip_x, -gap, z - slip_z), (t_x, t_y, t_z))
            q[ABOUT_X + i] += m_x
            q[ABOUT_Y + i] += m_y
            q[ABOUT_Z + i] += m_z
        else:  # the one point of the face
            q[X + i], q[Y + i], q[Z + i] = t_x, t_y, t_z

    @formula
    def contacts(b, law, laws, points, count, h, q, ledger, n, slides):
        """Sum the forces of n joints; return how many points are beyond their shear strength.

        slides : whether those are brought back to it, which needs a root, and remember what has
        slid; else they are left as they are. A constant of each call.
        """
        beyond = 0
        if turns:
            for kind in range(kinds):
                for k in range(b.freedoms):
                    for i in range(n):
                        q[kind * DRAG + k * R + i + 1] = 0.0
        for k in range(count):
            p = count - 1 - k
            x, z, whole = points[0, p], points[1, p], points[2, p]
            past = first_point + p * point_rows
            for i in range(n):
                if varied:
                    law = law_at(laws, i, L)
                gap, slip_x, slip_z = at_point(q, RELATIVE + i, x, z)
                area, rate, rate_x, rate_z = whole, 0.0, 0.0, 0.0
                opening, cohesion, path, slipped = 0.0, 0.0, 0.0, False
                if finite:
                    area = contact_area(b, whole, x, z, gap, slip_x, slip_z)
                if dashpots:
                    rate, rate_x, rate_z = at_point(q, CENTRED + i, x, z)
                here = gap
                if path_dependent:
                    path = h[past + paths + i]
                if dilation:
                    here = gap - lift(law, path)
                if softening:
                    opening = h[past + 2 * L + i]
                    opening = here if here > opening else opening
                    h[past + 2 * L + i] = opening
                if residual:
                    cohesion = h[past + cohesions + i]
                t_n = normal_traction(law, parts, here, rate, opening)
                tau = shear_strength(law, parts, t_n, here, opening, cohesion, path)
                own_x, own_z = h[past + i], h[past + L + i]
                ex, ez = slip_x - own_x, slip_z - own_z
                if limited and slides:
                    moved, dx, dz, old_x, old_z = 0.0, 0.0, 0.0, 0.0, 0.0
                    if returns:
                        moved, dx, dz = at_point(q, RATE + i, x, z)
                        dx, dz = b.dt * dx, b.dt * dz
                        old_x, old_z = ex - dx, ez - dz
                    if path_dependent:
                        t_n, tau, further = after_slide(
                            law, parts, t_n, tau, here, rate, opening, cohesion, path,
                            ex, ez, rate_x, rate_z, b.dt,
                        )  # fmt: skip
                        h[past + paths + i] = further
                        if dilation:
                            up = lift(law, further) - lift(law, path)
                            if has_ledger:
                                ledger[FRICTION + i] -= area * lift_work(
                                    law, parts, here - b.dt * moved, here - up, opening, up
                                )
                            here = here - up
                    t_x, t_z, ex, ez, slipped = shear_return(
                        law, parts, ex, ez, old_x, old_z, rate_x, rate_z, tau, b.dt
                    )
                    h[past + i] = slip_x - ex if slipped else own_x
                    h[past + L + i] = slip_z - ez if slipped else own_z
                    if residual:
                        h[past + cohesions + i] = cohesion_left(law, parts, cohesion, slipped)
                    if has_ledger:
                        ledger[FRICTION + i] += area * friction_work(
                            law, old_x, old_z, ex, ez, dx, dz
                        )
                else:
                    t_x, t_z = shear_traction(law, parts, ex, ez, rate_x, rate_z)
                    if limited:
                        slipped = t_x * t_x + t_z * t_z > tau * tau
                beyond += 1 if slipped else 0
                add_force(q, i + 1, x, z, gap, slip_x, slip_z, area * t_x, area * t_n, area * t_z)
                if drags:  # what is not the springs'
                    t_n = t_n - spring_traction(law, parts, here, opening)
                    t_x, t_z = t_x + law.shear_stiffness * ex, t_z + law.shear_stiffness * ez
                    at = DRAG + i + 1
                    add_force(q, at, x, z, gap, slip_x, slip_z, area * t_x, area * t_n, area * t_z)
        return beyond

    return contacts


@cache
def at_point_for(form: KernelFlags) -> tuple[Callable, Callable]:
    """Return the formulas of the relative motion at a contact point, and of its area."""
    turns, finite = form.turns, form.finite

    @formula
    def at_point(q, i, x, z):
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
    def contact_area(b, area, x, z, gap, slip_x, slip_z):
        """Return a point's area, none where it is off the other block's face or behind it."""
        off_x, off_z = abs(x - slip_x) - b.half_side, abs(z - slip_z) - b.half_side
        # One condition, not three in a row: a branch would keep blocks from being worked together.
        return area if max(off_x, off_z, -2.0 * b.arm - gap) <= 0.0 else 0.0

    return at_point, contact_area


def step_for(form: KernelFlags) -> Callable:
    """Return the formula of one step of one tile: what its form lacks is not compiled."""
    parts, by_points, turns, finite = form.parts, form.points, form.turns, form.finite
    dashpots, varied, limited, has_ledger = parts.dashpots, parts.varied, parts.limited, form.ledger
    softening, dilation = parts.softening, parts.dilation
    gravity, local_damping, shaken = form.gravity, form.local_damping, form.base
    mass_damping, damped = form.mass_damping or form.relaxed, form.mass_damping or local_damping
    has_start, has_end = (
        form.start or has_ledger,
        form.end,
    )  # a ledger needs the loaded face's velocity
    held, drags = has_start or has_end, dashpots and has_ledger
    kinds = 2 if drags else 1  # of forces: all, and the dashpots' share
    history_kept, rated = form.rate_rows + form.point_rows > 0, dashpots or has_ledger
    velocity, rows = form.freedoms * R, form.motion_rows
    first_point, point_rows = form.rate_rows * L, form.point_rows * L
    paths = (2 + softening + parts.residual) * L
    contact_forces = contacts_for(form)
    at_point, contact_area = at_point_for(form)

    @formula
    def relative(m, i, k, arm, about):
        """Return small relative motion k of a joint, or its rate, from the rows that begin at its
        block m[i]; arm : from the faces to the centroids, m, about : the rotation that it turns."""
        g = m[k * R + i + 1] - m[k * R + i]
        if turns and (k == 0 or k == 2):
            g = g + arm * (m[about + i + 1] + m[about + i])
        return g

    @formula
    def lever(b, at, k):
        """Return the arm (m) of the shear forces in moment k, about x or z, and their row."""
        return (-b.arm, at + Z) if k == 3 else (b.arm, at + X)

    @formula
    def net_force(q, k, i, j, arm):
        """Return force or moment k of both joints on a block, and the dashpots' share of it for the
        ledger: small rotations."""
        net, drag = q[i] - q[i + 1], 0.0
        if drags:
            drag = q[DRAG + i] - q[DRAG + i + 1]
        if turns and (k == 3 or k == 5):
            net = net + arm * (q[j] + q[j + 1])
            if drags:
                drag = drag + arm * (q[DRAG + j] + q[DRAG + j + 1])
        return net, drag

    @formula
    def moments(q, at, i):
        """Return the moment of both joints on block i about its centroid: finite rotations."""
        right, left = three(q, at + ABOUT_X, i), three(q, at + LEFT, i + 1)
        return right[0] + left[0], right[1] + left[1], right[2] + left[2]

    @formula
    def dissipate(ledger, i, before, after):
        """Enter into the ledger the work of an impulse that damps block i, taken as a force over
        the half step before it and over the one after it, J."""
        ledger[VISCOUS + i] -= 0.5 * before
        ledger[VISCOUS + AFTER + i] -= 0.5 * after

    @formula
    def add_at_face(b, q, i, side, factor, f):
        """Add factor times force and moment f at the outer face of block i; side : +1 at the
        start, -1 at the end."""
        lane = i if side > 0.0 else i + 1
        for k in range(b.freedoms // 2 if finite else b.freedoms):
            q[k * R + lane] += side * (factor * f[k])
        if finite:  # about the centroid
            lane += ABOUT_X if side > 0.0 else LEFT
            q[lane + X] += factor * (f[3] - side * b.arm * f[2])
            q[lane + Y] += factor * f[4]
            q[lane + Z] += factor * (f[5] + side * b.arm * f[0])

    @formula
    def put_velocity(b, p, m, i):
        """Put the velocity of block i, and its angular velocity, into p."""
        for k in range(b.freedoms):
            p[k] = m[velocity + k * R + i]
        if finite:
            p[3], p[4], p[5] = angular_velocity(b, m, i)

    @formula
    def to_face(b, p, side):
        """Turn the velocity of a block into that of its outer face, in place."""
        if turns:
            p[0] += side * b.arm * p[5]
            p[2] -= side * b.arm * p[3]

    @formula
    def advanced(b, v, gain):
        """Return a velocity after the step, from that before it and what its forces would add."""
        if local_damping:  # less by local |gain| along v
            gain = gain - b.local * copysign(abs(gain), v) if v != 0.0 else gain
        if mass_damping:
            v = b.keep * v
        return v + gain

    @formula
    def step(
        constants, counts, table, points, drive, ends, places, motion, history, end_states,
        force, speed, displacement, q, carry, ledger, t, n, limit, found,
    ):  # fmt: skip
        """Advance tile t by step n.

        q : its buffer. carry : where in it the force of the left neighbour's last joint lies, then
        that of its own. ledger : of this step. The rest is what `march` takes.
        """
        count, tiles, stride, contacts = counts[0], counts[1], counts[2], counts[3]
        receivers, per_face, loaded, sides = counts[4], counts[5], counts[6], counts[9]
        # Known to be few: loops over them are not vectorised.
        freedoms = counts[8] if counts[8] < 6 else 6
        b, m, final = constants_of(constants, freedoms), motion[t], t == tiles - 1
        blocks, joints = L, L
        if final:
            blocks = count - t * L
            blocks = blocks if blocks < L else L  # which tells the compiler of a bound
            joints = blocks - 1
        sampled, s = n % stride == 0, n // stride
        h: Any = None
        laws = table[t if varied else 0]
        if history_kept:
            h = history[t]
        if not final:
            following = motion[t + 1]
            for k in range(rows):
                m[k * R + L] = following[k * R]

        # Relative motion of the joints' faces, and its rates, half a step before and now; forces of
        # joints that always hold, of the face as a whole.
        if finite:
            for i in range(joints):
                rate, spin = finite_relative(b, m, q, i)
                put_rates(q, RATE, i, rate, spin)
                if dashpots:
                    rate, spin = centred(h, i, rate), centred(h, 3 * L + i, spin)
                    put_rates(q, CENTRED, i, rate, spin)
        else:
            for k in range(b.freedoms):
                arm, about = (-b.arm, ABOUT_X) if k == 2 else (b.arm, ABOUT_Z)
                at, share = NORMAL if k % 2 else SHEAR, b.rows[FACE, k]
                for i in range(joints):
                    g, rate = relative(m, i, k, arm, about), 0.0
                    if by_points or has_ledger:
                        q[RELATIVE + k * R + i] = g
                    if dashpots or (by_points and rated):
                        rate = relative(m, velocity + i, k, arm, about)
                        if by_points:
                            q[RATE + k * R + i] = rate
                    if dashpots:
                        last, h[k * L + i] = h[k * L + i], rate
                        rate = 1.5 * rate - 0.5 * last
                        if by_points:
                            q[CENTRED + k * R + i] = rate
                    if not by_points:
                        j = at + i if varied else at
                        f = -laws[j] * share * g
                        if dashpots:
                            d = -laws[j + DASHPOT] * share * rate
                            f = f + d
                            if has_ledger:
                                q[DRAG + k * R + i + 1] = d
                        q[k * R + i + 1] = f

        # Forces of the joints at their contact points.
        law = law_at(laws, 0, L)
        if by_points:
            beyond = 0 if m[SLIDING] == 0.0 else 1
            # Where no point slid in the last step, none is taken to slide until one does; friction
            # that depends on the rate ages where nothing slides.
            if not parts.rate_state and (beyond == 0 or not limited):
                beyond = contact_forces(b, law, laws, points, per_face, h, q, ledger, joints, False)
            if parts.rate_state or (limited and beyond > 0):
                m[SLIDING] = contact_forces(
                    b, law, laws, points, per_face, h, q, ledger, joints, True
                )
        if finite:
            for i in range(joints):
                to_centroids(b, m, q, FORCE, i)
                if drags:
                    to_centroids(b, m, q, DRAG, i)
        for kind in range(kinds):
            for k in range(b.freedoms):
                at = kind * DRAG + k * R
                q[at] = q[carry + 6 * kind + k] if t > 0 else 0.0
                if final:  # where the last block would have a joint
                    q[at + blocks] = 0.0
                    if finite and k > 2:
                        q[at + LEFT - ABOUT_X + blocks] = 0.0

        # Forces of the load and the ends.
        stress, before, after = 0.0, 0.0, 0.0
        if shaken:
            before = drive[n] if n < loaded else 0.0
            after = drive[n + 1] if n + 1 < loaded else 0.0
        elif t == 0 and n < loaded:
            stress = drive[n]
        if t == 0:
            add_at_face(b, q, 0, 1.0, stress, b.rows[DIRECTION])
        if held:
            for e in range(sides):
                if (has_start and e == 0 and t == 0) or (has_end and e == 1 and final):
                    end, state, i, side = ends[e], end_states[e], 0, 1.0
                    moved = before + after
                    if e == 1:
                        i, side, moved = blocks - 1, -1.0, 0.0
                    w, r, old, mean = state[CLOSURE], state[REACTION], state[VELOCITY], state[MEAN]
                    add_at_face(b, q, i, side, 1.0, end[STEADY])
                    put_velocity(b, old, m, i)
                    for k in range(b.freedoms):
                        mean[k] = q[k * R + i] - q[k * R + i + 1]
                    if finite:
                        for k in range(3, b.freedoms):
                            mean[k] = q[k * R + i] + q[LEFT + (k - 3) * R + i + 1]
                    elif turns:
                        mean[3] -= b.arm * (q[Z + i] + q[Z + i + 1])
                        mean[5] += b.arm * (q[X + i] + q[X + i + 1])
                    for k in range(b.freedoms):  # the velocity after the step without the end
                        gain = b.rows[PUSH, k] * mean[k] + b.rows[FALL, k]
                        mean[k] = b.keep * old[k] + gain
                    to_face(b, old, side)
                    to_face(b, mean, side)
                    for k in range(b.freedoms):
                        both = old[k] + mean[k] - moved * end[BASE, k] / b.dt
                        mean[k] = end[STIFFNESS, k] * w[k] + 0.5 * end[VISCOSITY, k] * both
                    for k in range(b.freedoms):
                        r[k] = 0.0
                        for j in range(b.freedoms):
                            r[k] -= end[MATRIX + k, j] * mean[j]
                    add_at_face(b, q, i, side, 1.0, r)

        if sampled:
            for p in range(receivers):
                if places[0, p] == t:
                    i = places[1, p]
                    for k in range(b.freedoms):
                        if p < contacts:
                            force[p, k, s] = q[k * R + i]
                        else:
                            displacement[p - contacts, k, s] = m[k * R + i]
                            speed[p - contacts, k, s] = 0.5 * m[velocity + k * R + i]
                    if finite and p >= contacts:
                        displacement[p - contacts, 6, s] = m[QUATERNION + i]
            if has_ledger:  # what joints and blocks store, and what softening has spent
                if by_points:
                    for p in range(per_face):
                        x, z, area = points[0, p], points[1, p], points[2, p]
                        past = first_point + p * point_rows
                        for i in range(joints):
                            if varied:
                                law = law_at(laws, i, L)
                            gap, slip_x, slip_z = at_point(q, RELATIVE + i, x, z)
                            share, opening = area, 0.0
                            if finite:
                                share = contact_area(b, area, x, z, gap, slip_x, slip_z)
                            if dilation:
                                gap = gap - lift(law, h[past + paths + i])
                            if softening:
                                opening = h[past + 2 * L + i]
                                ledger[FRACTURE + i] += share * fracture_energy_spent(law, opening)
                            ex, ez = slip_x - h[past + i], slip_z - h[past + L + i]
                            stored = elastic_energy(law, parts, gap, opening, ex, ez)
                            ledger[ELASTIC + i] += share * stored
                else:
                    for k in range(b.freedoms):
                        at, share = NORMAL if k % 2 else SHEAR, 0.5 * b.rows[FACE, k]
                        for i in range(joints):
                            stiffness, g = laws[at + i if varied else at], q[RELATIVE + k * R + i]
                            ledger[ELASTIC + i] += share * stiffness * g * g
                if gravity:
                    x, y, z = b.rows[WEIGHT, 0], b.rows[WEIGHT, 1], b.rows[WEIGHT, 2]
                    for i in range(blocks):
                        ledger[GRAVITY + i] -= x * m[X + i] + y * m[Y + i] + z * m[Z + i]

        # Motion, and the work of what damps blocks and joints.
        for k in range(b.freedoms // 2 if finite else b.freedoms):
            push, fall, (arm, across) = b.rows[PUSH, k], b.rows[FALL, k], lever(b, FORCE, k)
            inertia, impulse = b.rows[INERTIA, k], b.dt * b.rows[WEIGHT, k]
            for i in range(blocks):
                at = k * R + i
                (net, drag), old = net_force(q, k, at, across + i, arm), m[velocity + at]
                gain = push * net
                if gravity:
                    gain += fall
                new = advanced(b, old, gain)
                m[velocity + at] = new
                m[at] += b.dt * new
                if has_ledger:
                    q[BEFORE + at] = old
                if damped and has_ledger:
                    lost = inertia * (new - old) - (b.dt * net + impulse)
                    dissipate(ledger, i, lost * old, lost * new)
                if drags:
                    lost = b.dt * drag
                    dissipate(ledger, i, lost * old, lost * new)
        if finite:
            kick = b.rows[PUSH, 0] * b.mass  # dt, less by mass-proportional damping
            for i in range(blocks):
                momentum, torque = three(m, velocity + ABOUT_X, i), moments(q, FORCE, i)
                turned = (
                    advanced(b, momentum[0], kick * torque[0]),
                    advanced(b, momentum[1], kick * torque[1]),
                    advanced(b, momentum[2], kick * torque[2]),
                )
                if has_ledger:
                    spun = angular_velocity(b, m, i)
                    put_three(q, BEFORE + ABOUT_X + i, spun)
                put_three(m, velocity + ABOUT_X + i, turned)
                turn_by_momentum(b, m, i, turned)
                if drags or (damped and has_ledger):
                    spin = angular_velocity(b, m, i)
                if damped and has_ledger:
                    added = b.dt * torque[0], b.dt * torque[1], b.dt * torque[2]
                    taken = less(less(turned, momentum), added)
                    dissipate(ledger, i, dot(taken, spun), dot(taken, spin))
                if drags:
                    torque = moments(q, DRAG, i)
                    dissipate(ledger, i, b.dt * dot(torque, spun), b.dt * dot(torque, spin))

        if limit is not None and (n + 1) % CHECK == 0:
            for k in range(b.freedoms):
                out = 0
                for i in range(L):
                    out += not abs(m[velocity + k * R + i]) <= limit[k]
                if out > 0:
                    note(found, n + 1, SPEED, n - EVERY)
        if held:
            for e in range(sides):
                if (has_start and e == 0 and t == 0) or (has_end and e == 1 and final):
                    end, state, i, side = ends[e], end_states[e], 0, 1.0
                    start, moved, moving = stress, before, after
                    if e == 1:
                        i, side, start, moved, moving = blocks - 1, -1.0, 0.0, 0.0, 0.0
                    w, r, old, new = state[CLOSURE], state[REACTION], state[VELOCITY], state[MEAN]
                    put_velocity(b, new, m, i)
                    to_face(b, new, side)
                    for k in range(b.freedoms):
                        base = moving * end[BASE, k]
                        w[k] = end[DECAY, k] * w[k] + end[GAIN, k] * new[k] - base
                    if has_ledger:  # what the wall of a base takes is less by its work
                        for k in range(b.freedoms):
                            given = 0.5 * b.dt * (start * b.rows[DIRECTION, k] + end[STEADY, k])
                            taken, base = 0.5 * b.dt * r[k], 0.5 * r[k] * end[BASE, k]
                            ledger[WORK] += given * old[k] + base * moved
                            ledger[WORK + AFTER] += given * new[k] + base * moving
                            ledger[BOUNDARY] += base * moved - taken * old[k]
                            ledger[BOUNDARY + AFTER] += base * moving - taken * new[k]
        if sampled:
            for p in range(contacts, receivers):
                if places[0, p] == t:
                    for k in range(b.freedoms):
                        speed[p - contacts, k, s] += 0.5 * m[velocity + k * R + places[1, p]]

        if has_ledger and sampled:
            for k in range(b.freedoms):
                inertia = 0.5 if finite and k > 2 else 0.5 * b.rows[INERTIA, k]
                at = KINETIC if k < 3 else ROTATION
                for i in range(blocks):
                    ledger[at + i] += inertia * (q[BEFORE + k * R + i] * m[velocity + k * R + i])
        for kind in range(kinds):
            for k in range(b.freedoms):
                q[carry + 6 * kind + k] = q[kind * DRAG + k * R + L]

    return step
