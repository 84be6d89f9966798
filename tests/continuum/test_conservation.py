"""Momentum of free bodies, mirrored blows, drag on rock that drifts, and weight on joints of
friction alone."""

import numpy as np
import pytest

from jointwave.continuum.run import simulate
from jointwave.continuum.stepping.leapfrog import Leapfrog
from tests.continuum.stacked import Force, stack
from tests.continuum.test_explicit import joined, problem

JOINTS = {
    "slip": {"friction": np.array([0.3, 0.2]), "cohesion": np.array([0.01, 0.02])},
    "no tension": {"tension": np.zeros(2, bool)},
}
WAYS = {2: [0.6, -0.8], 3: [0.48, -0.64, -0.6]}


@pytest.mark.parametrize(("dim", "joints"), [*((2, kind) for kind in JOINTS), (3, "slip")])
def test_momenta_are_the_impulse_of_the_load(dim, joints):
    """Of an eccentric blow, whatever the joints do: their tractions act at one place on both sides.
    The lever of a node is its unloaded place."""
    body = stack(dim, 3, 2, 1, order=1)
    corner = body.x.sum(axis=1).argmax()
    freedom = dim * corner + np.arange(dim)
    own = problem(body, joined(2, **JOINTS[joints]))
    dt = 0.3 * own.critical_step()
    push = Force(freedom, np.array(WAYS[dim]), lambda t: 0.2 * np.sin(t), dt)
    steps = Leapfrog(own._replace(forces=push), dt, 1)
    steps.take(0, 200, 1000)
    impulse = dt * push.at(0, 200).sum(axis=0)
    momentum = (body.mass * steps.v).reshape(-1, dim)
    arms, force = np.zeros((len(body.x), 3)), np.zeros((len(body.x), 3))
    arms[:, :dim], force[:, :dim] = body.x, momentum
    blow = np.append(impulse, np.zeros(3 - dim))
    turn = np.cross(arms[corner], blow)
    np.testing.assert_allclose(force.sum(axis=0), blow, atol=1e-11 * np.abs(blow).max())
    found = np.cross(arms, force).sum(axis=0)
    np.testing.assert_allclose(found, turn, atol=1e-11 * np.abs(turn).max())
    if joints == "slip":
        assert steps.state.sums[1] > 0


KINDS = {
    "elastic": {},
    "slip": {"friction_angle": 20.0, "cohesion": 1e4},
    "no tension": {"tension": False},
}


@pytest.mark.parametrize("mirror", [0, 2], ids=["x", "z"])
@pytest.mark.parametrize("joints", KINDS)
def test_a_mirrored_blow_gives_the_mirrored_motion(joints, mirror, short):
    """x to -x: the displacement along x and the turns about y and z change their signs; z alike."""
    signs = np.ones(3)
    signs[mirror] = -1

    def struck(signs):
        way, at = signs * [0.48, 0.6, -0.64], signs[[0, 2]] * [0.1, -0.05]
        load = {"shape": "sine", "amplitude": 1e5, "period": 1e-3}
        load |= {"direction": way.tolist(), "at": at.tolist()}
        scene = short(load=load, joints=KINDS[joints], numerics__continuum__order=1)
        return simulate(scene, dim=3)

    one, other = struck(np.ones(3)), struck(signs)
    changes = {"stress": 1.0, "shear": signs[[0, 2]], "velocity": signs, "rotation": -signs}
    for name, change in changes.items():
        known = one[name].values * change
        assert np.abs(other[name].values - known).max() < 1e-10 * np.abs(known).max() > 0


def test_drag_on_rock_that_drifts_strains_nothing():
    """v shrinks by (1 - a) / (1 + a), a = alpha dt / 2, at every step."""
    body, alpha = stack(2, 3, 2, 1, order=1), 0.5
    own = problem(body, joined(2), alpha=alpha)
    dt = 0.3 * own.critical_step()
    steps = Leapfrog(own, dt, 1, energy=False)
    drift = np.tile([0.3, -0.7], len(body.x))
    steps.throw(drift)
    steps.take(0, 51, 1000)
    a = alpha * dt / 2
    shrinks = ((1 - a) / (1 + a)) ** 51
    assert shrinks < 0.3
    np.testing.assert_allclose(steps.v, drift * shrinks, rtol=0, atol=1e-12)


@pytest.mark.parametrize("tension", [True, False])
def test_joints_of_friction_alone_stand_under_weight_on_a_slope(pillar, tension):
    """Nothing presses them before the weight is on. At 10 degrees the only joint holds, and carries
    the weight above it: along the joint g sin, across it g cos."""
    slope = np.pi / 18
    scene = pillar(
        pillar__length=1.0, soft_layers=[], load={"shape": "step", "amplitude": 0.0},
        gravity={"direction": [np.sin(slope), np.cos(slope), 0.0]}, ends__end="fixed",
        joints={"friction_angle": 30.0, "tension": tension}, time__duration=2e-4,
        record={"stress": [0.5], "velocity": [0.0], "interval": 1e-4},
        numerics__continuum={"scheme": "implicit", "steps_per_period": 10},
    )  # fmt: skip
    result = simulate(scene, dim=2)
    stress, shear = (result[name].values[0].ravel() for name in ("stress", "shear"))
    weight = 2400.0 * 9.81 * 0.5
    assert stress == pytest.approx(weight * np.cos(slope), rel=1e-8)
    assert np.abs(shear).max() == pytest.approx(weight * np.sin(slope), rel=1e-8)
