"""One leapfrog step of one tile of blocks: forces of its contacts, then motion of its blocks.

Displacements live at whole steps, velocities half a step before; dashpots of joints see rates that
are extrapolated to the whole step, those beyond the domain the mean of both half steps. The ledger
is exact at a step of any length: the work of a force from one whole step to the next is the mean of
its two values times the displacement increment, the kinetic energy v[n-1/2] M v[n+1/2] / 2. So a
force works over the half step before it and over the one after it, which are accounted for apart.

Contacts are worked on side by side, in lanes: a buffer takes what is gathered from their blocks,
and their forces are added to the blocks one after the other, always in the same order.
"""

from collections.abc import Callable
from math import copysign
from typing import Any

from jointwave.dem.blocks.model import KernelFlags
from jointwave.dem.blocks.tiles import I_N, I_T, J_N, J_T, LENGTH, N_X, N_Y, START
from jointwave.dem.blocks.tiles import LANES as L
from jointwave.joints.dilation import lift
from jointwave.joints.energy import elastic_energy, fracture_energy_spent, friction_work, lift_work
from jointwave.joints.formula import formula
from jointwave.joints.law import law_of
from jointwave.joints.normal import normal_traction, spring_traction
from jointwave.joints.shear import cohesion_left, planar_return, shear_strength
from jointwave.joints.slide import after_slide

#: Rows of a contact's samples: F on block j, M and the sum of e L w t_s, opening and slip.
FORCE_X, FORCE_Y, BEND, ALONG, GAP, SLIP = range(6)
CONTACT_ROWS = 6
#: Rows of a chunk's buffer: opening, slip and turn at the step, their rates half a step before and
#: now; force along n and t, M and the sum of e L w t_s; the dashpots' share of the first three;
#: force along x and y, moments about the centroids. Then velocities of the tile before the step.
MOVED, RATE, NOW = range(0, 9 * L, 3 * L)
F_N, F_T, MOMENT, STRETCH, D_N, D_T, D_M, F_X, F_Y, ON_I, ON_J = range(9 * L, 20 * L, L)
BEFORE = 20 * L
#: Rows of the ledger of one step, J in lanes, in the order of `results.rock_mass.TERMS`, and AFTER
#: further on what is added behind the step.
KINETIC, ELASTIC, VISCOUS, FRICTION, FRACTURE, BOUNDARY, GRAVITY, WORK = range(0, 8 * L, L)
AFTER = 8 * L
SUMMED = VISCOUS, FRICTION, BOUNDARY, WORK  # the others are states


@formula
def relative(x, y, turn_i, turn_j, n_x, n_y, i_n, i_t, j_n, j_t):
    """Return opening, slip and turn of block j against block i at the centre of a contact.

    x, y : motion of the centroid of j less that of i. The rest are rows of the table of contacts.
    """
    opening = n_x * x + n_y * y + (j_n * turn_j - i_n * turn_i)
    return opening, n_x * y - n_y * x + (j_t * turn_j - i_t * turn_i), turn_j - turn_i


def step_for(form: KernelFlags) -> Callable:
    """Return the formula of one step of one tile: what its form lacks is not compiled."""
    parts, points, by_points = form.parts, form.points, form.points > 0
    dashpots, varied, softening = parts.dashpots, parts.varied, parts.softening
    residual, path_dependent, dilation = parts.residual, parts.path, parts.dilation
    held, has_ledger, gravity = form.held, form.ledger, form.gravity
    ruled, stressed, shaken = form.ruled, form.stressed, form.shaken
    mass_damping, local_damping = form.mass_damping or form.relaxed, form.local_damping
    damped, drags = form.mass_damping or form.local_damping, dashpots and has_ledger
    rated, now = (
        dashpots or (by_points and (has_ledger or path_dependent)),
        NOW if dashpots else RATE,
    )
    remembers, bend = form.rate_rows + form.point_rows > 0, L * form.bend_row
    first_point, point_rows = L * form.rate_rows, L * form.point_rows
    cohesions, paths = (1 + softening) * L, (1 + softening + residual) * L

    @formula
    def at_start(k, row, c):
        """Return opening or slip that stand for what a contact carries at first."""
        return k[(START + row) * L + c] if stressed else 0.0

    @formula
    def step(
        pair, table, laws, rules, first_chunk, first_block, inertia, inverse, first_held, block,
        keeps, moves, dashpot, u, v, history, drive, walls, force, first_place, place, place_row,
        first_seen, seen, seen_row, displacement, velocity, samples, ledger, q, count, last, dt,
        keep, local, g_x, g_y, t, n, sampled, s,
    ):  # fmt: skip
        """Advance tile t by a step.

        count : of contacts. last : three times the number of blocks. n : of the step in `drive` and
        `walls`. s : of the sample. ledger : of this step. q : a buffer. The rest is what
        the loop of `dem.blocks.leapfrog` takes.
        """
        common, still, pushed = law_of(laws, 0), last - 3, 0.5 * dt * (1.0 + keep)
        weighed = 1.0 if sampled else 0.0  # states are summed at samples alone
        for g in range(first_chunk[t], first_chunk[t + 1]):
            k, at = table[g], pair[g]
            h: Any = None
            if remembers:
                h = history[g]

            # Relative motion of the contacts; a formula that took a pointer would not be gathered.
            for c in range(L):
                i, j, w = at[c], at[L + c], 0
                n_x, n_y, i_n, i_t = k[N_X * L + c], k[N_Y * L + c], k[I_N * L + c], k[I_T * L + c]
                j_n, j_t, x, y = k[J_N * L + c], k[J_T * L + c], u[j], u[j + 1]
                if shaken:
                    w = j - still if j > still else 0
                    x, y = walls[n, 0, w] if w > 0 else x, walls[n, 0, w + 1] if w > 0 else y
                x, y = x - u[i], y - u[i + 1]
                gap, slip, turn = relative(x, y, u[i + 2], u[j + 2], n_x, n_y, i_n, i_t, j_n, j_t)
                q[MOVED + c], q[MOVED + L + c], q[MOVED + 2 * L + c] = gap, slip, turn
                if rated:
                    x, y = v[j], v[j + 1]
                    if shaken:
                        x, y = walls[n, 1, w] if w > 0 else x, walls[n, 1, w + 1] if w > 0 else y
                    x, y = x - v[i], y - v[i + 1]
                    gap, slip, turn = relative(
                        x, y, v[i + 2], v[j + 2], n_x, n_y, i_n, i_t, j_n, j_t
                    )
                    q[RATE + c], q[RATE + L + c], q[RATE + 2 * L + c] = gap, slip, turn
            if dashpots:
                for r in range(3):
                    for c in range(r * L, r * L + L):
                        rate, before = q[RATE + c], h[c]
                        if drags:
                            ledger[VISCOUS + c - r * L] -= 0.5 * dt * (h[3 * L + c] * rate)
                        q[NOW + c], h[c] = 1.5 * rate - 0.5 * before, rate

            # Forces of points one by one, where joints can fail.
            if by_points:
                for c in range(F_N, F_X if drags else D_N):
                    q[c] = 0.0
                for p in range(points):
                    past = first_point + p * point_rows
                    for c in range(L):
                        law = law_of(laws, at[2 * L + c]) if varied else common
                        rule, length = at[2 * L + c] if ruled else 0, k[LENGTH * L + c]
                        e, share = rules[rule, 0, p] * length, rules[rule, 1, p] * length
                        gap = q[MOVED + c] + at_start(k, 0, c) - e * q[MOVED + 2 * L + c]
                        slip = q[MOVED + L + c] + at_start(k, 1, c)
                        rate, slip_rate, moved, slide = 0.0, 0.0, 0.0, 0.0
                        if rated:
                            rate, slip_rate = q[now + c] - e * q[now + 2 * L + c], q[now + L + c]
                            moved = dt * (q[RATE + c] - e * q[RATE + 2 * L + c])
                            slide = dt * q[RATE + L + c]
                        opening, cohesion, path = 0.0, 0.0, 0.0
                        if path_dependent:
                            path = h[past + paths + c]
                        if dilation:
                            gap = gap - lift(law, path)
                        if softening:
                            opening = h[past + L + c]
                            opening = gap if gap > opening else opening
                            h[past + L + c] = opening
                        if residual:
                            cohesion = h[past + cohesions + c]
                        t_n = normal_traction(law, parts, gap, rate, opening)
                        tau = shear_strength(law, parts, t_n, gap, opening, cohesion, path)
                        slid = h[past + c]
                        ex, old = slip - slid, slip - slid - slide
                        if path_dependent:
                            t_n, tau, further = after_slide(
                                law, parts, t_n, tau, gap, rate, opening, cohesion, path,
                                ex, 0.0, slip_rate, 0.0, dt,
                            )  # fmt: skip
                            h[past + paths + c] = further
                            if dilation:
                                up = lift(law, further) - lift(law, path)
                                if has_ledger:
                                    ledger[FRICTION + c] -= share * lift_work(
                                        law, parts, gap - moved, gap - up, opening, up
                                    )
                                gap = gap - up
                        t_t, left, slipped = planar_return(law, parts, ex, old, slip_rate, tau, dt)
                        h[past + c] = slip - left if slipped else slid
                        if residual:
                            h[past + cohesions + c] = cohesion_left(law, parts, cohesion, slipped)
                        if has_ledger:
                            work = friction_work(law, old, 0.0, left, 0.0, slide, 0.0)
                            ledger[FRICTION + c] += share * work
                            stored = elastic_energy(law, parts, gap, opening, left, 0.0)
                            ledger[ELASTIC + c] += weighed * share * stored
                            if softening:
                                spent = fracture_energy_spent(law, opening)
                                ledger[FRACTURE + c] += weighed * share * spent
                        if drags:  # what is not the springs'
                            spring = spring_traction(law, parts, gap, opening)
                            q[D_N + c] += share * (t_n - spring)
                            q[D_T + c] += share * (t_t + law.shear_stiffness * left)
                            q[D_M + c] -= e * share * (t_n - spring)
                        q[F_N + c] += share * t_n
                        q[F_T + c] += share * t_t
                        q[MOMENT + c] -= e * share * t_n
                        q[STRETCH + c] += e * share * t_t

            # What acts on their blocks; joints that always hold need no points.
            for c in range(L):
                if by_points:
                    f_n, f_t, moment = q[F_N + c], q[F_T + c], q[MOMENT + c]
                else:
                    law = law_of(laws, at[2 * L + c]) if varied else common
                    length, second = k[LENGTH * L + c], k[bend + c]
                    gap, slip = (
                        q[MOVED + c] + at_start(k, 0, c),
                        q[MOVED + L + c] + at_start(k, 1, c),
                    )
                    k_n, k_t, turn = law.normal_stiffness, law.shear_stiffness, q[MOVED + 2 * L + c]
                    f_n, f_t, moment = (
                        -k_n * length * gap,
                        -k_t * length * slip,
                        -k_n * second * turn,
                    )
                    if has_ledger and sampled:
                        ledger[ELASTIC + c] -= 0.5 * (f_n * gap + f_t * slip + moment * turn)
                    if dashpots:
                        eta_n, eta_t = law.normal_viscosity, law.shear_viscosity
                        d_n, d_t = -eta_n * length * q[NOW + c], -eta_t * length * q[NOW + L + c]
                        d_m = -eta_n * second * q[NOW + 2 * L + c]
                        f_n, f_t, moment = f_n + d_n, f_t + d_t, moment + d_m
                        if drags:
                            q[D_N + c], q[D_T + c], q[D_M + c] = d_n, d_t, d_m
                    q[MOMENT + c] = moment
                n_x, n_y = k[N_X * L + c], k[N_Y * L + c]
                q[F_X + c], q[F_Y + c] = n_x * f_n - n_y * f_t, n_y * f_n + n_x * f_t
                q[ON_I + c] = moment + (k[I_N * L + c] * f_n + k[I_T * L + c] * f_t)
                q[ON_J + c] = moment + (k[J_N * L + c] * f_n + k[J_T * L + c] * f_t)
            if drags:
                for r in range(3):
                    for c in range(r * L, r * L + L):
                        ledger[VISCOUS + c - r * L] -= 0.5 * dt * (q[D_N + c] * q[RATE + c])
                        h[3 * L + c] = q[D_N + c]
            lanes = count - g * L
            for c in range(lanes if lanes < L else L):
                i, j = at[c], at[L + c]
                force[i] -= q[F_X + c]
                force[i + 1] -= q[F_Y + c]
                force[i + 2] -= q[ON_I + c]
                if j < last:
                    force[j] += q[F_X + c]
                    force[j + 1] += q[F_Y + c]
                    force[j + 2] += q[ON_J + c]
                elif shaken and has_ledger:  # what moves a wall works against the joints
                    for r in range(2):
                        f, w = 0.5 * dt * q[F_X + r * L + c], j - still + r
                        ledger[WORK + c] -= f * walls[n, 1, w]
                        ledger[WORK + AFTER + c] -= f * walls[n + 1, 1, w]
            if sampled:
                for r in range(first_seen[t], first_seen[t + 1]):
                    c, row = seen[r] - g * L, seen_row[r]
                    if c >= 0 and c < L:
                        samples[row, FORCE_X, s] = q[F_X + c]
                        samples[row, FORCE_Y, s] = q[F_Y + c]
                        samples[row, BEND, s], samples[row, ALONG, s] = (
                            q[MOMENT + c],
                            q[STRETCH + c],
                        )
                        samples[row, GAP, s], samples[row, SLIP, s] = q[MOVED + c], q[MOVED + L + c]

        # Motion of the blocks.
        begin, end = 3 * first_block[t], 3 * first_block[t + 1]
        if sampled:
            for r in range(first_place[t], first_place[t + 1]):
                for a in range(3):
                    displacement[place_row[r], a, s] = u[3 * place[r] + a]
                    velocity[place_row[r], a, s] = 0.5 * v[3 * place[r] + a]
        if gravity:
            for i in range(begin, end, 3):
                w_x, w_y = inertia[i] * g_x, inertia[i] * g_y
                force[i], force[i + 1] = force[i] + w_x, force[i + 1] + w_y
                if has_ledger and sampled:
                    ledger[GRAVITY] -= w_x * u[i] + w_y * u[i + 1]
        if held:
            for r in range(first_held[t], first_held[t + 1]):
                for a in range(3):
                    i = 3 * block[r] + a
                    q[BEFORE + i - begin] = v[i]
                    force[i] += drive[n, r, a]
        for i in range(begin, end):
            old, gain = v[i], pushed * force[i]
            if local_damping:  # less by local |gain| along v
                gain = gain - local * copysign(abs(gain), old) if old != 0.0 else gain
            new = (keep * old if mass_damping else old) + gain * inverse[i]
            if has_ledger:
                q[BEFORE + i - begin] = old
            v[i] = new
            u[i] += dt * new
            if not has_ledger:
                force[i] = 0.0
        if held:  # what dashpots take of the velocity without them
            for r in range(first_held[t], first_held[t + 1]):
                i = 3 * block[r]
                x, y, turn, b = v[i], v[i + 1], v[i + 2], BEFORE + i - begin
                for a in range(3):
                    new = keeps[r, a, 0] * q[b] + keeps[r, a, 1] * q[b + 1]
                    new += keeps[r, a, 2] * q[b + 2]
                    new += moves[r, a, 0] * x + moves[r, a, 1] * y + moves[r, a, 2] * turn
                    u[i + a] += dt * (new - v[i + a])
                    v[i + a] = new
        if has_ledger:
            if held:
                for r in range(first_held[t], first_held[t + 1]):
                    i = 3 * block[r]
                    for a in range(3):
                        taken, old, new = 0.0, q[BEFORE + i + a - begin], v[i + a]
                        for m in range(3):
                            both = 0.5 * (q[BEFORE + i + m - begin] + v[i + m])
                            taken += 0.5 * dt * (dashpot[r, a, m] * both)
                        given = 0.5 * dt * drive[n, r, a]
                        ledger[BOUNDARY] += taken * old
                        ledger[BOUNDARY + AFTER] += taken * new
                        ledger[WORK] += given * old
                        ledger[WORK + AFTER] += given * new
                        force[i + a] -= 2.0 * taken / dt
            for i in range(begin, end):
                old, new = q[BEFORE + i - begin], v[i]
                if damped:  # what is missing in the block's momentum
                    lost = inertia[i] * (new - old) - dt * force[i]
                    ledger[VISCOUS] -= 0.5 * lost * old
                    ledger[VISCOUS + AFTER] -= 0.5 * lost * new
                if sampled:
                    ledger[KINETIC] += 0.5 * inertia[i] * (old * new)
                force[i] = 0.0
        if sampled:
            for r in range(first_place[t], first_place[t + 1]):
                for a in range(3):
                    velocity[place_row[r], a, s] += 0.5 * v[3 * place[r] + a]

    return step
