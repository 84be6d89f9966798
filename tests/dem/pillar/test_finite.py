"""Finite rotations: small ones are the limit, and are refused beyond it; blocks topple."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from jointwave import dem
from jointwave.cases.errors import SceneError

BLOW = {
    "pillar__length": 5.0,
    "load__direction": [0.6, 0.8, 0.0],
    "load__at": [0.1, 0.05],
    "record__stress": [1.0, 2.5],
    "record__velocity": [0.3, 2.0],
    "time__duration": 0.02,
    "motion__rotation": "finite",
}


def test_small_rotations_are_the_limit(pillar):
    """What small rotations neglect is quadratic in the amplitude: its share is linear in it."""

    def share(amplitude):
        changes = {**BLOW, "load__amplitude": amplitude}
        finite = dem.simulate(pillar(**changes))
        small = dem.simulate(pillar(**{**changes, "motion__rotation": "small"}))
        found = []
        for name in ("stress", "shear", "velocity", "displacement", "rotation"):
            a, b = finite[name].values, small[name].values
            found.append(np.abs(a - b).max() / np.abs(b).max())
        return np.array(found)

    weak, strong = share(1e3), share(1e5)
    assert (weak < 1e-4).all()
    np.testing.assert_allclose(strong / weak, 100, rtol=0.05)


def incline(pillar, slope):
    """Return the largest rotation of a loose block on a rough slope after one second."""
    angle = np.arctan(slope)
    scene = pillar(
        pillar__length=1.0,
        pillar__block=0.5,
        joints={"tension": False, "friction_angle": 60.0, "damping_ratio": 0.3},
        load={"shape": "step", "amplitude": 0.0},
        gravity={"direction": [np.sin(angle), np.cos(angle), 0.0], "static": False},
        ends__end="fixed",
        motion__rotation="finite",
        time__duration=1.0,
        record={"velocity": [0.25], "interval": 0.01},
        numerics__dem__step_fraction=0.3,
    )
    return np.abs(dem.simulate(scene).rotation.values).max()


def test_a_block_topples_where_its_weight_leaves_its_base(pillar):
    """The edge of a cube's base is d/2 from the centre, its centroid d/2 above, so it topples
    beyond tan(slope) = 1 and not before."""
    assert incline(pillar, 0.96) < 1e-3
    assert incline(pillar, 1.04) > 0.3


def test_a_load_turns_its_lever_with_the_face_that_it_acts_on(pillar):
    """A metre of rock under a force across its start turns as a rigid body, by 1.96 rad; with the
    lever of the start, 18 % further."""
    scene = pillar(
        pillar__length=1.0,
        load={"shape": "triangle", "amplitude": 1e4, "rise": 0.2, "decay": 1e3}
        | {"direction": [1.0, 0.0, 0.0], "at": [0.1, 0.0]},
        motion__rotation="finite",
        numerics__allow_large_motion=True,
        time__duration=0.6,
        record={"stress": [], "velocity": [0.5], "interval": 1e-3},
    )
    side, mass = scene.pillar.side, scene.rock.density * scene.pillar.side**2

    def turns(t, state):
        force = 1e4 * side**2 * min(t / 0.2, 1 - (t - 0.2) / 1e3)
        lever = 0.5 * np.cos(state[0]) - 0.1 * np.sin(state[0])
        return state[1], force * lever / (mass * (1 + side**2) / 12)

    angle = solve_ivp(turns, (0, 0.6), (0, 0), rtol=1e-9, max_step=1e-2).y[0, -1]
    found = dem.simulate(scene).rotation.values[0, -1]
    np.testing.assert_allclose(found, [0, 0, angle], atol=1e-3 * angle)


def test_a_row_without_points_has_no_rotations(pillar):
    found = dem.simulate(pillar(**(BLOW | {"record__velocity": []})))
    assert found.rotation.shape == (0, found.sizes["time"], 3)


def test_a_row_of_small_rotations_that_turns_too_far_is_refused(row):
    twist = {"shape": "step", "direction": [0, 1, 0], "arm": 0.1, "amplitude": 1e6}
    remedy = r"motion\.rotation .* turned .* motion.rotation = 'finite'"
    with pytest.raises(SceneError, match=remedy):
        dem.simulate(row(load=twist))
