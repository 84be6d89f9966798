"""Bodies as polygons: the outside of blocks, moved as computed, in the colours of their cells."""

import numpy as np
import pytest

from jointwave.compare.figures.animation.polygons import polygons_of
from jointwave.compare.figures.animation.settings import SPEED, STRESS, VELOCITY, ViewSettings

X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


@pytest.fixture
def polygons(pillar):
    """Return a function that gives the polygons of snapshots of a pillar of unit side."""
    unit = {"length": 3.0, "side": 1.0, "block": 1.0}
    scene = pillar(pillar=unit, record={"stress": [1.0]})

    def made(s, up=X, scale=1.0, stretch=1.0, quantity=STRESS):
        return polygons_of(s, scene, ViewSettings(np.array(up), scale, stretch, quantity))

    return made


@pytest.mark.parametrize("kind", ["line", "quad", "hexahedron"])
def test_every_kind_of_cells_is_a_row_of_boxes(row, polygons, kind):
    """Six faces a block, from side to side of the section, y to the right."""
    body = polygons(row(kind=kind))
    assert body.faces.shape == (18, 4) and body.values.shape == (2, 18)
    np.testing.assert_allclose(body.reach(), [[0, -0.5, -0.5], [3, 0.5, 0.5]])
    corners = body.at(0)
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0]), axis=1
    )
    np.testing.assert_allclose(area, 1.0)


def test_cells_of_one_block_have_no_face_between_them(row, polygons):
    """Two boxes that share four nodes: ten faces."""
    two = row(count=2)
    joined = np.arange(16)
    for node in range(8, 16):
        same = np.flatnonzero((two.points[:8] == two.points[node]).all(axis=1))
        if same.size:
            joined[node] = same[0]
    assert len(polygons(two._replace(cells=joined[two.cells])).faces) == 10


@pytest.mark.parametrize("up", [X, Z, (X + Z) / np.sqrt(2)])
def test_the_axes_of_the_picture_keep_lengths_and_right_hands(row, polygons, up):
    """Displacement is exaggerated, thickness stretched; away is up x y."""
    moved = np.array([0.1, 0.2, 0.3])
    body = polygons(row(displacement=lambda x: np.tile(moved, (len(x), 1))), up, 10.0, 2.0)
    away = np.cross(up, [0.0, 1.0, 0.0])
    expected = 10 * np.array([moved[1], 2 * moved @ away, 2 * moved @ up])
    np.testing.assert_allclose(body.motion[1], np.tile(expected, (24, 1)))


def test_a_turned_block_is_drawn_turned(row, polygons):
    """By 0.1 rad about z, twice exaggerated."""

    def turned(points):
        x, y = points[:, 0], points[:, 1] - np.repeat([0.5, 1.5], 8)
        return 0.1 * np.stack([-y, x, 0 * x], axis=1)

    front = polygons(row(2, displacement=turned), scale=2.0).front().at(1)[..., [0, 2]]
    sides = np.roll(front, -1, axis=1) - front
    angles = np.arctan2(sides[..., 1], sides[..., 0]) % (np.pi / 2)
    assert np.minimum(angles, np.pi / 2 - angles) == pytest.approx(np.full((2, 4), np.arctan(0.2)))


@pytest.mark.parametrize(("up", "faces"), [(X, 3), (Z, 3), ((X + Z) / np.sqrt(2), 6)])
def test_the_front_faces_the_viewer(row, polygons, up, faces):
    front = polygons(row(), up).front()
    assert len(front.faces) == faces
    assert (front.at(0)[..., 1].mean(axis=1) < -0.2).all()


def test_colours_are_the_stress_of_the_cell_behind(row, polygons):
    body = polygons(row(3, stress=[[0, 0, 0], [1e6, -2e6, 3e6]]))
    assert sorted(body.front().values[1]) == [-2, 1, 3]  # MPa
    profile = body.profile()
    assert profile.columns.tolist() == [0.5, 1.5, 2.5] and profile.loc[1].tolist() == [1, -2, 3]


def test_colours_of_a_shear_wave_are_the_velocity_upwards(row, polygons):
    """Of the seen side: a twist about y moves the front up and the back down."""

    def twisted(points):
        x, z = points[:, 0], points[:, 2]
        return np.stack([-1e-3 * z, 0 * x, 1e-3 * x], axis=1)

    profile = polygons(row(1, displacement=twisted), quantity=VELOCITY).profile()
    assert profile.loc[1].tolist() == pytest.approx([0.5])  # 1e-3 rad x 0.5 m, in a millisecond


def test_speed_is_that_of_the_corners(row, polygons):
    body = polygons(row(displacement=lambda x: 0 * x + [0.0, 3e-3, 4e-3]), quantity=SPEED)
    np.testing.assert_allclose(body.values, np.outer([0.0, 5.0], np.ones(18)))
