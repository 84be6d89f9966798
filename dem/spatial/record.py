"""What a tile leaves of itself at a sample, and in the ledger at every step."""

from dem.spatial.book import (
    AFTER,
    BOUNDARY,
    BOUNDARY_AFTER,
    ELASTIC,
    FRACTURE,
    GRAVITY,
    KINETIC,
    ROTATION,
    VISCOUS,
    VISCOUS_AFTER,
    WORK,
    WORK_AFTER,
)
from dem.spatial.contact import law_at, whole_area
from dem.spatial.finite import (
    area_in_contact,
    finite_gap_at,
    finite_relative,
    finite_slip_at,
    three,
)
from dem.spatial.kinematics import gap_at, relative, shift, slip_at, turn
from dem.spatial.layout import LANES as L
from dem.spatial.layout import STRIDE as R
from dem.spatial.layout import first_opening, first_slide, velocities
from dem.spatial.motion import angular_velocity, finite_moment, net_force, net_moment, spin_of
from dem.spatial.scratch import BEFORE, DRAG, MOMENTA
from dem.spatial.vectors import dot, less, sum_of, times
from joints.energy import elastic_energy, fracture_energy_spent
from joints.jit import jitted
from joints.optional import either, given

NO_SPIN = (0.0, 0.0, 0.0)


@jitted
def keep_velocities(book, motion, half, s, q, n):
    """Keep the velocities before the step in the scratch, for the ledger."""
    if book is not None:
        for k in range(half):
            for i in range(min(n, L)):
                q[BEFORE + k * R + i] = s[(half + k) * R + i]
        keep_momenta(motion.finite, motion, s, q, n)


@jitted
def keep_momenta(finite, motion, s, q, n):
    """Tell angular velocity and angular momentum apart, where blocks turn by any angle."""
    if finite is not None:
        for i in range(min(n, L)):
            for k in range(3):
                q[MOMENTA + k * R + i] = s[(9 + k) * R + i]
            at = BEFORE + 3 * R + i
            q[at], q[at + R], q[at + 2 * R] = spin_of(motion, s, i)


@jitted
def book_states(model, book, table, s, h, n, final):
    """Book what a tile holds at a sample: in its joints and in gravity."""
    if book is not None:
        contact = model.contact
        joints = n - 1 if final else n
        book_section(contact, contact.section, table, book, s, joints)
        book_points(contact, contact.points, table, book, s, h, joints)
        book_weight(model.weight, book, s, n)


@jitted
def book_motion(model, state, book, drag, s, q, n, t, step, sampled):
    """Book what the step has done to a tile: viscous work, ends, load, and at a sample motion."""
    if book is not None:
        motion, rows = model.motion, model.contact.rows
        book_viscous(model.viscous, motion, rows, model.weight, drag, book, s, q, n)
        if t == 0:
            book_load(model.load, motion, book, s, q, step)
            book_base(model.load.base, model.start, state.start, book, step)
            book_end(model.start, state.start, motion, book, s, q, 0)
        if t == len(state.motion) - 1:
            book_end(model.end, state.end, motion, book, s, q, n - 1)
        if sampled:
            book_kinetic(motion, motion.arm, rows, book, s, q, n)


@jitted
def sample_before(receivers, samples, half, s, q, t, c):
    """Read forces, displacements and half the velocities of tile t for sample c."""
    for r in range(receivers.contact_tile.size):
        if receivers.contact_tile[r] == t:
            for k in range(half):
                samples.force[r, k, c] = q[k * R + receivers.contact_lane[r]]
    for r in range(receivers.block_tile.size):
        if receivers.block_tile[r] == t:
            lane = receivers.block_lane[r]
            for k in range(half):
                samples.displacement[r, k, c] = s[k * R + lane]
                samples.velocity[r, k, c] = 0.5 * s[(half + k) * R + lane]
            for k in range(half, samples.displacement.shape[1]):  # the scalar part of a quaternion
                samples.displacement[r, k, c] = s[(half + k) * R + lane]


@jitted
def sample_after(receivers, samples, half, s, t, c):
    """Add the other half of the velocities."""
    for r in range(receivers.block_tile.size):
        if receivers.block_tile[r] == t:
            for k in range(half):
                samples.velocity[r, k, c] += 0.5 * s[(half + k) * R + receivers.block_lane[r]]


@jitted
def book_kinetic(motion, arm, rows, book, s, q, n):
    """Book the kinetic energy in the form that leapfrog conserves: m v[n-1/2] v[n+1/2] / 2."""
    m, v = 0.5 * motion.mass, velocities(rows)
    for i in range(min(n, L)):
        book[KINETIC * R + i] += m * (
            q[BEFORE + i] * s[v + i]
            + q[BEFORE + R + i] * s[v + R + i]
            + q[BEFORE + 2 * R + i] * s[v + 2 * R + i]
        )
    either(motion.finite, book_rotation, book_spin)(motion, arm, book, s, q, n)


@jitted
def book_rotation(motion, arm, book, s, q, n):
    """Book the energy of rotation, where blocks turn."""
    if arm is not None:
        inertia = motion.inertia
        for i in range(min(n, L)):
            book[ROTATION * R + i] += 0.5 * (
                inertia[0] * q[BEFORE + 3 * R + i] * s[9 * R + i]
                + inertia[1] * q[BEFORE + 4 * R + i] * s[10 * R + i]
                + inertia[2] * q[BEFORE + 5 * R + i] * s[11 * R + i]
            )


@jitted
def book_spin(motion, arm, book, s, q, n):
    """Book the energy of rotation from angular velocity before and angular momentum after."""
    for i in range(min(n, L)):
        book[ROTATION * R + i] += 0.5 * dot(three(q, BEFORE // R + 3, i), three(s, 9, i))


@jitted
def book_weight(weight, book, s, n):
    """Book the potential energy in gravity, from the unloaded pillar on."""
    if weight is not None:
        for i in range(min(n, L)):
            book[GRAVITY * R + i] -= (
                weight[0] * s[i] + weight[1] * s[R + i] + weight[2] * s[2 * R + i]
            )


@jitted
def book_section(contact, section, table, book, s, n):
    """Book the energy of the first n joints, where they always hold."""
    if section is not None:
        arm = contact.arm
        for i in range(min(n, L)):
            law = law_at(contact.law, table, i)
            g, phi = shift(s, 0, i, arm), turn(s, 0, i, arm)
            k_n, k_s = 0.5 * law.normal_stiffness, 0.5 * law.shear_stiffness
            held = k_n * g[1] * g[1] + k_s * (g[0] * g[0] + g[2] * g[2])
            bent = k_n * (phi[0] * phi[0] + phi[2] * phi[2])
            twisted = k_s * phi[1] * phi[1]
            book[ELASTIC * R + i] += (
                section.area * held + section.across * bent + section.along * twisted
            )


@jitted
def book_points(contact, points, table, book, s, h, n):
    """Book what the first n joints hold and what they have spent, at every contact point."""
    if points is not None:
        arm, rows = contact.arm, contact.rows
        slides, openings = first_slide(rows), first_opening(rows)
        gap_of = either(contact.finite, gap_at, finite_gap_at)
        slip_of = either(contact.finite, slip_at, finite_slip_at)
        area_of = either(contact.finite, whole_area, area_in_contact)
        for i in range(min(n, L)):
            law = law_at(contact.law, table, i)
            motion = either(contact.finite, relative, finite_relative)(contact, s, h, i)
            for p in range(len(points.area)):
                x, z, area = points.x[p], points.z[p], points.area[p]
                gap = gap_of(arm, motion.g, motion.phi, x, z)
                opening = given(rows.openings, h[openings + p * L + i])
                slip = slip_of(arm, motion.g, motion.phi, x, z)
                at = slides + 2 * p * L + i
                area = area_of(contact, area, x, z, gap, slip)
                held = elastic_energy(law, gap, opening, slip[0] - h[at], slip[1] - h[at + L])
                book[ELASTIC * R + i] += area * held
                book_fracture(opening, book, i, area, law)


@jitted
def book_fracture(opening, book, i, area, law):
    """Book what opening has spent, with softening."""
    if opening is not None:
        book[FRACTURE * R + i] += area * fracture_energy_spent(law, opening)


@jitted
def book_viscous(viscous, motion, rows, weight, drag, book, s, q, n):
    """Book the work of dashpots, mass-proportional and local damping over both half steps."""
    if viscous is not None:
        v = len(rows.motion) // 2
        for i in range(min(n, L)):
            old, new = three(q, BEFORE // R, i), three(s, v, i)
            pull = sum_of(net_force(q, i), weighed(weight))
            gain = times(motion.mass, less(new, old))
            book_impulse(book, i, impulse(motion, dragged(drag, q, i), pull, gain), old, new)
        book_turn = either(motion.finite, book_viscous_turn, book_viscous_spin)
        book_turn(motion, motion.arm, drag, book, s, q, n)


@jitted
def book_viscous_turn(motion, arm, drag, book, s, q, n):
    """Book the work of the same moments, where blocks turn."""
    if arm is not None:
        about_x, about_y, about_z = motion.inertia
        for i in range(min(n, L)):
            old, new = three(q, BEFORE // R + 3, i), three(s, 9, i)
            more = less(new, old)
            gain = about_x * more[0], about_y * more[1], about_z * more[2]
            drags = dragged_round(drag, q, i, arm)
            book_impulse(book, i, impulse(motion, drags, net_moment(q, i, arm), gain), old, new)


@jitted
def book_viscous_spin(motion, arm, drag, book, s, q, n):
    """Book the work of the same moments, where blocks turn by any angle."""
    for i in range(min(n, L)):
        old, new = three(q, BEFORE // R + 3, i), spin_of(motion, s, i)
        gain = less(three(s, 9, i), three(q, MOMENTA // R, i))
        drags = spin_drag(drag, q, i, arm)
        book_impulse(book, i, impulse(motion, drags, finite_moment(q, i, arm), gain), old, new)


@jitted
def book_impulse(book, i, given_off, old, new):
    """Book the work of an impulse (N s) against the velocities before and after the step."""
    book[VISCOUS * R + i] -= 0.5 * dot(given_off, old)
    book[VISCOUS_AFTER * R + i] -= 0.5 * dot(given_off, new)


@jitted
def impulse(motion, drags, pull, gain):
    """Return the impulse of the dashpots, and of what damps a block itself: what its momentum's
    gain has less than the pull of everything else."""
    missing = less(gain, times(motion.dt, pull))
    return sum_of(times(motion.dt, drags), damped(motion.keep, motion.local, missing))


@jitted
def damped(keep, local, missing):
    """Return what is missing where a block is damped itself, else nothing: it is round-off."""
    if keep is None and local is None:
        return 0.0, 0.0, 0.0
    return missing


@jitted
def spin_drag(drag, q, i, arm):
    """Return the moment of the dashpots on a block that turns by any angle."""
    if drag is None:
        return 0.0, 0.0, 0.0
    return finite_moment(q, DRAG + i, arm)


@jitted
def dragged(drag, q, i):
    """Return the force of the dashpots on a block."""
    if drag is None:
        return 0.0, 0.0, 0.0
    return net_force(q, DRAG + i)


@jitted
def dragged_round(drag, q, i, arm):
    """Return the moment of the dashpots on a block."""
    if drag is None:
        return 0.0, 0.0, 0.0
    return net_moment(q, DRAG + i, arm)


@jitted
def weighed(weight):
    """Return a block's weight, N."""
    if weight is None:
        return 0.0, 0.0, 0.0
    return weight[0], weight[1], weight[2]


@jitted
def power(f, rows, i, arm, spin):
    """Return the power of a force and moment f at a face, from the block's velocity (rows of a
    tile) and angular velocity."""
    return (
        f[0] * rows[i] + f[1] * rows[R + i] + f[2] * rows[2 * R + i] + power_of_turn(f, arm, spin)
    )


@jitted
def power_of_turn(f, arm, spin):
    """Return the power that the rotation has in it; zero where blocks do not turn."""
    if arm is None:
        return 0.0
    return dot((f[3], f[4], f[5]), spin) + arm * (f[0] * spin[2] - f[2] * spin[0])


@jitted
def spins(motion, arm, s, q, i):
    """Return the angular velocity of a block before and after the step."""
    if arm is None:
        return NO_SPIN, NO_SPIN
    at = BEFORE + 3 * R + i
    after = either(motion.finite, angular_velocity, spin_of)(motion, s, i)
    return (q[at], q[at + R], q[at + 2 * R]), after


@jitted
def book_load(load, motion, book, s, q, n):
    """Book the work of the load on the start's face."""
    if n < load.stress.size:
        half = 0.5 * motion.dt * load.stress[n]
        f, arm, after = load.direction, motion.arm, s[load.direction.size * R :]
        old, new = spins(motion, arm, s, q, 0)
        book[WORK * R] += half * power(f, q[BEFORE:], 0, arm, old)
        book[WORK_AFTER * R] += half * power(f, after, 0, arm, new)


@jitted
def book_end(end, state, motion, book, s, q, i):
    """Book the work done on an end, and that of what acts there all the time."""
    if end is not None:
        half, before, after = 0.5 * motion.dt, q[BEFORE:], s[state.closure.size * R :]
        arm, (old, new) = end.arm, spins(motion, end.arm, s, q, i)
        book[BOUNDARY * R] -= half * power(state.reaction, before, i, arm, old)
        book[BOUNDARY_AFTER * R] -= half * power(state.reaction, after, i, arm, new)
        book[WORK * R] += half * power(end.steady, before, i, arm, old)
        book[WORK_AFTER * R] += half * power(end.steady, after, i, arm, new)


@jitted
def book_base(base, end, state, book, n):
    """Book the work of a shaken base; what its wall takes is less by as much."""
    if base is not None:
        push = 0.5 * (state.reaction * end.base).sum()
        for account, way in ((0, base[n]), (AFTER, base[n + 1])):
            book[(WORK + account) * R] += push * way
            book[(BOUNDARY + account) * R] += push * way
