"""One leapfrog step of rigid blocks in one, two or three dimensions.

A contact joins block i to block j across a plane face. In its frame, n from i to j and then the
tangents, the jump at a point of the face, e from its centre, is that of both blocks' motion there:

    jump = E (u_j + theta_j x r_j - u_i - theta_i x r_i) + (E (theta_j - theta_i)) x e,

gap first, then slip. At each point the law gives a traction; with the area w that a point stands
for, the force on block j and its moment about the centre of the face are the sums of w t and of
e x w t. Joints that always hold need no points: area and second moments of the face do.

Displacements live at whole steps, velocities half a step before; dashpots of joints see rates that
are extrapolated to the whole step, those beyond the domain the mean of both half steps. The ledger
is exact at a step of any length: the work of a force from one whole step to the next is the mean of
its two values times the displacement increment, the kinetic energy v[n-1/2] M v[n+1/2] / 2. So a
force works over the half step before it and over the one after it, which are accounted for apart.

Contacts are worked on side by side, in lanes; their forces are added to the blocks one after the
other, always in the same order.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from jointwave.dem.contacts import LANES as L
from jointwave.dem.model import KernelFlags
from jointwave.dem.motion import AFTER, ELASTIC, FRACTURE, FRICTION, VISCOUS, WORK, motion_for
from jointwave.joints.formula import formula
from jointwave.joints.law import History, law_at, law_of, rows_of, traction


@formula
def cross(ax, ay, az, bx, by, bz):
    """Return a x b."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@formula
def add(q, row, value):
    """Add a value to an entry of the buffer."""
    q[row] = q[row] + value


def step_for(form: KernelFlags) -> Callable:
    """Return the formula of one step of one tile: what its form lacks is not compiled."""
    parts, points, by_points, dim, turns = (
        form.parts,
        form.points,
        form.points > 0,
        form.dim,
        form.turns,
    )
    freedoms, at_row, in_q, past = form.freedoms, form.table, form.buffer, form.history
    dashpots, varied, has_ledger = parts.dashpots, parts.varied, form.ledger
    stressed, shaken, in_row = form.stressed, form.shaken, form.in_row
    softening, residual, path_dependent = parts.softening, parts.residual, parts.path
    drags, move = dashpots and has_ledger, motion_for(form)
    rated = dashpots or (by_points and (has_ledger or path_dependent))
    remembers, rotations, used = past.count > 0, form.rotations, rows_of(parts)
    FRAME, ARM_I, ARM_J, AREA = at_row.frame, at_row.arm_i, at_row.arm_j, at_row.area
    START, SECOND, POINT = at_row.start, at_row.second, at_row.point
    LAW, GATHERED = in_q.law, in_q.gathered
    JUMP, RATE, NOW, FORCE, SPREAD = in_q.jump, in_q.rate, in_q.now, in_q.force, in_q.spread
    DRAG, ON_J, ON_I = in_q.drag, in_q.on_j, in_q.on_i
    zeroed, recorded = in_q.zeroed, form.recorded
    REMEMBERED, DRAGGED, POINT_PAST = past.rate, past.drag, past.point
    OPENING, COHESION, PATH, past_rows = past.opening, past.cohesion, past.path, past.point_rows

    @formula
    def gather(m, walls, n, kind, still, at, row_from, q, to):
        """Put what the relative motion of the contacts needs of motion m into rows: displacements
        of j less those of i, and the rotations of both. Loops that gather are not vectorised, those
        along a row of blocks from `row_from` on are."""
        if in_row and row_from >= 0:
            i = m[row_from:]
            for b in range(dim):
                for c in range(L):
                    q[to + b * L + c] = i[freedoms * (c + 1) + b] - i[freedoms * c + b]
            for b in range(rotations):
                for c in range(L):
                    q[to + (dim + b) * L + c] = i[freedoms * c + dim + b]
                    q[to + (freedoms + b) * L + c] = i[freedoms * (c + 1) + dim + b]
            return
        for c in range(L):
            i, j = np.uint64(at[c]), np.uint64(at[L + c])  # unsigned: they do not wrap around
            for b in range(dim):
                a = np.uint64(b)
                moved = m[j + a]
                if shaken:
                    w = at[L + c] - still
                    moved = walls[n, kind, w + b] if w > 0 else moved
                q[to + b * L + c] = moved - m[i + a]
            for b in range(rotations):
                a = np.uint64(dim + b)
                q[to + (dim + b) * L + c] = m[i + a]
                q[to + (freedoms + b) * L + c] = m[j + a]

    @formula
    def scatter(q, at, row_from, lanes, last, force):
        """Add the forces of contacts to their blocks, in their order."""
        if in_row and row_from >= 0:
            own = force[row_from:]
            for b in range(freedoms):
                on_i = (ON_J if b < dim else ON_I - dim * L) + b * L
                for c in range(L):
                    own[freedoms * c + b] -= q[on_i + c]
                for c in range(L):
                    own[freedoms * (c + 1) + b] += q[ON_J + b * L + c]
            return
        for c in range(lanes):
            i, j = np.uint64(at[c]), np.uint64(at[L + c])
            for b in range(freedoms):
                on_i = (ON_J if b < dim else ON_I - dim * L) + b * L
                force[i + np.uint64(b)] -= q[on_i + c]
            if at[L + c] < last:
                for b in range(freedoms):
                    force[j + np.uint64(b)] += q[ON_J + b * L + c]

    @formula
    def relative(k, q, row, to):
        """Put the jump at the centres of contacts, and the rotation of j against i, in their frame,
        of what has been gathered."""
        for c in range(L):
            r = row + c
            if dim == 1:
                q[to + c] = q[r]
            elif dim == 2:
                n_x, n_y, x, y = k[FRAME + c], k[FRAME + L + c], q[r], q[r + L]
                i, j = q[r + 2 * L], q[r + 3 * L]
                x -= j * k[ARM_J + L + c] - i * k[ARM_I + L + c]
                y += j * k[ARM_J + c] - i * k[ARM_I + c]
                q[to + c], q[to + L + c] = n_x * x + n_y * y, n_x * y - n_y * x
                q[to + 2 * L + c] = j - i
            else:
                x, y, z, tx, ty, tz = q[r], q[r + L], q[r + 2 * L], 0.0, 0.0, 0.0
                if turns:
                    a, b, i, j = ARM_I + c, ARM_J + c, r + 3 * L, r + 6 * L
                    ix, iy, iz, jx, jy, jz = (
                        q[i],
                        q[i + L],
                        q[i + 2 * L],
                        q[j],
                        q[j + L],
                        q[j + 2 * L],
                    )
                    sx, sy, sz = cross(jx, jy, jz, k[b], k[b + L], k[b + 2 * L])
                    tx, ty, tz = cross(ix, iy, iz, k[a], k[a + L], k[a + 2 * L])
                    x, y, z = x + (sx - tx), y + (sy - ty), z + (sz - tz)
                    tx, ty, tz = jx - ix, jy - iy, jz - iz
                for a in range(3):
                    e, f = FRAME + 3 * a * L + c, to + a * L + c
                    e_x, e_y, e_z = k[e], k[e + L], k[e + 2 * L]
                    q[f] = e_x * x + e_y * y + e_z * z
                    if turns:
                        q[f + 3 * L] = e_x * tx + e_y * ty + e_z * tz

    @formula
    def at_point(q, row, c, e_1, e_2):
        """Return gap and slip, or their rates, at a point of the face, of those at its centre."""
        gap, x, z = q[row + c], 0.0, 0.0
        if dim == 2:
            return gap - e_1 * q[row + 2 * L + c], q[row + L + c], 0.0
        if dim == 3:
            x, z = q[row + L + c], q[row + 2 * L + c]
            if turns:
                p_n, p_1, p_2 = q[row + 3 * L + c], q[row + 4 * L + c], q[row + 5 * L + c]
                gap, x, z = gap + (p_1 * e_2 - p_2 * e_1), x - p_n * e_2, z + p_n * e_1
        return gap, x, z

    @formula
    def moment(q, c):
        """Return the moment about the centre of the face, in its frame, of the first moments."""
        if dim == 2:
            return 0.0, 0.0, -q[SPREAD + c]
        s = SPREAD + c
        return q[s + 2 * L] - q[s + 4 * L], q[s + 3 * L], -q[s]

    @formula
    def step(contacts, blocks, state, force, drive, walls, samples, q, ledger, t, n, s):
        """Advance tile t by a step.

        contacts, blocks, state, samples : `ContactTable`, `BlockTable`, `State`, `Samples`. force :
        of all blocks, zero. drive, walls : forces on held blocks and motion of walls. q : a buffer.
        ledger : of this step. n : of the step in `drive` and `walls`. s : of the sample; negative
        where none is taken.
        """
        u, v, dt, tiles = state.u, state.v, blocks.dt, contacts.tiles
        common, last, still = (
            law_of(contacts.laws, 0),
            blocks.inertia.size,
            blocks.inertia.size - freedoms,
        )
        sampled, history = s >= 0, state.history
        weighed = 1.0 if sampled else 0.0  # states are summed at samples alone
        for g in range(tiles[0, t], tiles[0, t + 1]):
            k, at, row_from = contacts.table[g], contacts.pair[g], contacts.row_from[g]
            h: Any = None
            if remembers:
                h = history[g]

            # Relative motion of the contacts.
            gather(u, walls, n, 0, still, at, row_from, q, GATHERED)
            relative(k, q, GATHERED, JUMP)
            if rated:
                gather(v, walls, n, 1, still, at, row_from, q, GATHERED)
                relative(k, q, GATHERED, RATE)
            if varied:
                for f in used:
                    for c in range(L):
                        q[LAW + f * L + c] = contacts.laws[f, at[2 * L + c]]
            if dashpots:
                for r in range(freedoms):
                    for c in range(L):
                        a = r * L + c
                        rate, before = q[RATE + a], h[REMEMBERED + a]
                        if drags:
                            ledger[VISCOUS + c] -= 0.5 * dt * (h[DRAGGED + a] * rate)
                        q[NOW + a], h[REMEMBERED + a] = 1.5 * rate - 0.5 * before, rate

            # Forces of points one by one, where joints can fail.
            if by_points:
                for c in range(FORCE, FORCE + zeroed):
                    q[c] = 0.0
                for p in range(points):
                    own, before = POINT + p * dim * L, POINT_PAST + p * past_rows
                    for c in range(L):
                        law = law_at(q, LAW + c, L) if varied else common
                        e_1, e_2, area = 0.0, 0.0, k[own + (dim - 1) * L + c]
                        if dim > 1:
                            e_1 = k[own + c]
                        if dim > 2:
                            e_2 = k[own + L + c]
                        gap, x, z = at_point(q, JUMP, c, e_1, e_2)
                        if stressed:
                            gap = gap + k[START + c]
                            if dim > 1:
                                x = x + k[START + L + c]
                            if dim > 2:
                                z = z + k[START + 2 * L + c]
                        rate_n, rate_x, rate_z = 0.0, 0.0, 0.0
                        d_n, d_x, d_z = 0.0, 0.0, 0.0
                        if rated:
                            d_n, d_x, d_z = at_point(q, RATE, c, e_1, e_2)
                            rate_n, rate_x, rate_z = d_n, d_x, d_z
                            d_n, d_x, d_z = dt * d_n, dt * d_x, dt * d_z
                        if dashpots:
                            rate_n, rate_x, rate_z = at_point(q, NOW, c, e_1, e_2)
                        opening, slide_x, slide_z, cohesion, path = 0.0, 0.0, 0.0, 0.0, 0.0
                        if dim > 1:
                            slide_x = h[before + c]
                        if dim > 2:
                            slide_z = h[before + L + c]
                        if softening:
                            opening = h[before + OPENING + c]
                        if residual:
                            cohesion = h[before + COHESION + c]
                        if path_dependent:
                            path = h[before + PATH + c]
                        found = traction(
                            law, parts, (gap, x, z), (d_n, d_x, d_z), (rate_n, rate_x, rate_z), dt,
                            History(opening, slide_x, slide_z, cohesion, path),
                        )  # fmt: skip
                        if dim > 1:
                            h[before + c] = found.history.slide_x
                        if dim > 2:
                            h[before + L + c] = found.history.slide_z
                        if softening:
                            h[before + OPENING + c] = found.history.opening
                        if residual:
                            h[before + COHESION + c] = found.history.cohesion
                        if path_dependent:
                            h[before + PATH + c] = found.history.path
                        f_n, f_x, f_z = area * found.n, area * found.x, area * found.z
                        add(q, FORCE + c, f_n)
                        if dim == 2:
                            add(q, FORCE + L + c, f_x)
                            add(q, SPREAD + c, e_1 * f_n)
                            add(q, SPREAD + L + c, e_1 * f_x)
                        if dim == 3:
                            add(q, FORCE + L + c, f_x)
                            add(q, FORCE + 2 * L + c, f_z)
                            if turns:
                                add(q, SPREAD + c, e_1 * f_n)
                                add(q, SPREAD + L + c, e_1 * f_x)
                                add(q, SPREAD + 2 * L + c, e_1 * f_z)
                                add(q, SPREAD + 3 * L + c, e_2 * f_n)
                                add(q, SPREAD + 4 * L + c, e_2 * f_x)
                                add(q, SPREAD + 5 * L + c, e_2 * f_z)
                        if drags:
                            f_n, f_x, f_z = (
                                area * found.drag_n,
                                area * found.drag_x,
                                area * found.drag_z,
                            )
                            add(q, DRAG + c, f_n)
                            if dim == 2:
                                add(q, DRAG + L + c, f_x)
                                add(q, DRAG + 2 * L + c, -e_1 * f_n)
                            if dim == 3:
                                add(q, DRAG + L + c, f_x)
                                add(q, DRAG + 2 * L + c, f_z)
                                if turns:
                                    add(q, DRAG + 3 * L + c, e_1 * f_z - e_2 * f_x)
                                    add(q, DRAG + 4 * L + c, e_2 * f_n)
                                    add(q, DRAG + 5 * L + c, -e_1 * f_n)
                        if has_ledger:
                            ledger[FRICTION + c] += area * found.slid
                            ledger[ELASTIC + c] += weighed * area * found.stored
                            if softening:
                                ledger[FRACTURE + c] += weighed * area * found.spent

            # Joints that always hold: springs, and dashpots, of the face as a whole.
            if not by_points:
                for a in range(dim):
                    for c in range(L):
                        law, r = law_at(q, LAW + c, L) if varied else common, a * L + c
                        stiffness = law.normal_stiffness if a == 0 else law.shear_stiffness
                        moved, area = q[JUMP + r], k[AREA + c]
                        if stressed:
                            moved = moved + k[START + r]
                        f = -stiffness * area * moved
                        if has_ledger:
                            ledger[ELASTIC + c] -= weighed * (0.5 * f * moved)
                        if dashpots:
                            viscosity = law.normal_viscosity if a == 0 else law.shear_viscosity
                            d = -viscosity * area * q[NOW + r]
                            f = f + d
                            if drags:
                                q[DRAG + r] = d
                        q[FORCE + r] = f
                if dim == 2:
                    for c in range(L):
                        law = law_at(q, LAW + c, L) if varied else common
                        turn, second, r = q[JUMP + 2 * L + c], k[SECOND + c], 2 * L + c
                        f = law.normal_stiffness * second * turn
                        if has_ledger:
                            ledger[ELASTIC + c] += weighed * (0.5 * f * turn)
                        if dashpots:
                            d = law.normal_viscosity * second * q[NOW + r]
                            f = f + d
                            if drags:
                                q[DRAG + r] = -d
                        q[SPREAD + c], q[SPREAD + L + c] = f, 0.0
                if dim == 3 and turns:
                    for c in range(L):
                        law = law_at(q, LAW + c, L) if varied else common
                        r, s_1, s_2 = JUMP + 3 * L + c, k[SECOND + c], k[SECOND + L + c]
                        k_n, k_s = law.normal_stiffness, law.shear_stiffness
                        p_n, p_1, p_2 = q[r], q[r + L], q[r + 2 * L]
                        if has_ledger:
                            bent = k_n * (s_1 * p_2 * p_2 + s_2 * p_1 * p_1)
                            bent = bent + k_s * (s_1 + s_2) * p_n * p_n
                            ledger[ELASTIC + c] += weighed * (0.5 * bent)
                        p_n, p_1, p_2 = k_s * p_n, k_n * p_1, k_n * p_2
                        if dashpots:
                            r = NOW + 3 * L + c
                            k_n, k_s = law.normal_viscosity, law.shear_viscosity
                            d_n, d_1, d_2 = k_s * q[r], k_n * q[r + L], k_n * q[r + 2 * L]
                            p_n, p_1, p_2 = p_n + d_n, p_1 + d_1, p_2 + d_2
                            if drags:
                                q[DRAG + 3 * L + c] = -(s_1 + s_2) * d_n
                                q[DRAG + 4 * L + c], q[DRAG + 5 * L + c] = -s_2 * d_1, -s_1 * d_2
                        r = SPREAD + c
                        q[r], q[r + L], q[r + 2 * L] = s_1 * p_2, 0.0, -s_1 * p_n
                        q[r + 3 * L], q[r + 4 * L], q[r + 5 * L] = -s_2 * p_1, s_2 * p_n, 0.0

            # What acts on their blocks.
            for c in range(L):
                f_n = q[FORCE + c]
                if dim == 1:
                    q[ON_J + c] = f_n
                elif dim == 2:
                    n_x, n_y, f_t = k[FRAME + c], k[FRAME + L + c], q[FORCE + L + c]
                    x, y, m = n_x * f_n - n_y * f_t, n_y * f_n + n_x * f_t, -q[SPREAD + c]
                    q[ON_J + c], q[ON_J + L + c] = x, y
                    q[ON_J + 2 * L + c] = m + (k[ARM_J + c] * y - k[ARM_J + L + c] * x)
                    q[ON_I + c] = m + (k[ARM_I + c] * y - k[ARM_I + L + c] * x)
                else:
                    x, y, z, mx, my, mz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
                    m_n, m_1, m_2 = 0.0, 0.0, 0.0
                    if turns:
                        m_n, m_1, m_2 = moment(q, c)
                    for a in range(3):
                        e, f = FRAME + 3 * a * L + c, q[FORCE + a * L + c]
                        x, y, z = x + k[e] * f, y + k[e + L] * f, z + k[e + 2 * L] * f
                        if turns:
                            f = m_n if a == 0 else (m_1 if a == 1 else m_2)
                            mx, my, mz = mx + k[e] * f, my + k[e + L] * f, mz + k[e + 2 * L] * f
                    r = ON_J + c
                    q[r], q[r + L], q[r + 2 * L] = x, y, z
                    if turns:
                        a, b, r = ARM_J + c, ARM_I + c, ON_J + 3 * L + c
                        ax, ay, az = cross(k[a], k[a + L], k[a + 2 * L], x, y, z)
                        q[r], q[r + L], q[r + 2 * L] = mx + ax, my + ay, mz + az
                        ax, ay, az = cross(k[b], k[b + L], k[b + 2 * L], x, y, z)
                        r = ON_I + c
                        q[r], q[r + L], q[r + 2 * L] = mx + ax, my + ay, mz + az
            if drags:
                for r in range(freedoms):
                    for c in range(L):
                        a = r * L + c
                        ledger[VISCOUS + c] -= 0.5 * dt * (q[DRAG + a] * q[RATE + a])
                        h[DRAGGED + a] = q[DRAG + a]
            lanes = contacts.count - g * L
            lanes = lanes if lanes < L else L
            scatter(q, at, row_from, lanes, last, force)
            if shaken and has_ledger:  # what moves a wall works against the joints
                for c in range(lanes):
                    w = at[L + c] - still
                    if w > 0:
                        for a in range(dim):
                            f = 0.5 * dt * q[ON_J + a * L + c]
                            ledger[WORK + c] -= f * walls[n, 1, w + a]
                            ledger[WORK + AFTER + c] -= f * walls[n + 1, 1, w + a]
            if sampled:
                for r in range(tiles[4, t], tiles[4, t + 1]):
                    c, row = contacts.seen[0, r] - g * L, contacts.seen[1, r]
                    if c >= 0 and c < L:
                        for a in range(recorded - dim):
                            samples.contact[row, a, s] = q[FORCE + a * L + c]
                        for a in range(dim):
                            samples.contact[row, recorded - dim + a, s] = q[JUMP + a * L + c]

        if sampled:
            for r in range(tiles[3, t], tiles[3, t + 1]):
                for a in range(freedoms):
                    i, row = freedoms * blocks.places[0, r] + a, blocks.places[1, r]
                    samples.displacement[row, a, s] = u[i]
                    samples.velocity[row, a, s] = 0.5 * v[i]
        move(blocks, tiles, state, force, drive, q, ledger, t, n, sampled)
        if sampled:
            for r in range(tiles[3, t], tiles[3, t + 1]):
                for a in range(freedoms):
                    i, row = freedoms * blocks.places[0, r] + a, blocks.places[1, r]
                    samples.velocity[row, a, s] += 0.5 * v[i]

    return step
