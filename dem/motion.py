"""Motion of the blocks of one tile in one leapfrog step, or in one stage of a composed step, by the
forces on them."""

from collections.abc import Callable
from math import copysign

from jointwave.dem.chunks import LANES as L
from jointwave.dem.model import KernelFlags
from jointwave.joints.formula import formula

#: Rows of the tiles' table: their first chunk, block, held block, recorded block, watched contact.
CHUNK, BLOCK, HELD, PLACE, SEEN = range(5)
#: Rows of the ledger of one step, J in lanes, in the order of `results.rock_mass.TERMS`, and AFTER
#: further on what is added behind the step.
KINETIC, ELASTIC, VISCOUS, FRICTION, FRACTURE, BOUNDARY, GRAVITY, WORK = range(0, 8 * L, L)
AFTER = 8 * L
SUMMED = VISCOUS, FRICTION, BOUNDARY, WORK  # the others are states


def motion_for(form: KernelFlags) -> Callable:
    """Return the formula of a tile's motion: what its form lacks is not compiled."""
    dim, freedoms, has_ledger, held, gravity = (
        form.dim, form.freedoms, form.ledger, form.held, form.gravity
    )  # fmt: skip
    mass_damping, local_damping = form.mass_damping or form.relaxed, form.local_damping
    damped, oblique = form.mass_damping or local_damping, form.oblique
    SPARE, BEFORE, stages, composed = (
        form.buffer.spare, form.buffer.before, form.stages, form.stages > 1
    )  # fmt: skip

    @formula
    def add_forces(blocks, first, last, begin, u, v, force, inertia, before, drive, n):
        """Add weight and external forces; return the potential energy of the weight, J."""
        potential = 0.0
        if gravity:
            for a in range(dim):
                g = blocks.gravity[a]
                for i in range(a, force.size, freedoms):
                    weight = g * inertia[i]
                    force[i] += weight
                    potential -= weight * u[i]
        if held:
            for r in range(first, last):
                i = freedoms * blocks.held[r] - begin
                for a in range(freedoms):
                    before[i + a] = v[i + a]
                    force[i + a] += drive[n, r, a]
        return potential

    @formula
    def advance(u, v, force, inverse, before, pushed, drift, keep, local):
        """Advance velocities by their forces, and displacements by these."""
        for i in range(u.size):
            old, gain = v[i], pushed * force[i]
            if local_damping:  # less by local |gain| along v
                gain = gain - local * copysign(abs(gain), old) if old != 0.0 else gain
            new = (keep * old if mass_damping else old) + gain * inverse[i]
            if has_ledger:
                before[i] = old
            else:
                force[i] = 0.0
            v[i] = new
            u[i] += drift * new

    @formula
    def advance_oblique(blocks, first, u, v, force, before, pushed, drift):
        """The same of blocks from `first` on whose rotations have inertia in common."""
        keep = blocks.keep
        for block in range(u.size // freedoms):
            back = blocks.back[first + block]
            for b in range(freedoms):
                i = freedoms * block + b
                old, gain = v[i], 0.0
                if b < dim:
                    gain = pushed * force[i] * blocks.inverse[freedoms * first + i]
                else:
                    for m in range(3):
                        gain += pushed * back[b - 3, m] * force[freedoms * block + 3 + m]
                if local_damping:
                    gain = gain - blocks.local * copysign(abs(gain), old) if old != 0.0 else gain
                new = (keep * old if mass_damping else old) + gain
                if has_ledger:
                    before[i] = old
                v[i] = new
                u[i] += drift * new
        if not has_ledger:
            force[:] = 0.0

    @formula
    def momentum(blocks, inertia, first, i, v):
        """Return freedom i of the momentum of blocks from `first` on at velocities v."""
        if not oblique or i % 6 < 3:
            return inertia[i] * v[i]
        found, begin = 0.0, i - i % 6 + 3
        for m in range(3):
            found += blocks.tensor[first + i // 6, i % 6 - 3, m] * v[begin + m]
        return found

    @formula
    def drag_held(blocks, first, last, begin, u, v, before, spare):
        """Take from held blocks what their dashpots take of the velocity without them."""
        for r in range(first, last):
            i, matrices = freedoms * blocks.held[r] - begin, blocks.matrices[r]
            for a in range(freedoms):
                new = 0.0
                for m in range(freedoms):
                    new += matrices[0, a, m] * before[i + m] + matrices[1, a, m] * v[i + m]
                spare[a] = new
            for a in range(freedoms):
                u[i + a] += blocks.dt * (spare[a] - v[i + a])
                v[i + a] = spare[a]

    @formula
    def account_held(blocks, first, last, begin, v, force, before, drive, n, kick, ledger):
        """Enter the work of external forces, and of dashpots, which it adds to the forces."""
        for r in range(first, last):
            i, matrices = freedoms * blocks.held[r] - begin, blocks.matrices[r]
            for a in range(freedoms):
                drag, old, new = 0.0, before[i + a], v[i + a]
                for m in range(freedoms):
                    drag += matrices[2, a, m] * (0.5 * (before[i + m] + v[i + m]))
                taken, given = 0.5 * kick * drag, 0.5 * kick * drive[n, r, a]
                ledger[BOUNDARY] += taken * old
                ledger[BOUNDARY + AFTER] += taken * new
                ledger[WORK] += given * old
                ledger[WORK + AFTER] += given * new
                force[i + a] -= drag

    @formula
    def move(blocks, tiles, state, all_forces, drive, q, ledger, t, n, sampled):
        """Move the blocks of tile t in step or stage n of `drive`, and set their forces to zero."""
        begin, end = freedoms * tiles[BLOCK, t], freedoms * tiles[BLOCK, t + 1]
        first, last, kick, drift = tiles[HELD, t], tiles[HELD, t + 1], blocks.dt, blocks.dt
        if composed:
            kick, drift = blocks.stages[n % stages, 0], blocks.stages[n % stages, 1]
        # Slices begin at 0: else indices are taken to wrap around, and loops are not vectorised.
        u, v, force = state.u[begin:end], state.v[begin:end], all_forces[begin:end]
        inertia, inverse = blocks.inertia[begin:end], blocks.inverse[begin:end]
        before, pushed = q[BEFORE:], 0.5 * kick * (1.0 + blocks.keep)
        potential = add_forces(blocks, first, last, begin, u, v, force, inertia, before, drive, n)
        if oblique:
            advance_oblique(blocks, tiles[BLOCK, t], u, v, force, before, pushed, drift)
        else:
            advance(u, v, force, inverse, before, pushed, drift, blocks.keep, blocks.local)
        if held:
            drag_held(blocks, first, last, begin, u, v, before, q[SPARE:])
        if has_ledger:
            if held:
                account_held(blocks, first, last, begin, v, force, before, drive, n, kick, ledger)
            if damped or sampled:
                kinetic, lost, lost_after = 0.0, 0.0, 0.0
                for i in range(end - begin):
                    after = momentum(blocks, inertia, tiles[BLOCK, t], i, v)
                    if damped:  # what is missing in the block's momentum
                        missing = after - momentum(blocks, inertia, tiles[BLOCK, t], i, before)
                        missing -= kick * force[i]
                        lost, lost_after = lost + missing * before[i], lost_after + missing * v[i]
                    kinetic += before[i] * after
                ledger[VISCOUS] -= 0.5 * lost
                ledger[VISCOUS + AFTER] -= 0.5 * lost_after
                if sampled:
                    ledger[KINETIC] += 0.5 * kinetic
                    ledger[GRAVITY] += potential
            force[:] = 0.0

    return move
