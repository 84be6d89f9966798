"""Direction of view, exaggeration and colours: the rules and their limits."""

import numpy as np
import pytest

from jointwave import cases
from jointwave.compare.figures.animation.settings import STRESS, VELOCITY, round_down, settings_for
from jointwave.compare.figures.animation.snapshots import take
from jointwave.compare.scenes import find

IN_SPACE = {"load__direction": [1.0, 0.0, 0.0]}


@pytest.fixture
def scene(pillar):
    """Ten blocks of 1 m in a pillar of 10 m, with keys changed."""

    def made(**changes):
        keys = {"pillar": {"length": 10.0, "side": 1.0, "block": 1.0}, "record": {"stress": [5.0]}}
        return pillar(**(keys | changes))

    return made


@pytest.mark.parametrize(
    ("value", "round_one"), [(1, 1), (1.99, 1), (2, 2), (49, 20), (5e3, 5e3), (0.7, 0.5)]
)
def test_scales_are_round(value, round_one):
    assert round_down(value) == pytest.approx(round_one)


def test_neighbours_come_closer_by_at_most_four_fifths_of_a_block(scene, row):
    """0.8 m over 0.001 m; a gap that opens as far limits nothing but its reach."""
    long = scene(pillar__length=30.0)
    closing = row(30, displacement=_step(1e-3))
    assert settings_for(long, {"dem": closing}).scale == 500  # of at most 800
    opening = row(30, displacement=_step(-1e-3))
    assert settings_for(long, {"dem": opening}).scale == 1000  # of at most 0.04 of 30 m, 1200


def _step(size):
    """The first half of the blocks moves along by `size`, m."""

    def moved(points):
        return np.outer(np.arange(len(points)) < len(points) / 2, [0.0, size, 0.0])

    return moved


@pytest.mark.parametrize(("side", "scale"), [(1.0, 200), (0.25, 100), (0.1, 20)])
def test_what_moves_aside_stays_in_its_strip(scene, row, side, scale):
    """By at most 0.04 of 10 m as drawn, over 0.002 m; thin pillars are drawn thicker."""
    aside = row(10, displacement=lambda x: np.full((len(x), 3), [0.002, 0.0, 0.0]))
    found = settings_for(scene(pillar__side=side, **IN_SPACE), {"dem": aside})
    assert found.scale == scale and found.scale * found.stretch * 0.002 <= 0.4


def test_a_turn_is_drawn_so_that_a_block_is_still_a_block(scene, row):
    """Corners stay within 0.35 of half a side from where they would be."""
    turn = 1e-3  # rad

    def moved(points):
        centre = np.repeat(np.arange(10) + 0.5, 8)
        x, y = points[:, 0], points[:, 1] - centre
        return turn * np.stack([-y, x, 0 * x], axis=1)

    settings = settings_for(scene(**IN_SPACE), {"dem": row(10, displacement=moved)})
    assert settings.scale * turn * np.sqrt(0.5) <= 0.175 < 3 * settings.scale * turn * np.sqrt(0.5)


def test_the_engine_that_moves_more_decides(scene, row):
    small, large = (row(10, displacement=_step(size)) for size in (1e-4, 1e-3))
    assert settings_for(scene(), {"dem": small, "continuum-jointed": large}).scale == 200


def test_a_wish_is_granted_and_rest_is_not_exaggerated(scene, row):
    assert settings_for(scene(), {"dem": row(10)}).scale == 1
    assert settings_for(scene(), {"dem": row(10)}, 7.5).scale == 7.5


@pytest.mark.parametrize(
    ("moved", "up"),
    [
        ([0.0, 1.0, 0.0], [1, 0, 0]),
        ([-1.0, 0.0, 0.0], [1, 0, 0]),
        ([0.0, 0.0, 1.0], [0, 0, 1]),
        ([-0.36, 0.8, -0.48], [0.6, 0, 0.8]),
    ],
)
def test_most_motion_across_the_axis_is_in_the_plane_of_the_picture(scene, row, moved, up):
    moving = row(10, displacement=lambda x: np.tile(moved, (len(x), 1)))
    assert settings_for(scene(), {"dem": moving}).up == pytest.approx(np.array(up))


def test_a_twisted_pillar_is_seen_with_x_upwards(scene, row):
    """No direction across the axis has more motion than another."""
    twisted = row(10, displacement=lambda x: 1e-3 * np.stack([-x[:, 2], 0 * x[:, 0], x[:, 0]], 1))
    assert settings_for(scene(), {"dem": twisted}).up.tolist() == [1, 0, 0]


@pytest.mark.parametrize(("side", "stretch"), [(1.0, 1), (0.45, 1), (0.25, 1.8), (0.1, 4.5)])
def test_thin_pillars_are_drawn_thicker(scene, row, side, stretch):
    thin = scene(pillar__side=side)
    assert settings_for(thin, {"dem": row(10)}).stretch == pytest.approx(stretch)


@pytest.mark.parametrize(
    ("name", "quantity"), [("beyond/shear-pulse", VELOCITY), ("guo-li-2002/fig-03", STRESS)]
)
def test_waves_of_shear_are_shown_by_their_velocity(name, quantity):
    """No axial stress is in them."""
    short = {"time.duration": 0.02, "pillar.length": 10.0, "record": {"stress": [5.0]}}
    scene = cases.load_variant(find(name), "", short)
    assert settings_for(scene, take(scene, 0.005).found).quantity == quantity
