"""The block on a slope: balance of forces and energy, and the angle at which it starts."""

from math import cos, radians, sin, tan

import numpy as np
import pytest

from jointwave.compare.exact.blocks import sliding_block

G = 9.81


@pytest.fixture
def slope(scene):
    """Return a function of degrees of a slope and of friction: a block on it."""

    def make(angle, friction=30.0, rotation="none"):
        beta = radians(angle)
        way = [0.6 * sin(beta), cos(beta), 0.8 * sin(beta)]
        return scene(
            pillar={"length": 1.0},
            joints={"friction_angle": friction},
            load={"amplitude": 0.0},
            ends={"end": "fixed"},
            gravity={"direction": way, "static": False},
            motion={"rotation": rotation},
            record={"stress": [0.25, 0.5, 1.0], "velocity": [0.25, 0.5, 0.75]},
        )

    return make


def test_below_the_friction_angle_it_rests_and_shear_balances_its_weight(slope):
    result = sliding_block.solve(slope(29.9))
    assert not result.velocity.values.any() and not result.displacement.values.any()
    weight = 2400 * G * np.array([0.25, 0.5, 1.0])
    assert np.allclose(np.linalg.norm(result.shear, axis=-1).T, sin(radians(29.9)) * weight)
    assert np.allclose(result.stress[:, 0], cos(radians(29.9)) * weight)


def test_above_it_accelerates_by_what_friction_leaves(slope):
    """m g s sin(beta) = m v^2/2 + m g cos(beta) tan(phi) s at every time; on the joint the shear is
    the friction."""
    at = slope(45.0)
    assert sliding_block.applies(at)
    result, beta = sliding_block.solve(at), radians(45.0)
    v, s = (np.linalg.norm(x[0], axis=-1) for x in (result.velocity, result.displacement))
    friction = G * cos(beta) * tan(radians(30.0))
    assert np.allclose(G * sin(beta) * s, v**2 / 2 + friction * s, rtol=1e-12)
    assert v[-1] == pytest.approx((G * sin(beta) - friction) * result.time.values[-1], rel=1e-12)
    assert np.allclose(np.linalg.norm(result.shear[1], axis=-1), 2400 * 0.5 * friction)
    assert np.allclose(result.velocity.values[0] @ [0.8, 0.0, -0.6], 0, atol=1e-15)
    assert not result.velocity[2].values.any()


@pytest.mark.parametrize(
    "angle, friction, topples", [(20, 40, False), (60, 45, False), (60, 55, True)]
)
def test_a_block_that_may_turn_topples_where_friction_holds_it(slope, angle, friction, topples):
    """What the joint carries leaves the face, a/2 = d/2 from the centre, where along z, of 0.8 of
    the slope, 0.8 min(tan beta, tan phi) exceeds 1: 0.29, 0.8, 1.14."""
    answer = sliding_block.applies(slope(angle, friction, "small"))
    assert answer.reason == ("the block topples" if topples else "")
