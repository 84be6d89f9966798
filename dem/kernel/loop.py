"""The kernel of rigid blocks: steps of leapfrog, or stages of a composition, tile by tile.

A contact joins block i to block j across a plane face. The rows of E are its frame: the normal n,
from i to j, then the tangents. With r the arms from the centroids to the face's centre and e from
there, the jump at a point of the face is

    jump = E (u_j + theta_j x r_j - u_i - theta_i x r_i) + (E (theta_j - theta_i)) x e,

gap first, then slip. At each point the law gives a traction t. With the point's area w, the force
on block j and its moment about the centre of the face are the sums of w t and of e x w t. Joints
that always hold need no points, only the area and second moments of the face.

Displacements live at whole steps, velocities half a step before. Dashpots of joints use rates
extrapolated to the whole step, boundary dashpots the mean of both half steps. The ledger is exact
for any time step: the work of a force between two whole steps is the mean of its two values times
the displacement increment, the kinetic energy is v[n-1/2] M v[n+1/2] / 2. So a force works over the
half step before it and the one after it, and the ledger adds the two separately. Each stage of a
composed step (`composition`) is a leapfrog step with separate lengths for velocities (zero in the
first stage) and displacements.

With rotations of any size (`finite`, in space) R_i and R_j are the rotations of the blocks since
the start, x their centroids. The points belong to block i. The jump at a point is the vector to the
point of block j that coincided with it at the start, in axes that turn with j:

    jump = E (R_j^T (x_j - x_i) + r_j - A r_i) + E (1 - A) E^T e,   A = R_j^T R_i,

computed from R - 1, which keeps the digits of small rotations. The force R_j E^T w t acts on both
blocks at the point itself: it is the gradient of the joint's energy, and conserves momentum and
angular momentum. Its moment on j about the centre of the face is, in the frame,

    sum over tangents k of (E A k) x (sum of e_k w t), less jump x force, both at the centre.

A point beyond the edge of the other face, or behind block j, carries nothing. Rates are differences
of the jump over the step. Blocks have angular momenta at half steps, in the axes of space, and unit
quaternions at whole steps (`rotation`). The ledger uses the angular velocities of these momenta at
the orientation of the step, and closes to second order.

Contacts are vectorised in lanes; their forces are added to blocks one by one, in a fixed order.

A tile needs the contact forces of the tile before it at the same step, and the blocks of the next
tile at the step before. So the tiles t, t - 1, t - 2, ... take the steps n, n + 1, n + 2, ... while
they are in the cache.
"""

from collections.abc import Callable
from functools import cache
from typing import Any

from jointwave.dem.contacts.chunks import LANES as L
from jointwave.dem.kernel.model import KernelFlags
from jointwave.dem.kernel.motion import (
    AFTER,
    CHUNK,
    HELD,
    PLACE,
    SEEN,
    SUMMED,
    VISCOUS,
    WORK,
    motion_for,
)
from jointwave.dem.kernel.relative import onto_blocks_for, relative_for
from jointwave.dem.kernel.rotation import dot, three
from jointwave.dem.kernel.row import row_forces_for
from jointwave.dem.kernel.sharing import of_motion, shared
from jointwave.dem.kernel.tractions import face_forces_for, point_forces_for
from jointwave.joints.formula import formula
from jointwave.joints.law import rows_of
from jointwave.numerics.borrowed import borrowed
from jointwave.numerics.denormals import flush_denormals, restore_denormals
from jointwave.numerics.jit import jitted


def widths_of(form: KernelFlags) -> tuple[int, ...]:
    """Return the number of lanes of each term of the ledger, 0 for absent terms."""
    parts, held, lanes = form.parts, int(form.held), L
    damped = form.mass_damping or form.local_damping
    return (
        lanes, lanes, lanes * (parts.dashpots or damped),
        lanes * (form.points and form.dim > 1), lanes * parts.softening, held,
        int(form.gravity), lanes if form.shaken else held,
    )  # fmt: skip


def rates_for(form: KernelFlags) -> tuple[Callable, Callable, Callable]:
    """Return the kernels for jump rates under finite rotation, dashpot rates and dissipation."""
    motions, drags, past, rows = form.motions, form.drags, form.history, form.buffer
    LAST_RATE, LAST_DRAG, LAST_JUMP = past.rate, past.drag, past.jump
    JUMP, RATE, NOW, DRAG = rows.jump, rows.rate, rows.now, rows.drag

    @formula
    def difference_rates(h, q, dt):
        """Set the jump rates half a step before as differences of the jump (finite rotations)."""
        for c in range(motions * L):
            jump = q[JUMP + c]
            q[RATE + c], h[LAST_JUMP + c] = (jump - h[LAST_JUMP + c]) / dt, jump

    @formula
    def extrapolate(h, q, ledger, dt):
        """Extrapolate the rates to the step; add to the ledger the dissipation by the dashpot
        forces of the last step over the half step after it."""
        for a in range(motions):
            for c in range(a * L, a * L + L):
                rate, before = q[RATE + c], h[LAST_RATE + c]
                if drags:
                    ledger[VISCOUS + c - a * L] -= 0.5 * dt * (h[LAST_DRAG + c] * rate)
                q[NOW + c], h[LAST_RATE + c] = 1.5 * rate - 0.5 * before, rate

    @formula
    def account_drags(h, q, ledger, dt):
        """Add the dashpots' dissipation over the half step before to the ledger."""
        for a in range(motions):
            for c in range(a * L, a * L + L):
                ledger[VISCOUS + c - a * L] -= 0.5 * dt * (q[DRAG + c] * q[RATE + c])
                h[LAST_DRAG + c] = q[DRAG + c]

    return difference_rates, extrapolate, account_drags


@shared(of_motion)
def records_for(form: KernelFlags) -> tuple[Callable, Callable]:
    """Return the kernels that sample watched contacts and recorded blocks."""
    dim, freedoms, recorded, finite = form.dim, form.freedoms, form.recorded, form.finite
    FORCE, JUMP, ON_J = form.buffer.force, form.buffer.jump, form.buffer.on_j
    FRAME = form.table.frame

    @formula
    def record_contacts(chunks, samples, q, g, t, s):
        """Sample the watched contacts of chunk g."""
        for r in range(chunks.tiles[SEEN, t], chunks.tiles[SEEN, t + 1]):
            c, row = chunks.seen[0, r] - g * L, chunks.seen[1, r]
            if c >= 0 and c < L:
                for a in range(recorded - dim):
                    samples.contact[row, a, s] = q[FORCE + a * L + c]
                for a in range(dim):
                    samples.contact[row, recorded - dim + a, s] = q[JUMP + a * L + c]
                    if finite:
                        e = three(chunks.table[g], FRAME + 3 * a * L + c, L)
                        samples.contact[row, a, s] = dot(e, three(q, ON_J + c, L))

    @formula
    def record_blocks(chunks, blocks, state, samples, t, s, share):
        """Sample recorded blocks: half of each velocity, before (share 0, with the displacements)
        and after the motion (share 1)."""
        for r in range(chunks.tiles[PLACE, t], chunks.tiles[PLACE, t + 1]):
            i, row = freedoms * blocks.places[0, r], blocks.places[1, r]
            for a in range(freedoms):
                if share == 0:
                    samples.displacement[row, a, s] = state.u[i + a]
                    samples.velocity[row, a, s] = 0.0
                samples.velocity[row, a, s] += 0.5 * state.v[i + a]
            if finite and share == 0:
                samples.displacement[row, freedoms, s] = state.turn[blocks.places[0, r]]

    return record_contacts, record_blocks


@formula
def take_out(ledger, row, width):
    """Return the sum of a term over its lanes, by four partial sums, and set the lanes to zero."""
    a, b, c, d, end = 0.0, 0.0, 0.0, 0.0, row + width
    for i in range(row, end - 3, 4):
        a, b = a + ledger[i], b + ledger[i + 1]
        c, d = c + ledger[i + 2], d + ledger[i + 3]
    for i in range(end - width % 4, end):
        a += ledger[i]
    for i in range(row, end):
        ledger[i] = 0.0
    return (a + b) + (c + d)


@cache
def loop_for(form: KernelFlags) -> Callable:
    """Return the time loop of blocks with these effects; absent ones are not compiled.

    It is a formula as well, for `parts`. One function: numba would optimise a called function alone
    and again in each caller.
    """
    dim, freedoms, finite, has_ledger = form.dim, form.freedoms, form.finite, form.ledger
    dashpots, varied, rated, drags = form.parts.dashpots, form.parts.varied, form.rated, form.drags
    stages, composed, matched, shaken = form.stages, form.stages > 1, form.matched, form.shaken
    in_line, used, widths = dim == 1, rows_of(form.parts), widths_of(form)
    remembers = form.remembers
    LAW, JUMP, RATE, ON_J = form.buffer.law, form.buffer.jump, form.buffer.rate, form.buffer.on_j
    relative, onto_blocks, move = relative_for(form), onto_blocks_for(form), motion_for(form)
    forces = point_forces_for(form) if form.points else face_forces_for(form)
    difference_rates, extrapolate, account_drags = rates_for(form)
    record_contacts, record_blocks = records_for(form)
    row_forces = row_forces_for(form, record_contacts)

    @formula
    def loop(chunks, blocks, state, samples, drive, walls, work, span):
        """Take the steps begin .. end - 1 of the tiles first .. last - 1, in bands of `depth`.

        Diagonal k of a band takes step j of tile k - j. Tiles outside first .. last - 1 also take
        the steps on which later steps of the band depend, and are left with incomplete motion.

        chunks, blocks, state, samples : `parts.ChunkTable`, `leapfrog.BlockTable`, `State`,
        `Samples`. drive : forces on held blocks in each step or stage from `origin` on. walls :
        motion of walls, likewise. work : `parts.Work`.
        """
        setting = flush_denormals()
        chunks, blocks, state = borrowed(chunks), borrowed(blocks), borrowed(state)
        samples, drive, walls = borrowed(samples), borrowed(drive), borrowed(walls)
        work = borrowed(work)
        first, last, origin, begin, end, stride, depth = span
        tiles, force, q, dt = chunks.tiles, work.force, work.buffer, blocks.dt
        ledger: Any = None
        u, v, turn, still = state.u, state.v, state.turn, force.size - freedoms
        count = tiles.shape[1] - 1
        for band in range(begin, end, depth):
            steps = depth if depth < end - band else end - band
            from_tile = first - steps if first > steps else 0
            to_tile = last + steps if last + steps < count else count
            for k in range(from_tile, to_tile + steps - 1):
                for j in range(steps):
                    t, later = k - j, steps - 1 - j
                    if t < 0 or t < first - 1 - later or t >= count or t >= last + later:
                        continue
                    if has_ledger:
                        ledger = work.ledgers[j if t >= first and t < last else depth]
                    n, sampled = band + j - origin, (band + j) % stride == 0
                    s, stop = (band + j) // stride if sampled else -1, tiles[CHUNK, t + 1]
                    if composed and n % stages == 0 and not sampled:
                        stop = tiles[CHUNK, t]  # the kick is zero
                    if in_line:
                        row_forces(
                            chunks, state, force, walls, samples, q, ledger, t, stop, dt, n, s
                        )
                    else:
                        for g in range(tiles[CHUNK, t], stop):
                            contacts, at = chunks.table[g], chunks.pair[g]
                            row_from, lanes = chunks.row_from[g], min(L, chunks.contacts - g * L)
                            h: Any = None
                            if remembers:
                                h = state.history[g]
                            relative(u, turn, walls, n, 0, still, at, row_from, contacts, q, JUMP)
                            if rated and finite:
                                difference_rates(h, q, dt)
                            elif rated:
                                relative(
                                    v, turn, walls, n, 1, still, at, row_from, contacts, q, RATE
                                )
                            if dashpots:
                                extrapolate(h, q, ledger, dt)
                            if varied:
                                for f in used:
                                    for c in range(L):
                                        q[LAW + f * L + c] = chunks.laws[f, at[2 * L + c]]
                            forces(chunks.laws, contacts, h, q, ledger, dt, 1.0 if sampled else 0.0)
                            onto_blocks(contacts, q, at, row_from, lanes, force.size, force)
                            if drags:
                                account_drags(h, q, ledger, dt)
                            if shaken and has_ledger:  # moving walls work against joints
                                for c in range(lanes):
                                    w = at[L + c] - still
                                    if w > 0:
                                        for a in range(dim):
                                            f = 0.5 * dt * q[ON_J + a * L + c]
                                            ledger[WORK + c] -= f * walls[n, 1, w + a]
                                            ledger[WORK + AFTER + c] -= f * walls[n + 1, 1, w + a]
                            if sampled:
                                record_contacts(chunks, samples, q, g, t, s)
                    if sampled:
                        record_blocks(chunks, blocks, state, samples, t, s, 0)
                        if matched:
                            for r in range(tiles[HELD, t], tiles[HELD, t + 1]):
                                for a in range(freedoms):
                                    samples.closure[r, a, s] = state.closure[r, a]
                    move(blocks, tiles, state, force, drive, q, ledger, t, n, sampled)
                    if sampled:
                        record_blocks(chunks, blocks, state, samples, t, s, 1)
            if has_ledger:
                for j in range(band, band + steps):
                    one = work.ledgers[j - band]
                    for term in range(samples.energy.shape[0]):
                        row, sampled = term * L, j % stride == 0
                        summed = row in SUMMED
                        width = widths[term] if sampled or summed else 0
                        before, after = take_out(one, row, width), take_out(one, AFTER + row, width)
                        if sampled:
                            samples.energy[term, j // stride] = state.sums[term] + before
                        if summed:
                            state.sums[term] += before + after
        restore_denormals(setting)

    return jitted(loop, form)
