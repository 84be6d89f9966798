"""One step of one tile, and the order in which tiles take their steps.

A tile needs its left neighbour's last joint at the same step and its right neighbour's first
block at the step before. So a tile may run ahead of its right neighbour by nothing and behind its
left neighbour by one: the tiles t, t - 1, t - 2, ... take the steps n, n + 1, n + 2, ... while
they are in the cache, and several threads follow one another along the row, each some steps
later. Every block does the same arithmetic in whatever order, so results are bit-identical.
"""

from dem.spatial.book import close
from dem.spatial.contact import forces
from dem.spatial.hold import hold, put, settle
from dem.spatial.layout import LANES, freedoms
from dem.spatial.layout import STRIDE as R
from dem.spatial.ledger import book_motion, keep_velocities
from dem.spatial.motion import advance
from dem.spatial.record import sample_after, sample_before
from dem.spatial.scratch import DRAG, LEFT
from dem.spatial.stored import book_states
from joints.laws import pick
from numerics.atomic import give_way, peek, post
from numerics.borrowed import borrowed
from numerics.denormals import flush_tiny, restore_tiny
from numerics.divergence import EVERY, SPEED, creates_energy, exceeds, note
from numerics.jit import inlined, jitted
from numerics.optional import either, given

RUN = 16  # tiles between two looks at the others' progress; more than the steps of a pass
LOOK = 64  # steps between two looks at a tile's speeds: others run ahead of it by some more


@jitted
def march(model, state, room, samples, first, last):
    """Take the steps first .. last - 1 on one thread."""
    tiny = flush_tiny()
    model, state, room, samples = borrowed((model, state, room, samples))
    for n in range(first, last, room.depth):
        depth = min(room.depth, last - n)
        if is_lost(room.guard):
            break
        run_diagonals(model, state, room, samples, n, depth, 0, 0, len(state.motion) + depth - 1)
        close_books(model, state, room.books, room.guard, samples, n, depth, 0)
    restore_tiny(tiny)


@inlined
def run_diagonals(model, state, room, samples, n, depth, thread, first, last):
    """Let diagonal k = first .. last - 1 take tile k - j by step n + j, j = 0 .. depth - 1."""
    tiles = len(state.motion)
    for k in range(first, min(last, tiles + depth - 1)):
        for j in range(max(0, k - tiles + 1), min(depth, k + 1)):
            step(model, state, room, samples, k - j, n + j, thread, thread * room.depth + j)


@jitted
def march_in_turn(model, state, room, samples, first, last, thread, progress):
    """Take this thread's share of the steps first .. last - 1, in turn with the others.

    Band B of `depth` steps belongs to thread B modulo their number. It enters a run of tiles when
    band B - 1 has left the next run: what it reads is finished then, and what it writes nobody
    reads any more. progress : int64 [threads + 1], zero at first: B runs + r when r runs of band
    B are left behind, for each thread, and how many bands have closed their accounts.
    """
    tiny = flush_tiny()
    model, state, room, samples = borrowed((model, state, room, samples))
    depth, threads = room.depth, progress.size - 1
    runs = (len(state.motion) + depth - 1 + RUN - 1) // RUN
    for band in range(thread, (last - first + depth - 1) // depth, threads):
        n = first + band * depth
        steps = min(depth, last - n)
        for run in range(runs):
            if band > 0:
                await_count(progress, (band - 1) % threads, (band - 1) * runs + min(run + 2, runs))
            begin, end = run * RUN, (run + 1) * RUN
            if not is_lost(room.guard):
                run_diagonals(model, state, room, samples, n, steps, thread, begin, end)
            post(progress, thread, band * runs + run + 1)
        await_count(progress, threads, band)
        close_books(model, state, room.books, room.guard, samples, n, steps, thread * depth)
        post(progress, threads, band + 1)
    restore_tiny(tiny)


@inlined
def await_count(progress, k, count):
    """Wait until a counter has got so far."""
    while peek(progress, k) < count:
        give_way()


@inlined
def is_lost(guard):
    """Return whether a run has been found out of bounds."""
    if guard is None:
        return False
    return guard.found[0] >= 0


@inlined
def close_books(model, state, books, guard, samples, n, depth, slot):
    """Sum up the accounts of steps n .. n + depth - 1, in their order."""
    if books is not None:
        for j in range(depth):
            close(books[slot + j], state.sums, samples.energy, model.accounts, n + j, model.stride)
            if (n + j) % model.stride == 0:
                creates_energy(guard, samples.energy, (n + j) // model.stride, n + j)


@inlined
def step(model, state, room, samples, t, n, thread, slot):
    """Advance tile t by step n."""
    s, h = state.motion[t], pick(state.history, t)
    q, carry = room.scratch[thread], room.carry[slot]
    contact, motion = model.contact, model.motion
    half, rows = freedoms(contact.rows), len(contact.rows.motion)
    book = pick(room.books, slot)
    drag = given(book, contact.damped)
    final = t == len(state.motion) - 1
    blocks = model.last if final else LANES
    sampled = n % model.stride == 0

    if not final:
        show_next(s, state.motion[t + 1], rows)
    joints = blocks - 1 if final else blocks
    forces(contact, pick(contact.table, t), s, h, q, drag, joints, book, pick(state.slides, t))
    if t == 0:
        clear(q, drag, half, 0)
        put_load(model.load, motion, q, n)
        hold(model.start, state.start, motion, s, q, 0, ways(model.load.base, n))
    else:
        receive(carry, q, drag, half)
    if final:
        clear(q, drag, half, blocks)
        either(motion.finite, nothing, clear_left)(q, drag, blocks)
        hold(model.end, state.end, motion, s, q, blocks - 1, None)
    if sampled:
        sample_before(model.receivers, samples, half, s, q, t, n // model.stride)
        book_states(model, book, pick(contact.table, t), s, h, blocks, final)
    keep_velocities(book, motion, half, s, q, blocks)

    advance(motion, contact.rows, s, q, blocks)
    watch(room.guard, s, half, n + 1)

    if t == 0:
        settle(model.start, state.start, motion, s, 0, way(model.load.base, n + 1))
    if final:
        settle(model.end, state.end, motion, s, blocks - 1, 0.0)
    if sampled:
        sample_after(model.receivers, samples, half, s, t, n // model.stride)
    book_motion(model, state, book, drag, s, q, blocks, t, n, sampled)
    pass_on(carry, q, drag, half)


@inlined
def watch(guard, s, half, n):
    """Look at the velocities of a tile after n steps, now and then."""
    if guard is not None and n % LOOK == 0:
        for k in range(half):
            if exceeds(s[(half + k) * R : (half + k) * R + LANES], guard.limit[k]):
                note(guard.found, n, SPEED, n - EVERY - 1)


@inlined
def put_load(load, motion, q, n):
    """Add the load of step n on the start's face; it is zero after the last step that acts."""
    if n < load.stress.size:
        put(q, 0, 1.0, load.stress[n] * load.direction, motion)


@inlined
def way(base, n):
    """Return the way (m) of a shaken base in step n - 1."""
    if base is None:
        return 0.0
    return base[n] if n < base.size else 0.0


@inlined
def ways(base, n):
    """Return the way (m) of a shaken base in steps n - 1 and n together; None where it stands."""
    if base is None:
        return None
    return way(base, n) + way(base, n + 1)


@inlined
def show_next(s, following, rows):
    """Put the next tile's first block into this tile's last lane."""
    for k in range(rows):
        s[k * R + LANES] = following[k * R]


@inlined
def receive(carry, q, drag, half):
    """Take over the force of the joint left of the tile."""
    for k in range(half):
        q[k * R] = carry[k]
        if drag is not None:
            q[DRAG + k * R] = carry[6 + k]


@inlined
def pass_on(carry, q, drag, half):
    """Leave the force of the tile's last joint to the next tile."""
    for k in range(half):
        carry[k] = q[k * R + LANES]
        if drag is not None:
            carry[6 + k] = q[DRAG + k * R + LANES]


@inlined
def clear(q, drag, half, lane):
    """Take away what stands where the last block would have a joint."""
    for k in range(half):
        q[k * R + lane] = 0.0
        if drag is not None:
            q[DRAG + k * R + lane] = 0.0


@inlined
def nothing(q, drag, lane):
    """Do nothing: small rotations have their moments about the faces."""


@inlined
def clear_left(q, drag, lane):
    """Take away the moment on the last block of a joint that it does not have."""
    for k in range(3):
        q[LEFT + k * R + lane] = 0.0
        if drag is not None:
            q[DRAG + LEFT + k * R + lane] = 0.0
