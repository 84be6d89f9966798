"""One step of one tile of a row: forces of its joints, load and ends, then its motion.

A tile needs its left neighbour's last joint at the same step and its right neighbour's first block
at the step before: `dem.spatial.march` has the order in which tiles take their steps.
"""

from collections.abc import Callable

from dem.spatial.ends import ends_for
from dem.spatial.energy import stored_for, work_for
from dem.spatial.finite import QUATERNION
from dem.spatial.joints import joints_for, law_at
from dem.spatial.layout import DRAG, FORCE, LEFT, Form
from dem.spatial.layout import LANES as L
from dem.spatial.layout import STRIDE as R
from dem.spatial.motion import constants_of, motion_for
from joints.formula import formula
from numerics.divergence import EVERY, SPEED, exceeds, note

CHECK = 64  # steps between two checks of a tile's speeds: others run ahead of it by some more


@formula
def displacement_of(base, n):
    """Return the displacement (m) of a shaken base in step n - 1."""
    return base[n] if n < base.size else 0.0


@formula
def add_sample(places, t, rows, at, samples, first, count, c, factor):
    """Add factor times `count` rows from `at` on, in every place in tile t, to sample c."""
    for r in range(places.shape[1]):
        if places[0, r] == t:
            for k in range(count):
                samples[r, first + k, c] += factor * rows[at + k * R + places[1, r]]


def step_for(form: Form) -> Callable:
    """Return the formula of one step of one tile."""
    ledger, varied, finite = form.ledger, form.parts.varied, form.finite
    history_kept, drags = form.rate_rows + form.point_rows > 0, form.parts.dashpots and form.ledger
    by_points, shaken = form.points, form.base
    has_start, has_end = form.start or ledger, form.end  # a ledger needs the loaded face's velocity
    speeds, rows = form.freedoms * R, form.motion_rows
    joint_forces, advance = joints_for(form), motion_for(form)
    add_at_face, add_reaction, advance_closure = ends_for(form)
    add_stored, (add_work, add_end_work) = stored_for(form), work_for(form)

    @formula
    def step(
        model, state, recorded, q, carry, own, count, t, n, stride, limit, found,
    ):  # fmt: skip
        """Advance tile t by step n.

        q : its buffer. carry : the force of the left neighbour's last joint, then of its own.
        own : the ledger of this step. count : of blocks. The rest is what `march` takes.
        """
        constants, table, points, stress, direction, base, ends = model
        motion, history, sliding, end_states = state
        contacts, centres, force, velocity, displacement = recorded
        b, m, final = constants_of(constants), motion[t], t == len(motion) - 1
        blocks = count - t * L if final else L
        joints = blocks - 1 if final else blocks
        sampled, sample = n % stride == 0, n // stride
        h, slid, tile_table = None, None, table[t if varied else 0]
        law = law_at(tile_table, 0)
        if history_kept:
            h = history[t]
        if by_points:
            slid = sliding[t]
        before, after = 0.0, 0.0
        if shaken:
            before, after = displacement_of(base, n), displacement_of(base, n + 1)

        if not final:
            following = motion[t + 1]
            for k in range(rows):
                m[k * R + L] = following[k * R]
        joint_forces(b, law, tile_table, points, m, h, q, joints, slid)
        for k in range(b.freedoms):
            q[k * R] = carry[k] if t > 0 else 0.0
            if drags:
                q[DRAG + k * R] = carry[6 + k] if t > 0 else 0.0
            if final:  # where the last block would have a joint
                q[k * R + blocks] = 0.0
                if drags:
                    q[DRAG + k * R + blocks] = 0.0
        if finite and final:
            for k in range(3):
                q[LEFT + k * R + blocks] = 0.0
                if drags:
                    q[DRAG + LEFT + k * R + blocks] = 0.0
        stress_now = stress[n] if t == 0 and n < stress.size else 0.0
        if t == 0:
            add_at_face(b, q, 0, 1.0, stress_now, direction)
            if has_start:
                add_reaction(b, ends[0], end_states[0], m, q, 0, 1.0, before + after)
        if has_end and final:
            add_reaction(b, ends[1], end_states[1], m, q, blocks - 1, -1.0, 0.0)
        if sampled:
            add_sample(contacts, t, q, FORCE, force, 0, b.freedoms, sample, 1.0)
            add_sample(centres, t, m, 0, displacement, 0, b.freedoms, sample, 1.0)
            if finite:
                add_sample(centres, t, m, QUATERNION, displacement, 6, 1, sample, 1.0)
            add_sample(centres, t, m, speeds, velocity, 0, b.freedoms, sample, 0.5)
            if ledger:
                add_stored(b, law, tile_table, points, m, h, q, own, blocks, joints)

        advance(b, m, q, blocks)

        if limit is not None and (n + 1) % CHECK == 0:
            for k in range(b.freedoms):
                at = speeds + k * R
                if exceeds(m[at : at + L], limit[k]):
                    note(found, n + 1, SPEED, n - EVERY)
        if has_start and t == 0:
            advance_closure(b, ends[0], end_states[0], m, 0, 1.0, after)
        if has_end and final:
            advance_closure(b, ends[1], end_states[1], m, blocks - 1, -1.0, 0.0)
        if sampled:
            add_sample(centres, t, m, speeds, velocity, 0, b.freedoms, sample, 0.5)
        if ledger:
            add_work(b, m, q, own, blocks, sampled)
            if t == 0:
                end, at = ends[0], end_states[0]
                add_end_work(b, end, at, own, stress_now, direction, before, after)
            if has_end and final:
                add_end_work(b, ends[1], end_states[1], own, 0.0, direction, 0.0, 0.0)
        for k in range(b.freedoms):
            carry[k] = q[k * R + L]
            if drags:
                carry[6 + k] = q[DRAG + k * R + L]

    return step
