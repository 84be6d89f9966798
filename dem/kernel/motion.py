"""Motion of the blocks of a tile in one leapfrog step, or one stage of a composed step."""

from collections.abc import Callable
from math import copysign

from jointwave.dem.contacts.chunks import LANES as L
from jointwave.dem.kernel.model import KernelFlags
from jointwave.dem.kernel.rotation import angular_momentum, rate, three, turn_blocks
from jointwave.dem.kernel.sharing import of_blocks, shared
from jointwave.joints.formula import formula

#: Rows of the tiles' table: their first chunk, block, held block, recorded block, watched contact.
CHUNK, BLOCK, HELD, PLACE, SEEN = range(5)
#: Rows of the ledger of one step, J in lanes, in the order of `results.dataset.TERMS`; at an offset
#: AFTER, the same rows for the half step after it. AFTER is not 4096 bytes: at this distance loads
#: wait for stores (300 ns a step of 100 blocks).
KINETIC, ELASTIC, VISCOUS, FRICTION, FRACTURE, BOUNDARY, GRAVITY, WORK = range(0, 8 * L, L)
AFTER = 8 * L + 8
SUMMED = VISCOUS, FRICTION, BOUNDARY, WORK  # over steps; the others are states


@shared(of_blocks)
def motion_for(form: KernelFlags) -> Callable:
    """Return the kernel of a tile's motion; absent effects are not compiled."""
    dim, freedoms, has_ledger, held, gravity = (
        form.dim, form.freedoms, form.ledger, form.held, form.gravity
    )  # fmt: skip
    mass_damping, local_damping = form.mass_damping or form.relaxed, form.local_damping
    damped, finite, matched = form.mass_damping or local_damping, form.finite, form.matched
    balanced = has_ledger and (damped or finite)  # the ledger needs the forces after the motion
    oblique, stages = form.oblique and not finite, form.stages
    composed, AT_ONCE = stages > 1, L - L % freedoms
    SPARE, BEFORE = form.buffer.spare, form.buffer.before

    @formula
    def spring_force(blocks, closure, r, a):
        """Return the force of the springs against freedom a of held block r."""
        found = 0.0
        for m in range(freedoms):
            found += blocks.springs[r, 2, a, m] * closure[r, m]
        return found

    @formula
    def close_springs(blocks, first, turn, closure, r, u, v, i, spare):
        """Advance the spring closures of held block r by its velocity."""
        for a in range(freedoms):
            spare[a] = 0.0
            for m in range(freedoms):
                moving = rate(blocks, first, turn, u, v, i + m) if finite else v[i + m]
                spare[a] += blocks.springs[r, 0, a, m] * closure[r, m]
                spare[a] += blocks.springs[r, 1, a, m] * moving
        for a in range(freedoms):
            closure[r, a] = spare[a]

    @formula
    def add_forces(blocks, first, last, begin, u, v, force, before, drive, closure, n):
        """Add weight and external forces; return the potential energy of the weight, J."""
        potential = 0.0
        if gravity:
            for a in range(dim):
                g, mass = blocks.gravity[a], blocks.mass[begin // freedoms :]
                for block in range(force.size // freedoms):
                    i, weight = freedoms * block + a, g * mass[block]
                    force[i] += weight
                    potential -= weight * u[i]
        if held:
            for r in range(first, last):
                i = freedoms * blocks.held[r] - begin
                for a in range(freedoms):
                    before[i + a] = v[i + a]
                    force[i + a] += drive[n, r, a]
                    if matched:
                        force[i + a] -= spring_force(blocks, closure, r, a)
        return potential

    @formula
    def advance(u, v, force, inverse, before, pushed, drift, keep, local, keep_old):
        """Advance velocities by the forces, then displacements by the velocities; with `keep_old`,
        store the old velocities for the ledger."""
        for i in range(u.size):
            old, gain = v[i], pushed * force[i]
            if local_damping:  # less by local |gain| along v
                gain = gain - local * copysign(abs(gain), old) if old != 0.0 else gain
            new = (keep * old if mass_damping else old) + gain * inverse[i]
            if has_ledger and keep_old:
                before[i] = old
            if not balanced:
                force[i] = 0.0
            v[i] = new
            if finite and i % 6 > 2:
                continue  # momenta turn quaternions
            u[i] += drift * new

    @formula
    def advance_oblique(blocks, first, u, v, force, before, pushed, drift):
        """Do the same for blocks from `first` on whose inertia tensors are full."""
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
    def apply_dashpots(blocks, first, last, begin, u, v, before, spare):
        """Apply the boundary dashpots: correct the velocity and displacement of held blocks."""
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
    def apply_dashpots_turned(blocks, first, r, turn, u, v, inertia, before, closure, spare):
        """Apply the boundary dashpots of held block r with finite rotations: the impulse is that on
        the unrotated block. Leave in `spare` the old and new velocities, impulses, spring forces.
        """
        block, matrices = blocks.held[r] - first, blocks.matrices[r]
        i = 6 * block
        for a in range(6):
            spare[a] = rate(blocks, first, turn, u, before, i + a)
            spare[6 + a] = rate(blocks, first, turn, u, v, i + a)
        for a in range(6):
            change = -spare[6 + a]
            for m in range(6):
                change += matrices[0, a, m] * spare[m] + matrices[1, a, m] * spare[6 + m]
            spare[12 + a] = change
            if matched:
                spare[18 + a] = spring_force(blocks, closure, r, a)
        for a in range(3):
            u[i + a] += blocks.dt * spare[12 + a]
            spare[12 + a] *= inertia[i + a]
        spun = angular_momentum(blocks.free[first + block], three(spare, 15, 1))
        spare[15], spare[16], spare[17] = spun
        for a in range(6):
            v[i + a] += spare[12 + a] / inertia[i + a]

    @formula
    def account_turned(blocks, first, r, turn, u, v, force, drive, n, kick, spare, ledger):
        """Do the same as `account_held`, from what `apply_dashpots_turned` leaves in `spare`."""
        for a in range(6):
            i = 6 * (blocks.held[r] - first) + a
            old, new = spare[a], rate(blocks, first, turn, u, v, i)
            taken, given = -0.5 * spare[12 + a], 0.5 * kick * drive[n, r, a]
            if matched:
                taken += 0.5 * kick * spare[18 + a]
            ledger[BOUNDARY] += taken * old
            ledger[BOUNDARY + AFTER] += taken * new
            ledger[WORK] += given * old
            ledger[WORK + AFTER] += given * new
            force[i] += spare[12 + a] / kick

    @formula
    def account_held(blocks, first, last, begin, v, force, before, drive, closure, n, kick, ledger):
        """Add the work of external forces and dashpots to the ledger; with damping, subtract the
        dashpot forces from `force`."""
        for r in range(first, last):
            i, matrices = freedoms * blocks.held[r] - begin, blocks.matrices[r]
            for a in range(freedoms):
                drag, old, new = 0.0, before[i + a], v[i + a]
                for m in range(freedoms):
                    drag += matrices[2, a, m] * (0.5 * (before[i + m] + v[i + m]))
                taken, given = 0.5 * kick * drag, 0.5 * kick * drive[n, r, a]
                if matched:
                    taken += 0.5 * kick * spring_force(blocks, closure, r, a)
                ledger[BOUNDARY] += taken * old
                ledger[BOUNDARY + AFTER] += taken * new
                ledger[WORK] += given * old
                ledger[WORK + AFTER] += given * new
                if damped:
                    force[i + a] -= drag

    @formula
    def account_motion(blocks, first, turn, u, v, before, inertia, force, kick, sampled, ledger):
        """Add the kinetic energy of blocks from `first` on and their damping loss to the ledger."""
        for begin in range(0, u.size, AT_ONCE):
            block, own = first + begin // freedoms, u[begin:]
            m, push = inertia[begin:], force[begin:]
            now, then, turned = v[begin:], before[begin:], turn
            if finite:
                turned = turn[begin // freedoms :]
            for c in range(min(AT_ONCE, u.size - begin)):
                after, old, new = momentum(blocks, m, block, c, now), then[c], now[c]
                if finite:
                    old = rate(blocks, block, turned, own, then, c)
                    new = rate(blocks, block, turned, own, now, c)
                if damped:  # the impulse of damping: momentum gained, less that of the forces
                    lost = after - momentum(blocks, m, block, c, then) - kick * push[c]
                    ledger[VISCOUS + c] -= 0.5 * lost * old
                    ledger[VISCOUS + AFTER + c] -= 0.5 * lost * new
                if sampled:
                    ledger[KINETIC + c] += 0.5 * (old * after)

    @formula
    def move(blocks, tiles, state, all_forces, drive, q, ledger, t, n, sampled):
        """Move the blocks of tile t in step or stage n of `drive`, and set their forces to zero."""
        begin, end = freedoms * tiles[BLOCK, t], freedoms * tiles[BLOCK, t + 1]
        first, last, kick, drift = tiles[HELD, t], tiles[HELD, t + 1], blocks.dt, blocks.dt
        block = tiles[BLOCK, t]
        if composed:
            kick, drift = blocks.stages[n % stages, 0], blocks.stages[n % stages, 1]
        # Slices begin at 0: else numba allows for negative indices and does not vectorise.
        u, v, force = state.u[begin:end], state.v[begin:end], all_forces[begin:end]
        inertia, inverse = blocks.inertia[begin:end], blocks.inverse[begin:end]
        pushed, turn, closure = 0.5 * kick * (1.0 + blocks.keep), state.turn, state.closure
        before, spare = q[BEFORE:], q[SPARE:]
        if finite:
            turn = turn[block : tiles[BLOCK, t + 1]]
        potential = add_forces(blocks, first, last, begin, u, v, force, before, drive, closure, n)
        if oblique:
            advance_oblique(blocks, block, u, v, force, before, pushed, drift)
        else:
            advance(
                u, v, force, inverse, before, pushed, drift, blocks.keep, blocks.local,
                balanced or sampled,
            )  # fmt: skip
        if held and finite:
            for r in range(first, last):
                apply_dashpots_turned(blocks, block, r, turn, u, v, inertia, before, closure, spare)
                if has_ledger:
                    account_turned(
                        blocks, block, r, turn, u, v, force, drive, n, kick, spare, ledger
                    )
        elif held:
            apply_dashpots(blocks, first, last, begin, u, v, before, spare)
        if has_ledger:
            if held and not finite:
                account_held(
                    blocks, first, last, begin, v, force, before, drive, closure, n, kick, ledger
                )
            if damped or sampled:
                account_motion(
                    blocks, block, turn, u, v, before, inertia, force, kick, sampled, ledger
                )
            if sampled:
                ledger[GRAVITY] += potential
        if balanced or oblique:
            force[:] = 0.0
        if matched:
            for r in range(first, last):
                i = freedoms * blocks.held[r] - begin
                close_springs(blocks, block, turn, closure, r, u, v, i, spare)
        if finite:
            turn_blocks(blocks, block, turn, u, v, drift)

    return move
