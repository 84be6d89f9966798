"""Blocks in space that turn by any angle: free bodies, momenta, energies, turned scenes, limits."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from jointwave.dem.contacts.chunks import chunks_of
from jointwave.dem.contacts.faces import Contacts, extents, frames_of
from jointwave.dem.kernel.leapfrog import march
from jointwave.dem.kernel.model import (
    Blocks,
    KernelFlags,
    Model,
    held_by,
    samples_for,
    state_at_rest,
)
from jointwave.joints.law import law, parts_of, table_of

SIDES, DENSITY, NORMAL, SHEAR = np.array([1.0, 1.3, 0.8]), 2500.0, 3e9, 1.1e9
COUNT = (2, 3, 2)
DT = 3e-5
NEVER = 1 << 40


def blocks_of(turned=None, dashpots=0.0, held=None, **strengths):
    """Return the model of 2 x 3 x 2 boxes and the places of their centroids, all of them turned.

    held : matrix of dashpots of each block; none by default, but one kernel serves both."""
    turned = Rotation.identity() if turned is None else turned
    places = np.stack(np.unravel_index(np.arange(12), COUNT), 1) * SIDES
    numbers = np.arange(12).reshape(COUNT)
    ahead = [
        np.stack([numbers.take(range(n - 1), a).ravel(), numbers.take(range(1, n), a).ravel()], 1)
        for a, n in enumerate(COUNT)
    ]
    axis = np.repeat(np.arange(3), [len(one) for one in ahead])
    normal, count = np.eye(3)[axis], len(axis)
    frame, half = frames_of(normal), SIDES[axis, None] / 2 * normal
    sizes = np.abs(frame[:, 1:] @ SIDES)
    frame, half = turned.apply(frame.reshape(-1, 3)).reshape(frame.shape), turned.apply(half)
    faces = Contacts(
        blocks=np.concatenate(ahead),
        area=sizes.prod(axis=1),
        centre=np.zeros((count, 3)),
        frame=frame,
        arm=np.stack([half, -half], axis=1),
        spread=sizes[:, :, None] ** 2 / 12 * np.eye(2),
        column=np.zeros(count, dtype=int),
        walls=(),
    )
    gauss = np.array([[1, 1], [1, -1], [-1, 1], [-1, -1]]) / np.sqrt(12)
    share = np.tile(faces.area[:, None, None] / 4, (1, 4, 1))
    points = np.concatenate([gauss * sizes[:, None], share], axis=2)
    own = law(
        np.full(count, NORMAL),
        np.full(count, dashpots) if dashpots else None,
        np.full(count, not strengths),
        shear_stiffness=np.full(count, SHEAR),
        **{name: np.full(count, value) for name, value in strengths.items()},
    )
    mass = DENSITY * SIDES.prod()
    moments = mass / 12 * (SIDES @ SIDES - SIDES**2)
    axes = turned.as_matrix()
    tensor = np.tile(axes @ np.diag(moments) @ axes.T, (12, 1, 1))
    inertia = np.column_stack([np.full((12, 3), mass), np.diagonal(tensor, axis1=1, axis2=2)])
    form = KernelFlags(
        3, True, parts_of(own), True, False, False, False, True, True, oblique=True, finite=True
    )  # fmt: skip
    chunks = chunks_of(faces, 12, 6, extent=extents(faces, points, 12), points=points)
    masses = np.zeros((12, 6, 6))
    masses[:, :3, :3], masses[:, 3:, 3:] = mass * np.eye(3), tensor
    held = np.zeros((6, 6)) if held is None else held
    held = held_by(np.tile(held, (12, 1, 1)), np.arange(12), masses, DT)
    blocks = Blocks(inertia, DT, 1.0, 0.0, np.zeros(3), tensor)
    model = Model(form, blocks, chunks, table_of(own), held, np.arange(12), np.arange(count))
    return model, turned.apply(places)


def take(model, state, steps, drive=None, samples=None, stride=NEVER):
    """Take the steps 1 .. steps, or 0 .. where they have samples."""
    first = 0 if samples else 1
    samples = samples or samples_for(model, 0)
    march(model, state, samples, stride, (first, first + steps), drive)


def orientation(state):
    """Return the rotations of all blocks."""
    return Rotation.from_quat(np.column_stack([state.u[:, 3:], state.turn]))


def put_turned(state, places, rotation):
    """Turn blocks, with their motion, about the origin."""
    now = places + state.u[:, :3]
    quaternions = (rotation * orientation(state)).as_quat()
    state.u[:, :3] += rotation.apply(now) - now
    state.u[:, 3:], state.turn[:] = quaternions[:, :3], quaternions[:, 3]
    state.v[:] = np.column_stack([rotation.apply(state.v[:, :3]), rotation.apply(state.v[:, 3:])])


def moving(model, speed=0.5, seed=1):
    """Return a state with random velocities and angular momenta."""
    state = state_at_rest(model)
    state.v[:] = speed * np.random.default_rng(seed).standard_normal((12, 6))
    state.v[:, 3:] = (model.blocks.tensor @ state.v[:, 3:, None])[..., 0]
    return state


def momenta(model, state, places):
    """Return linear and angular momentum about the origin, and their sizes."""
    linear = model.inertia[:, :3] * state.v[:, :3]
    angular = np.cross(places + state.u[:, :3], linear) + state.v[:, 3:]
    return linear.sum(axis=0), angular.sum(axis=0), np.abs(linear).sum(), np.abs(angular).sum()


def euler(tensor, momentum, time):
    """Return the rotation of a free body after some time, by its equations of motion."""

    def rates(_, q):
        w, r = q[3], q[:3]
        back = Rotation.from_quat(q).inv()
        spin = Rotation.from_quat(q).apply(np.linalg.solve(tensor, back.apply(momentum)))
        return 0.5 * np.append(w * spin + np.cross(spin, r), -spin @ r)

    found = solve_ivp(rates, (0, time), [0, 0, 0, 1], method="DOP853", rtol=1e-12, atol=1e-14)
    return Rotation.from_quat(found.y[:, -1])


@pytest.mark.parametrize("vector", [[0.0, 0.0, 0.0], [0.5, -0.3, 0.8]], ids=["own axes", "turned"])
def test_a_free_body_tumbles_as_eulers_equations_have_it(vector):
    """About its intermediate axis, nearly, which is unstable: it turns over; to second order."""
    turned = Rotation.from_rotvec(vector)
    model, places = blocks_of(turned, friction=0.5)
    tensor = model.blocks.tensor[5]
    axis, spin = turned.apply([[1.0, 0.0, 0.0], [30.0, 0.1, 0.1]])
    momentum = tensor @ spin
    exact = euler(tensor, momentum, 1.2)
    assert exact.apply(axis) @ axis < 0  # turned over
    error = []
    for parts in (1, 2):
        short = model._replace(blocks=model.blocks._replace(dt=1e-3 / parts))
        state = state_at_rest(short)
        state.u[:, :3] = 10 * places  # far apart
        state.v[5, 3:] = momentum
        take(short, state, 1200 * parts)
        error.append((exact.inv() * orientation(state)[5]).magnitude())
        assert (state.v[5, 3:] == momentum).all()
    assert error[0] < 0.02 and error[0] / error[1] == pytest.approx(4, rel=0.05)
    assert np.abs(np.linalg.norm(state.u[5, 3:]) ** 2 + state.turn[5] ** 2 - 1) < 1e-14


DAMPED, SLIPS = {"dashpots": 1e-5}, {"friction": 0.3}


@pytest.mark.parametrize("law", [DAMPED, SLIPS], ids=["dashpots", "slip"])
def test_momenta_are_conserved(law):
    """Whatever joints do: what acts on two blocks acts at one place."""
    model, places = blocks_of(**law)
    state = moving(model, 2.0)
    linear, angular, size, turning = momenta(model, state, places)
    take(model, state, 2000)
    after, spun, *_ = momenta(model, state, places)
    assert np.abs(state.u[:, 3:]).max() > 0.01
    np.testing.assert_allclose(after, linear, rtol=0, atol=1e-12 * size)
    np.testing.assert_allclose(spun, angular, rtol=0, atol=1e-12 * turning)


@pytest.mark.parametrize("law", [DAMPED, SLIPS], ids=["dashpots", "slip"])
def test_turning_first_or_afterwards_gives_the_same(law):
    """Of a state that moves; and of blocks that are cut in the turned directions."""
    rotation = Rotation.from_rotvec([0.7, -1.9, 0.4])
    model, places = blocks_of(**law)
    first, after = moving(model), moving(model)
    put_turned(first, places, rotation)
    take(model, first, 300)
    take(model, after, 300)
    put_turned(after, places, rotation)
    np.testing.assert_allclose(first.u[:, :3], after.u[:, :3], rtol=0, atol=1e-12)
    np.testing.assert_allclose(first.v, after.v, rtol=0, atol=1e-9 * np.abs(after.v).max())
    cut, there = blocks_of(rotation, **law)
    other = state_at_rest(cut)
    start = moving(model).v
    other.v[:] = np.column_stack([rotation.apply(start[:, :3]), rotation.apply(start[:, 3:])])
    take(cut, other, 300)
    np.testing.assert_allclose(there + other.u[:, :3], places + after.u[:, :3], rtol=0, atol=1e-11)


def left_over(law, dt, drive=None, speed=2.0):
    """Return what the ledger lacks over the largest of its terms."""
    model, _ = blocks_of(**law)
    model = model._replace(blocks=model.blocks._replace(dt=dt))
    masses = np.zeros((12, 6, 6))
    masses[:, range(3), range(3)], masses[:, 3:, 3:] = model.inertia[:, :3], model.blocks.tensor
    held = held_by(model.held.matrices[:, 2], np.arange(12), masses, dt)
    model = model._replace(held=held)
    state, steps = moving(model, speed), round(0.03 / dt)
    samples = samples_for(model, steps)
    acting = None if drive is None else np.tile(drive, (steps, 12, 1))
    take(model, state, steps, acting, samples, 1)
    energy = samples.energy
    left = energy.sum(axis=0) - 2 * energy[-1]
    return np.abs(left - left[2])[3:].max() / np.abs(energy).max(), energy


@pytest.mark.parametrize(
    "more", [{}, {"held": np.diag([1e4, 2e4, 1e4, 3e3, 1e3, 2e3])}], ids=["joints", "blocks"]
)
def test_the_ledger_closes_to_second_order(more):
    """Of joints that hold, with dashpots of their own and of blocks, under constant loads."""
    law = DAMPED | more
    drive = np.array([1e5, -2e5, 0.0, 1e4, 0.0, 3e4]) if "held" in law else None
    (coarse, energy), (fine, _) = (left_over(law, dt, drive) for dt in (DT, DT / 4))
    assert coarse < 2e-3 and coarse / fine > 8
    taken = {"dashpots": 2, "held": 5}
    for name in law:
        assert energy[taken[name], -1] > 1e-2 * energy.max()


def test_points_that_leave_the_other_face_carry_nothing():
    """A block beside the other one, or behind it, or far above."""
    for shift in ([0.0, 0.0, -2.0], [-3.0, 0.01, 0.01], [1.0, 0.0, 0.0]):
        model, _ = blocks_of(friction=0.3)
        state = state_at_rest(model)
        state.u[model.chunks.pair[0, 64] // 6, :3] = shift
        take(model, state, 1)
        assert not state.v[0].any()
