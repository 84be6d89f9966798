"""The drawing agrees with the computation: positions of blocks, colours, and times."""

import numpy as np
import pytest

from cases.material.calibrate import calibrate
from compare.figures.animation.snapshots import take
from compare.figures.animation.surface import Wave, seen
from compare.figures.animation.view_settings import STRESS, VELOCITY, ViewSettings, settings_for

X = np.array([1.0, 0.0, 0.0])
EPS = np.finfo(float).eps


def test_polygons_of_a_run_are_displaced_by_the_scale_times_what_was_computed(simulated):
    """Of every block, by both engines, at round-off of the places drawn."""
    taken = simulated()
    settings = ViewSettings(X, 1234.5, 1.0, STRESS)
    for name, s in taken.found.items():
        wave = Wave(s, settings, taken.scene.pillar.side)
        i = len(s.time) // 2
        polygons, faces, edges = wave.drawn(i)
        assert np.abs(s.displacement[i]).max() * settings.scale > 0.1  # m: it is seen
        low, high = (np.array([f(s.points[c, 1]) for c in s.cells]) for f in (np.min, np.max))
        u = np.array([s.displacement[i, c, 1] for c in s.cells])
        at_low, at_high = (
            np.array([u[k][s.points[s.cells[k], 1] == y[k]][0] for k in range(len(u))])
            for y in (low, high)
        )
        cells = wave.surface.cells[faces]
        assert len(np.unique(cells)) == len(s.cells), name
        bound = 8 * EPS * np.abs(polygons).max()
        for polygon, cell in zip(polygons, cells, strict=True):
            y = np.unique(polygon[:, 0])
            assert abs(y.min() - (low[cell] + settings.scale * at_low[cell])) <= bound
            assert abs(y.max() - (high[cell] + settings.scale * at_high[cell])) <= bound
        assert np.abs(edges[..., 1]).max() == taken.scene.pillar.side / 2


def test_a_turned_block_is_drawn_turned(row):
    """Every corner of every polygon is one node, where it is; a block that has turned by 0.1 rad
    about z lies with its sides at that angle."""
    turn = 0.1

    def moved(points):
        x, y = points[:, 0], points[:, 1] - np.repeat([0.5, 1.5], 8)
        return turn * np.stack([-y, x, 0 * x], axis=1)

    s = row(2, displacement=moved)
    wave = Wave(s, ViewSettings(X, 2.0, 1.0, VELOCITY), 1.0)
    expected = seen(s.points + 2.0 * s.displacement[1], X)[..., :2]
    polygons, faces, _ = wave.drawn(1)
    np.testing.assert_array_equal(polygons, expected[wave.surface.faces[faces]])
    front = polygons[np.argmax(_area(polygons))]
    sides = np.roll(front, -1, axis=0) - front
    angles = np.arctan2(sides[:, 1], sides[:, 0]) % (np.pi / 2)
    assert np.minimum(angles, np.pi / 2 - angles) == pytest.approx(np.arctan(2 * turn))


def _area(polygons):
    x, y = polygons[..., 0], polygons[..., 1]
    return np.abs((x * np.roll(y, -1, 1) - y * np.roll(x, -1, 1)).sum(axis=1)) / 2


def test_colours_are_the_stress_of_the_cell_behind(row):
    s = row(3, stress=[[0, 0, 0], [1e6, -2e6, 3e6]])
    wave = Wave(s, ViewSettings(X, 1.0, 1.0, STRESS), 1.0)
    _, faces, _ = wave.drawn(1)
    assert sorted(wave.values[1, faces]) == [-2e6, 1e6, 3e6]
    assert wave.y.tolist() == [0.5, 1.5, 2.5] and wave.profile[1].tolist() == [1e6, -2e6, 3e6]


def test_colours_of_a_shear_wave_are_the_velocity_upwards(row):
    """Of the seen side: a twist about y moves the front up and the back down."""

    def twisted(points):
        x, z = points[:, 0], points[:, 2]
        return np.stack([-1e-3 * z, 0 * x, 1e-3 * x], axis=1)

    wave = Wave(row(1, displacement=twisted), ViewSettings(X, 1.0, 1.0, VELOCITY), 1.0)
    assert wave.profile[1] == pytest.approx(0.5)  # 1e-3 rad x 0.5 m, in a thousandth of a second


@pytest.mark.parametrize("engine", ["dem", "continuum-equivalent"])
def test_the_front_reaches_the_far_end_when_it_should(pillar, engine):
    """A step into the undamped pillar: half of it is at the end after L/c, in the frames between
    which that falls; a whole block before it is not."""
    changes = {
        "pillar__length": 20.0,
        "load": {"shape": "step", "amplitude": 1e6},
        "ends": {"start": "matched", "end": "matched"},
        "time__duration": 0.02,
        "record": {"stress": [10.0]},
        "rock__intact_modulus": None,
    }
    scene = pillar(**changes)
    simulated = take(scene, 201)
    settings = settings_for(scene, simulated.found)
    wave = Wave(simulated.found[engine], settings, scene.pillar.side)
    p, time = calibrate(scene), simulated.found[engine].time
    for section in (-1, len(wave.y) // 2):
        arrived = time[np.argmax(wave.profile[:, section] > 0.25e6)]
        exact = wave.y[section] / p.bar_speed
        frame, block = time[1], p.spacing / p.bar_speed
        assert exact - frame - block < arrived < exact + frame + block
