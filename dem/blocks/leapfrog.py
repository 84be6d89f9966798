"""Leapfrog steps of rigid blocks in the plane: forces of the joints, then motion of the blocks.

Displacements live at whole steps, velocities half a step before; dashpots of joints see rates that
are extrapolated to the whole step, those beyond the domain the mean of both half steps. The ledger
is exact at a step of any length: the work of a force from one whole step to the next is the mean of
its two values times the displacement increment, the kinetic energy v[n-1/2] M v[n+1/2] / 2.

A contact's force is written once and read by both its blocks, in the order of the contacts: every
block does the same arithmetic however blocks are dealt out. The ledger is summed in chunks of as
many contacts or blocks each, and these in their order. So results are bit-identical for any number
of threads, which share the chunks and wait for one another after the forces and after the motion.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from math import copysign
from typing import Any, NamedTuple

import numpy as np

from dem.blocks.model import (
    BENDING,
    F_X,
    F_Y,
    I_X,
    I_Y,
    J_X,
    J_Y,
    LENGTH,
    N_X,
    N_Y,
    ON_I,
    ON_J,
    STRETCH,
    PlaneForm,
    PlaneModel,
    PlaneState,
)
from joints.dilation import lift
from joints.energy import elastic_energy, fracture_energy_spent, friction_work, lift_work
from joints.formula import formula
from joints.law import law_of
from joints.normal import normal_traction, spring_traction
from joints.shear import cohesion_left, shear_return, shear_strength
from joints.slide import after_slide
from numerics.atomic import wait_for_all
from numerics.borrowed import borrowed
from numerics.denormals import flush_tiny, restore_tiny
from numerics.jit import jitted_for

#: Columns of a point's history: what has slid, the largest opening, the cohesion and the path.
SLID, OPENING, COHESION, PATH = range(4)
#: Rows of a contact's samples: F on block j, M and the sum of e L w t_s, opening and slip.
FORCE_X, FORCE_Y, BEND, ALONG, GAP, SLIP = range(6)
CONTACT_ROWS = 6
CHUNK = 256  # contacts, or blocks, that one thread takes in one piece
#: What chunks of contacts and of blocks add to the ledger in a step.
SHARES = 12
#: Running sums of the ledger.
VISCOUS, FRICTION, BOUNDARY, WORK = range(4)
#: Terms of the ledger at a sample, in the order of their rows.
TERMS = (
    "kinetic", "elastic", "viscous", "friction", "fracture", "boundary", "gravity", "work",
)  # fmt: skip


@formula
def relative(x, i, j, k):
    """Return opening, slip and turn of block j against block i at the centre of contact k."""
    n_x, n_y = k[N_X], k[N_Y]
    along_x = (x[j, 0] - x[j, 2] * k[J_Y]) - (x[i, 0] - x[i, 2] * k[I_Y])
    along_y = (x[j, 1] + x[j, 2] * k[J_X]) - (x[i, 1] + x[i, 2] * k[I_X])
    return n_x * along_x + n_y * along_y, n_x * along_y - n_y * along_x, x[j, 2] - x[i, 2]


class PlaneSamples(NamedTuple):
    """What is recorded: displacement and velocity of blocks [place, 3, sample], m and m/s, rad and
    rad/s, force, opening and slip of contacts [watched, CONTACT_ROWS, sample], and the ledger
    [term, sample], J; None without."""

    displacement: np.ndarray
    velocity: np.ndarray
    contact: np.ndarray
    energy: Any


def samples_for(model: PlaneModel, count: int) -> PlaneSamples:
    """Return room for so many samples."""
    displacement, velocity = np.zeros((2, len(model.places), 3, count))
    contact = np.zeros((len(model.watched), CONTACT_ROWS, count))
    energy = np.zeros((len(TERMS), count)) if model.form.ledger else None
    return PlaneSamples(displacement, velocity, contact, energy)


def march(
    model: PlaneModel,
    state: PlaneState,
    samples: PlaneSamples,
    stride: int,
    steps: tuple[int, int],
    drive: np.ndarray | None = None,
    shake: np.ndarray | None = None,
    threads: int = 1,
) -> None:
    """Take the steps first .. last - 1, with the samples that fall on them, `stride` steps apart.

    drive : float array [last - first, h, 3], N and N m, what acts on held blocks in each step.
    shake : float array [last - first, walls, 2], the velocity of walls in each step, m/s.
    """
    form, b, contacts, (first, last) = model.form, model.blocks, model.contacts, steps
    held = model.held or (None, None, None, None)
    if model.held is not None and drive is None:
        drive = np.zeros((last - first, len(model.held.dashpot), 3))
    shares = None
    if form.ledger:
        most = max(len(contacts.blocks), len(b.inertia))
        shares = np.zeros((2, -(-most // CHUNK), SHARES))
    progress = np.zeros(threads, dtype=np.int64)
    loop = loop_for(form)

    def share(thread: int) -> None:
        loop(
            *contacts, *model.adjacency, b.inertia, model.laws,
            model.rules, *held, *state, drive, shake, model.places, model.watched, *samples,
            b.dt, b.keep, b.local, b.gravity_x, b.gravity_y, first, last, -(-first // stride),
            stride, shares, progress, thread, threads,
        )  # fmt: skip

    if threads == 1 or first == last:  # nothing to take: compiles
        share(0)
        return
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(share, range(threads)))


@cache
def loop_for(form: PlaneForm) -> Callable:
    """Return the time loop of rock masses with these effects: what they lack is not compiled."""
    parts, points = form.parts, form.points
    dashpots, varied, softening = parts.dashpots, parts.varied, parts.softening
    residual, worn, dilation = parts.residual, parts.path, parts.dilation
    held, ledger = form.held, form.ledger
    ruled, stressed, shaken = form.ruled, form.stressed, form.shaken
    mass_damping, local_damping = form.mass_damping or form.relaxed, form.local_damping
    damped, drags = form.mass_damping or form.local_damping, form.parts.dashpots and form.ledger
    gravity = form.gravity

    @jitted_for(form)
    def loop(
        pair, table, law_index, start, first_side, side, inertia, laws, rules, row, keeps, moves,
        dashpot, u, v, force, rates, drag, history, sums, drive, shake, places, watched,
        displacement, velocity, contact, energy, dt, keep, local, g_x, g_y, first, last, s, stride,
        shares, progress, thread, threads,
    ):  # fmt: skip
        """Take this thread's share of steps first .. last - 1, and sample s at step s * stride.

        drive : float array [last - first, h, 3], forces and moments on held blocks. shares : float
        array [2, chunks, SHARES], of the ledger, in steps of even and of odd number. progress :
        int64 array [threads], zero at first. The rest are the arrays of `dem.blocks.model`, None
        for what the form does not have.
        """
        tiny = flush_tiny()
        # Rows of counted arrays would each cost two atomic operations.
        table, force, rates, drag, history = borrowed((table, force, rates, drag, history))
        row, keeps, moves, dashpot, drive = borrowed((row, keeps, moves, dashpot, drive))
        law, rule, second = law_of(laws, 0), rules[0], 0.0
        push = 0.5 * dt * (1.0 + keep)  # dt without mass damping
        for p in range(rules.shape[2]):
            second += rule[1, p] * rule[0, p] * rule[0, p]
        pieces, met = (len(pair) + CHUNK - 1) // CHUNK, 0
        from_contact = CHUNK * (pieces * thread // threads)
        to_contact = min(CHUNK * (pieces * (thread + 1) // threads), len(pair))
        pieces = (len(inertia) + CHUNK - 1) // CHUNK
        from_block = CHUNK * (pieces * thread // threads)
        to_block = min(CHUNK * (pieces * (thread + 1) // threads), len(inertia))
        for n in range(first, last):
            sampled = n == s * stride
            elastic, fracture, viscous, friction = 0.0, 0.0, 0.0, 0.0
            if sampled and thread == 0:
                # Nothing moves before all forces are there.
                for r in range(len(places)):
                    for q in range(3):
                        displacement[r, q, s] = u[places[r], q]
                        velocity[r, q, s] = 0.5 * v[places[r], q]
                for r in range(len(watched)):
                    seen = watched[r]
                    gap, slip, _ = relative(u, pair[seen, 0], pair[seen, 1], table[seen])
                    contact[r, GAP, s], contact[r, SLIP, s] = gap, slip

            # Forces of the joints.
            # Unsigned: an index that may be below zero is looked at, from the end.
            for c in range(np.uintp(from_contact), np.uintp(to_contact)):
                i, j, k = pair[c, 0], pair[c, 1], table[c]
                if varied:
                    law = law_of(laws, law_index[c])
                if ruled:
                    rule, second = rules[law_index[c]], 0.0
                    for p in range(rules.shape[2]):
                        second += rule[1, p] * rule[0, p] * rule[0, p]
                length = k[LENGTH]
                bend = length * length * length * second
                gap, slip, turn = relative(u, i, j, k)
                if stressed:
                    gap, slip = gap + start[c, 0], slip + start[c, 1]
                rate, slip_rate, spin, slide = 0.0, 0.0, 0.0, 0.0
                if dashpots or points > 0:
                    rate, slip_rate, spin = relative(v, i, j, k)
                    slide = dt * slip_rate
                opening_rate, turning = rate, spin
                if dashpots:
                    last_rate = rates[c]
                    if drags:
                        last_drag = drag[c]
                        work = last_drag[0] * rate + last_drag[1] * slip_rate
                        viscous -= 0.5 * dt * (work + last_drag[2] * spin)
                    now, slip_now = 1.5 * rate - 0.5 * last_rate[0], 1.5 * slip_rate
                    slip_now, spin_now = slip_now - 0.5 * last_rate[1], 1.5 * spin
                    spin_now -= 0.5 * last_rate[2]
                    before, slip_before, spin_before = rate, slip_rate, spin
                    last_rate[0], last_rate[1], last_rate[2] = rate, slip_rate, spin
                    rate, slip_rate, spin = now, slip_now, spin_now
                f_n, f_s, moment, stretch = 0.0, 0.0, 0.0, 0.0
                d_n, d_s, d_m = 0.0, 0.0, 0.0
                if points == 0:
                    f_n = -law.normal_stiffness * length * gap
                    f_s = -law.shear_stiffness * length * slip
                    moment = -law.normal_stiffness * bend * turn
                    if ledger and sampled:
                        elastic -= 0.5 * (f_n * gap + f_s * slip + moment * turn)
                    if dashpots:
                        d_n = -law.normal_viscosity * length * rate
                        d_s = -law.shear_viscosity * length * slip_rate
                        d_m = -law.normal_viscosity * bend * spin
                        f_n, f_s, moment = f_n + d_n, f_s + d_s, moment + d_m
                else:
                    for p in range(points):
                        e, share, own = rule[0, p] * length, rule[1, p] * length, history[c, p]
                        here, here_rate = gap - e * turn, rate - e * spin
                        opening, cohesion, path = 0.0, 0.0, 0.0
                        if worn:
                            path = own[PATH]
                        if dilation:
                            here = here - lift(law, path)
                        if softening:
                            opening = max(own[OPENING], here)
                            own[OPENING] = opening
                        if residual:
                            cohesion = own[COHESION]
                        t_n = normal_traction(law, parts, here, here_rate, opening)
                        tau = shear_strength(law, parts, t_n, here, opening, cohesion, path)
                        ex = slip - own[SLID]
                        old = ex - slide
                        if worn:
                            t_n, tau, further = after_slide(
                                law, parts, t_n, tau, here, here_rate, opening, cohesion, path,
                                ex, 0.0, slip_rate, 0.0, dt,
                            )  # fmt: skip
                            own[PATH] = further
                            if dilation:
                                up = lift(law, further) - lift(law, path)
                                if ledger:
                                    moved = opening_rate - e * turning
                                    friction -= share * lift_work(
                                        law, parts, here - dt * moved, here - up, opening, up
                                    )
                                here = here - up
                        t_s, _, left, _, slipped = shear_return(
                            law, parts, ex, 0.0, old, 0.0, slip_rate, 0.0, tau, dt
                        )
                        if slipped:
                            own[SLID] = slip - left
                            if residual:
                                own[COHESION] = cohesion_left(law, parts, cohesion, slipped)
                        if ledger:
                            friction += share * friction_work(law, old, 0.0, left, 0.0, slide, 0.0)
                            if drags:
                                spring = spring_traction(law, parts, here, opening)
                                d_n += share * (t_n - spring)
                                d_m -= e * share * (t_n - spring)
                                d_s += share * (t_s + law.shear_stiffness * left)
                            if sampled:
                                elastic += share * elastic_energy(
                                    law, parts, here, opening, left, 0.0
                                )
                                if softening:
                                    fracture += share * fracture_energy_spent(law, opening)
                        f_n, f_s = f_n + share * t_n, f_s + share * t_s
                        moment, stretch = moment - e * share * t_n, stretch + e * share * t_s
                if drags:
                    last_drag = drag[c]
                    last_drag[0], last_drag[1], last_drag[2] = d_n, d_s, d_m
                    work = d_n * before + d_s * slip_before + d_m * spin_before
                    viscous -= 0.5 * dt * work
                f_x, f_y = k[N_X] * f_n - k[N_Y] * f_s, k[N_Y] * f_n + k[N_X] * f_s
                f = force[c]
                f[F_X], f[F_Y], f[BENDING], f[STRETCH] = f_x, f_y, moment, stretch
                f[ON_J] = moment + (k[J_X] * f_y - k[J_Y] * f_x)
                f[ON_I] = moment + (k[I_X] * f_y - k[I_Y] * f_x)
                done = np.intp(c) + 1
                if ledger and (done % CHUNK == 0 or done == to_contact):
                    own_share = shares[n & 1, (done - 1) // CHUNK]
                    own_share[0], own_share[1] = elastic, fracture
                    own_share[2], own_share[3] = viscous, friction
                    elastic, fracture, viscous, friction = 0.0, 0.0, 0.0, 0.0

            if threads > 1:
                met = wait_for_all(progress, thread, met)
            if sampled and thread == 0:
                for r in range(len(watched)):
                    f, own_samples = force[watched[r]], contact[r]
                    own_samples[FORCE_X, s], own_samples[FORCE_Y, s] = f[F_X], f[F_Y]
                    own_samples[BEND, s], own_samples[ALONG, s] = f[BENDING], f[STRETCH]

            # Motion of the blocks.
            kinetic, potential, behind = 0.0, 0.0, 0.0
            boundary, boundary_behind, given, given_behind = 0.0, 0.0, 0.0, 0.0
            for b in range(np.uintp(from_block), np.uintp(to_block)):
                f_x, f_y, moment = 0.0, 0.0, 0.0
                for a in range(first_side[b], first_side[b + np.uintp(1)]):
                    f = force[side[a] >> 1]
                    if side[a] & 1:
                        f_x, f_y, moment = f_x + f[F_X], f_y + f[F_Y], moment + f[ON_J]
                    else:
                        f_x, f_y, moment = f_x - f[F_X], f_y - f[F_Y], moment - f[ON_I]
                mass, about = inertia[b, 0], inertia[b, 1]
                if gravity:
                    f_x, f_y = f_x + mass * g_x, f_y + mass * g_y
                    if sampled:
                        potential -= mass * (g_x * u[b, 0] + g_y * u[b, 1])
                h = -1
                if held:
                    h = row[b]
                    if h >= 0:
                        own_drive = drive[n - first, h]
                        f_x, f_y = f_x + own_drive[0], f_y + own_drive[1]
                        moment += own_drive[2]
                v_x, v_y, spin = v[b, 0], v[b, 1], v[b, 2]
                p_x, p_y, p_m = push * f_x, push * f_y, push * moment
                if local_damping:
                    if v_x != 0.0:
                        p_x -= local * copysign(abs(p_x), v_x)
                    if v_y != 0.0:
                        p_y -= local * copysign(abs(p_y), v_y)
                    if spin != 0.0:
                        p_m -= local * copysign(abs(p_m), spin)
                new_x, new_y, new_spin = v_x, v_y, spin
                if mass_damping:
                    new_x, new_y, new_spin = keep * v_x, keep * v_y, keep * spin
                new_x, new_y = new_x + p_x / mass, new_y + p_y / mass
                new_spin += p_m / about
                if held and h >= 0:
                    # The velocity without its dashpots, then what they take of it.
                    w, m = keeps[h], moves[h]
                    a_x, a_y, a_m = new_x, new_y, new_spin
                    new_x = w[0, 0] * v_x + w[0, 1] * v_y + w[0, 2] * spin
                    new_y = w[1, 0] * v_x + w[1, 1] * v_y + w[1, 2] * spin
                    new_spin = w[2, 0] * v_x + w[2, 1] * v_y + w[2, 2] * spin
                    new_x += m[0, 0] * a_x + m[0, 1] * a_y + m[0, 2] * a_m
                    new_y += m[1, 0] * a_x + m[1, 1] * a_y + m[1, 2] * a_m
                    new_spin += m[2, 0] * a_x + m[2, 1] * a_y + m[2, 2] * a_m
                if ledger:
                    if sampled:
                        kinetic += 0.5 * mass * (v_x * new_x + v_y * new_y)
                        kinetic += 0.5 * about * spin * new_spin
                    r_x, r_y, r_m = 0.0, 0.0, 0.0
                    if held and h >= 0:
                        d = dashpot[h]
                        both_x, both_y = 0.5 * (v_x + new_x), 0.5 * (v_y + new_y)
                        both = 0.5 * (spin + new_spin)
                        r_x = -(d[0, 0] * both_x + d[0, 1] * both_y + d[0, 2] * both)
                        r_y = -(d[1, 0] * both_x + d[1, 1] * both_y + d[1, 2] * both)
                        r_m = -(d[2, 0] * both_x + d[2, 1] * both_y + d[2, 2] * both)
                        boundary -= 0.5 * dt * (r_x * v_x + r_y * v_y + r_m * spin)
                        boundary_behind -= 0.5 * dt * (r_x * new_x + r_y * new_y + r_m * new_spin)
                        own_drive = drive[n - first, h]
                        a_x, a_y, a_m = own_drive[0], own_drive[1], own_drive[2]
                        given += 0.5 * dt * (a_x * v_x + a_y * v_y + a_m * spin)
                        given_behind += 0.5 * dt * (a_x * new_x + a_y * new_y + a_m * new_spin)
                    if damped:
                        # What is missing in the block's momentum.
                        lost_x = mass * (new_x - v_x) - dt * (f_x + r_x)
                        lost_y = mass * (new_y - v_y) - dt * (f_y + r_y)
                        lost_m = about * (new_spin - spin) - dt * (moment + r_m)
                        viscous -= 0.5 * (lost_x * v_x + lost_y * v_y + lost_m * spin)
                        behind -= 0.5 * (lost_x * new_x + lost_y * new_y + lost_m * new_spin)
                v[b, 0], v[b, 1], v[b, 2] = new_x, new_y, new_spin
                u[b, 0] += dt * new_x
                u[b, 1] += dt * new_y
                u[b, 2] += dt * new_spin
                done = np.intp(b) + 1
                if ledger and (done % CHUNK == 0 or done == to_block):
                    own_share = shares[n & 1, (done - 1) // CHUNK]
                    own_share[4], own_share[5], own_share[6] = kinetic, potential, viscous
                    own_share[7], own_share[8], own_share[9] = behind, boundary, boundary_behind
                    own_share[10], own_share[11] = given, given_behind
                    kinetic, potential, viscous, behind = 0.0, 0.0, 0.0, 0.0
                    boundary, boundary_behind, given, given_behind = 0.0, 0.0, 0.0, 0.0

            if shaken and thread == 0:
                for w in range(shake.shape[1]):
                    wall = len(inertia) + w
                    own_shake = shake[n - first, w]
                    if ledger:
                        # What moves a wall works against the joints.
                        f_x, f_y = 0.0, 0.0
                        for a in range(first_side[wall], first_side[wall + 1]):
                            f = force[side[a] >> 1]
                            f_x, f_y = f_x + f[F_X], f_y + f[F_Y]
                        given -= 0.5 * dt * (f_x * v[wall, 0] + f_y * v[wall, 1])
                        given_behind -= 0.5 * dt * (f_x * own_shake[0] + f_y * own_shake[1])
                    for q in range(2):
                        v[wall, q] = own_shake[q]
                        u[wall, q] += dt * own_shake[q]

            if threads > 1:
                met = wait_for_all(progress, thread, met)
            if ledger and thread == 0:
                total = shares[n & 1, 0]
                for piece in range(1, shares.shape[1]):
                    for q in range(SHARES):
                        total[q] += shares[n & 1, piece, q]
                sums[VISCOUS] += total[2] + total[6]
                sums[FRICTION] += total[3]
                sums[BOUNDARY] += total[8]
                sums[WORK] += total[10] + given
            if sampled:
                if thread == 0:
                    for r in range(len(places)):
                        for q in range(3):
                            velocity[r, q, s] += 0.5 * v[places[r], q]
                    if ledger:
                        energy[0, s], energy[1, s], energy[2, s] = total[4], total[0], sums[VISCOUS]
                        energy[3, s], energy[4, s] = sums[FRICTION], total[1]
                        energy[5, s], energy[6, s] = sums[BOUNDARY], total[5]
                        energy[7, s] = sums[WORK]
                s += 1
            if ledger and thread == 0:
                sums[VISCOUS] += total[7]
                sums[BOUNDARY] += total[9]
                sums[WORK] += total[11] + given_behind
        restore_tiny(tiny)

    return loop
