"""How the ends hold the end blocks in each step: see `ends` for the formulas."""

from dem.damping import kept
from dem.spatial.layout import STRIDE as R
from dem.spatial.motion import (
    angular_velocity,
    finite_moment,
    gains,
    net_force,
    net_moment,
    spin_of,
    turns,
)
from dem.spatial.scratch import LEFT
from numerics.jit import inlined
from numerics.optional import either


@inlined
def hold(end, state, motion, s, q, i, moved):
    """Add the force of an end on block i of tile s to the scratch, where there is an end.

    moved : the way of its base over the step before and the one to come, m; None where it stands.
    """
    if end is not None:
        _hold(end, state, motion, s, q, i, moved)


@inlined
def _hold(end, state, motion, s, q, i, moved):
    lane = i if end.side > 0.0 else i + 1
    put(q, lane, end.side, end.steady, motion)
    before, mean, r = state.velocity, state.mean, state.reaction
    face_velocity(before, s, i, end.arm, motion)
    expected_velocity(mean, motion, s, q, i, end.arm)
    for k in range(r.size):
        pace = less_base(before[k] + mean[k], moved, end.base[k], motion.dt)
        mean[k] = end.stiffness[k] * state.closure[k] + 0.5 * end.viscosity[k] * pace
    for k in range(r.size):
        r[k] = 0.0
        for m in range(r.size):
            r[k] -= end.matrix[k, m] * mean[m]
    put(q, lane, end.side, r, motion)


@inlined
def less_base(pace, moved, base, dt):
    """Return the sum of a face's velocities before and after the step, less that of its base."""
    if moved is None:
        return pace
    return pace - moved * base / dt


@inlined
def settle(end, state, motion, s, i, base):
    """Advance the closure of an end by the step just taken and the way of its base (m)."""
    if end is not None:
        after, w = state.mean, state.closure
        face_velocity(after, s, i, end.arm, motion)
        for k in range(w.size):
            w[k] = end.decay[k] * w[k] + end.gain[k] * after[k] - base * end.base[k]


@inlined
def put(q, lane, side, f, motion):
    """Add a force on the block, given at its face, to the joint's force in this lane."""
    either(motion.finite, put_at_face, put_at_centroid)(q, lane, side, f, motion.arm)


@inlined
def put_at_face(q, lane, side, f, arm):
    """Add force and moment about the face's centre."""
    for k in range(f.size):
        q[k * R + lane] += side * f[k]


@inlined
def put_at_centroid(q, lane, side, f, arm):
    """Add force and moment about the centroid, which is where finite rotations take it."""
    at = 3 * R if side > 0.0 else LEFT
    for k in range(3):
        q[k * R + lane] += side * f[k]
    q[at + lane] += f[3] - side * arm * f[2]
    q[at + R + lane] += f[4]
    q[at + 2 * R + lane] += f[5] + side * arm * f[0]


@inlined
def face_velocity(p, s, i, arm, motion):
    """Write the velocity of the end face of block i into p."""
    v = p.size * R + i
    p[0], p[1], p[2] = s[v], s[v + R], s[v + 2 * R]
    turn_face(p, s, i, arm, motion)


@inlined
def turn_face(p, s, i, arm, motion):
    """Add what the block's rotation gives to its face, where blocks turn."""
    if arm is not None:
        p[3], p[4], p[5] = either(motion.finite, angular_velocity, spin_of)(motion, s, i)
        lever(p, arm)


@inlined
def lever(p, arm):
    """Carry a velocity from the centroid to the face, in place."""
    if arm is not None:
        p[0] += arm * p[5]
        p[2] -= arm * p[3]


@inlined
def expected_velocity(p, motion, s, q, i, arm):
    """Write the velocity of the face after the step, without the end, into p."""
    v = p.size * R + i
    gain = gains(motion.push, motion.fall, net_force(q, i))
    p[0] = kept(motion.keep, s[v]) + gain[0]
    p[1] = kept(motion.keep, s[v + R]) + gain[1]
    p[2] = kept(motion.keep, s[v + 2 * R]) + gain[2]
    _expected_turn(p, motion, s, q, i, arm)


@inlined
def _expected_turn(p, motion, s, q, i, arm):
    if arm is not None:
        moment = either(motion.finite, net_moment, finite_moment)(q, i, motion.arm)
        old = either(motion.finite, angular_velocity, spin_of)(motion, s, i)
        gain = turns(motion.twist, moment)
        p[3] = kept(motion.keep, old[0]) + gain[0]
        p[4] = kept(motion.keep, old[1]) + gain[1]
        p[5] = kept(motion.keep, old[2]) + gain[2]
        lever(p, arm)
