"""Direction of view, exaggeration and colours: the rules and their limits."""

import numpy as np
import pytest

from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.figures.animation.snapshots import STRESS, VELOCITY, settings_for

IN_SPACE = {"load__direction": [1.0, 0.0, 0.0]}
LONG = {"pillar__length": 30.0}


@pytest.fixture
def scene(pillar):
    """Blocks of 1 m in a pillar of 10 m, with keys changed."""

    keys = {"pillar": {"length": 10.0, "side": 1.0, "block": 1.0}, "record": {"stress": [5.0]}}
    return lambda **changes: pillar(**keys | changes)


def step(size):
    """The first half of the blocks moves along by `size`, m."""
    return lambda x: np.outer(np.arange(len(x)) < len(x) / 2, [0.0, size, 0.0])


def aside(points):
    return np.full_like(points, [0.002, 0.0, 0.0])


def turned(points):
    """Each block turns by 1e-3 rad about its centre."""
    x, y = points[:, 0], points[:, 1] - np.repeat(np.arange(len(points) // 8) + 0.5, 8)
    return 1e-3 * np.stack([-y, x, 0 * x], axis=1)


@pytest.mark.parametrize(
    ("changes", "moved", "scale", "stretch"),
    [
        # Neighbours come closer by at most 0.8 of a block: 0.8 m over 0.001 m is 800. A gap that
        # opens as far limits nothing but its reach, 0.04 of 30 m: 1200.
        (LONG, step(1e-3), 500, 1.35),
        (LONG, step(-1e-3), 1000, 1.35),
        # Motion aside by at most 0.04 of 10 m as drawn, over 0.002 m; thin pillars are thicker.
        (IN_SPACE, aside, 200, 1.0),
        (IN_SPACE | {"pillar__side": 0.45}, aside, 200, 1.0),
        (IN_SPACE | {"pillar__side": 0.25}, aside, 100, 1.8),
        (IN_SPACE | {"pillar__side": 0.1}, aside, 20, 4.5),
        # Corners of a block that turns stay within 0.35 of half a side from where they would be:
        # 0.175 m over 0.001 x sqrt(1/2) m is 247.
        (IN_SPACE | LONG | {"pillar__side": 1.35}, turned, 200, 1.0),
        ({}, None, 1, 1.0),
    ],
)
def test_motion_is_drawn_as_far_as_a_row_is_still_a_row(scene, row, changes, moved, scale, stretch):
    one = scene(**changes)
    found = settings_for(one, {"dem": row(one.block_count, displacement=moved)})
    assert (found.scale, found.stretch) == (scale, pytest.approx(stretch))


def test_the_engine_that_moves_more_decides_unless_a_scale_is_asked_for(scene, row):
    small, large = (row(10, displacement=step(size)) for size in (1e-4, 1e-3))
    both = {"dem": small, "continuum-jointed": large}
    assert settings_for(scene(), both).scale == 200
    assert settings_for(scene(), both, 7.5).scale == 7.5


@pytest.mark.parametrize(
    ("moved", "up"),
    [
        (lambda x: 0 * x + [0.0, 1.0, 0.0], [1, 0, 0]),
        (lambda x: 0 * x + [-1.0, 0.0, 0.0], [1, 0, 0]),
        (lambda x: 0 * x + [0.0, 0.0, 1.0], [0, 0, 1]),
        (lambda x: 0 * x + [-0.36, 0.8, -0.48], [0.6, 0, 0.8]),
        # A twist: no direction across the axis has more motion than another.
        (lambda x: 1e-3 * np.stack([-x[:, 2], 0 * x[:, 0], x[:, 0]], 1), [1, 0, 0]),
    ],
)
def test_most_motion_across_the_axis_is_in_the_plane_of_the_picture(scene, row, moved, up):
    found = settings_for(scene(), {"dem": row(10, displacement=moved)})
    assert found.up == pytest.approx(np.array(up))


@pytest.mark.parametrize(
    ("changes", "share", "quantity"),
    [(IN_SPACE, 0.09, VELOCITY), (IN_SPACE, 0.11, STRESS), ({}, 0.0, STRESS)],
)
def test_waves_of_shear_are_shown_by_their_velocity(scene, row, changes, share, quantity):
    """Where the axial stress is less than a tenth of that of a plane wave of this motion, 2 m/s."""
    one = scene(**changes)
    stress = [[0.0] * 10, [share * 2.0 * calibrate(one).impedance] * 10]
    found = settings_for(one, {"dem": row(10, displacement=aside, stress=stress)})
    assert found.quantity == quantity
