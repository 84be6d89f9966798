"""One step of rigid blocks in one, two or three dimensions, by leapfrog or by a stage of a
composition.

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
A step that is composed of stages (`composition`) takes each as a leapfrog step with a length of
its own for velocities, zero in the first, and for displacements.

With rotations of any size (`finite`, in space) R_i and R_j turn the blocks from where they were at
the start. The points belong to block i. The jump at one is how far the point of block j that was
there at the start is from it, in axes that turn with j; x the centroids,

    jump = E (R_j^T (x_j - x_i) + r_j - A r_i) + E (1 - A) E^T e,   A = R_j^T R_i,

all by differences from no rotation, which keep the digits of small ones. The force R_j E^T w t acts
on both blocks at the point itself: it is the gradient of the joint's energy, and conserves momentum
and angular momentum. About the centre of the face on j it has, in the frame, the moment

    sum over tangents k of (E A k) x (sum of e_k w t), less jump x force, both of the centre.

A point that is off the other face, or behind that block, carries nothing. Rates are differences of
the jump over the step. Blocks have angular momenta at half steps, in the axes of space, and unit
quaternions at whole steps (`rotation`); the ledger takes the angular velocities that momenta
give in the orientation of the step, and closes to second order.

Contacts are worked on side by side, in lanes; their forces are added to the blocks one after the
other, always in the same order.
"""

from collections.abc import Callable
from typing import Any

from jointwave.dem.contacts.chunks import LANES as L
from jointwave.dem.kernel.model import KernelFlags
from jointwave.dem.kernel.motion import AFTER, CHUNK, HELD, PLACE, SEEN, VISCOUS, WORK, motion_for
from jointwave.dem.kernel.relative import onto_blocks_for, relative_for
from jointwave.dem.kernel.rotation import dot, three
from jointwave.dem.kernel.row import row_forces_for
from jointwave.dem.kernel.tractions import face_forces_for, point_forces_for
from jointwave.joints.formula import formula
from jointwave.joints.law import rows_of


def step_for(form: KernelFlags) -> Callable:
    """Return the formula of one step of one tile: what its form lacks is not compiled."""
    dim, freedoms, has_ledger, shaken = form.dim, form.freedoms, form.ledger, form.shaken
    dashpots, varied, rated, drags = form.parts.dashpots, form.parts.varied, form.rated, form.drags
    matched = form.matched
    recorded, used, past = form.recorded, rows_of(form.parts), form.history
    remembers = past.size > 0 or (form.points and form.point.size > 0)
    stages, composed, row = form.stages, form.stages > 1, form.dim == 1
    relative, onto_blocks, move = relative_for(form), onto_blocks_for(form), motion_for(form)
    forces = point_forces_for(form) if form.points else face_forces_for(form)
    finite, motions, FRAME = form.finite, form.motions, form.table.frame
    rows, LAST_RATE, LAST_DRAG, LAST_JUMP = (
        form.buffer, past.rate, past.drag, past.jump
    )  # fmt: skip
    LAW, JUMP, RATE, NOW, FORCE, DRAG, ON_J = (
        rows.law, rows.jump, rows.rate, rows.now, rows.force, rows.drag, rows.on_j
    )  # fmt: skip

    @formula
    def differ(h, q, dt):
        """Put the rates half a step before of motion that is no linear function of the blocks'."""
        for c in range(motions * L):
            jump = q[JUMP + c]
            q[RATE + c], h[LAST_JUMP + c] = (jump - h[LAST_JUMP + c]) / dt, jump

    @formula
    def extrapolate(h, q, ledger, dt):
        """Put the rates that dashpots see; enter what theirs of the last step took since."""
        for a in range(motions):
            for c in range(a * L, a * L + L):
                rate, before = q[RATE + c], h[LAST_RATE + c]
                if drags:
                    ledger[VISCOUS + c - a * L] -= 0.5 * dt * (h[LAST_DRAG + c] * rate)
                q[NOW + c], h[LAST_RATE + c] = 1.5 * rate - 0.5 * before, rate

    @formula
    def account_drags(h, q, ledger, dt):
        """Enter what dashpots took in the half step before."""
        for a in range(motions):
            for c in range(a * L, a * L + L):
                ledger[VISCOUS + c - a * L] -= 0.5 * dt * (q[DRAG + c] * q[RATE + c])
                h[LAST_DRAG + c] = q[DRAG + c]

    @formula
    def account_walls(q, at, lanes, still, walls, n, ledger, dt):
        """Enter the work of what moves walls against the joints."""
        for c in range(lanes):
            w = at[L + c] - still
            if w > 0:
                for a in range(dim):
                    f = 0.5 * dt * q[ON_J + a * L + c]
                    ledger[WORK + c] -= f * walls[n, 1, w + a]
                    ledger[WORK + AFTER + c] -= f * walls[n + 1, 1, w + a]

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
        """Add a share of the velocities of recorded blocks to their samples, and displacements at
        the first."""
        for r in range(chunks.tiles[PLACE, t], chunks.tiles[PLACE, t + 1]):
            i, row = freedoms * blocks.places[0, r], blocks.places[1, r]
            for a in range(freedoms):
                if share == 0:
                    samples.displacement[row, a, s] = state.u[i + a]
                    samples.velocity[row, a, s] = 0.0
                samples.velocity[row, a, s] += 0.5 * state.v[i + a]
            if finite and share == 0:
                samples.displacement[row, freedoms, s] = state.turn[blocks.places[0, r]]

    @formula
    def joint_forces(chunks, state, force, walls, samples, q, ledger, t, end, dt, n, s):
        """Add the forces of the tile's contacts up to chunk `end` to their blocks."""
        last, sampled = force.size, s >= 0
        still, weighed = last - freedoms, 1.0 if sampled else 0.0
        for g in range(chunks.tiles[CHUNK, t], end):
            k, at, row_from = chunks.table[g], chunks.pair[g], chunks.row_from[g]
            lanes = chunks.contacts - g * L
            lanes = lanes if lanes < L else L
            h: Any = None
            if remembers:
                h = state.history[g]
            relative(state.u, state.turn, walls, n, 0, still, at, row_from, k, q, JUMP)
            if rated and finite:
                differ(h, q, dt)
            elif rated:
                relative(state.v, state.turn, walls, n, 1, still, at, row_from, k, q, RATE)
            if dashpots:
                extrapolate(h, q, ledger, dt)
            if varied:
                for f in used:
                    for c in range(L):
                        q[LAW + f * L + c] = chunks.laws[f, at[2 * L + c]]
            forces(chunks.laws, k, h, q, ledger, dt, weighed)
            onto_blocks(k, q, at, row_from, lanes, last, force)
            if drags:
                account_drags(h, q, ledger, dt)
            if shaken and has_ledger:
                account_walls(q, at, lanes, still, walls, n, ledger, dt)
            if sampled:
                record_contacts(chunks, samples, q, g, t, s)

    act = row_forces_for(form, record_contacts) if row else joint_forces

    @formula
    def step(chunks, blocks, state, force, drive, walls, samples, q, ledger, t, n, s):
        """Advance tile t by a step, or by a stage of a composed one.

        chunks, blocks, state, samples : `ChunkTable`, `BlockTable`, `State`, `Samples`. force :
        of all blocks, zero. drive, walls : forces on held blocks and motion of walls. q : a buffer.
        ledger : of this step. n : of the step in `drive` and `walls`, or the stage in `drive`. s :
        of the sample; negative where none is taken.
        """
        tiles, dt, sampled = chunks.tiles, blocks.dt, s >= 0
        end = tiles[CHUNK, t + 1]
        if composed and n % stages == 0 and not sampled:
            end = tiles[CHUNK, t]  # the kick is zero
        act(chunks, state, force, walls, samples, q, ledger, t, end, dt, n, s)
        if sampled:
            record_blocks(chunks, blocks, state, samples, t, s, 0)
            if matched:
                for r in range(tiles[HELD, t], tiles[HELD, t + 1]):
                    for a in range(freedoms):
                        samples.closure[r, a, s] = state.closure[r, a]
        move(blocks, tiles, state, force, drive, q, ledger, t, n, sampled)
        if sampled:
            record_blocks(chunks, blocks, state, samples, t, s, 1)

    return step
