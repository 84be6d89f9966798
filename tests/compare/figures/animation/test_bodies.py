"""Bodies: the outside of blocks, moved as computed, in the colours of their cells."""

import numpy as np
import pytest

from jointwave.compare.figures.animation.bodies import body_of
from jointwave.compare.figures.animation.settings import (
    PRINCIPAL,
    SPEED,
    STRESS,
    VELOCITY,
    ViewSettings,
)

X, Y, Z = np.eye(3)


@pytest.fixture
def body_at():
    """Return a function that gives the body of snapshots of a pillar of unit side."""

    def made(s, up=X, scale=1.0, stretch=1.0, quantity=STRESS):
        return body_of(s, ViewSettings(np.array(up), scale, stretch, quantity, Y, 1.0))

    return made


@pytest.mark.parametrize("kind", ["line", "quad", "hexahedron"])
def test_every_kind_of_cells_is_a_row_of_boxes(row, body_at, kind):
    """Six faces a block, from side to side of the section, y to the right."""
    body = body_at(row(kind=kind))
    assert body.faces.shape == (18, 4) and body.values.shape == (2, 18)
    np.testing.assert_allclose(body.rest.min(axis=0), [0, -0.5, -0.5])
    np.testing.assert_allclose(body.rest.max(axis=0), [3, 0.5, 0.5])
    corners = body.rest[body.faces]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0]), axis=1
    )
    np.testing.assert_allclose(area, 1.0)


def test_cells_of_one_block_have_no_face_between_them(row, body_at):
    """Two boxes that share four nodes: ten faces."""
    two = row(count=2)
    joined = np.arange(16)
    for node in range(8, 16):
        same = np.flatnonzero((two.points[:8] == two.points[node]).all(axis=1))
        if same.size:
            joined[node] = same[0]
    assert len(body_at(two._replace(cells=joined[two.cells])).faces) == 10


@pytest.mark.parametrize("up", [X, Z, (X + Z) / np.sqrt(2)])
def test_the_axes_of_the_picture_keep_lengths_and_right_hands(row, body_at, up):
    """Displacement is exaggerated, thickness stretched; away is up x y."""
    moved = np.array([0.1, 0.2, 0.3])
    body = body_at(row(displacement=lambda x: np.tile(moved, (len(x), 1))), up, 10.0, 2.0)
    away = np.cross(up, [0.0, 1.0, 0.0])
    expected = 10 * np.array([moved[1], 2 * moved @ away, 2 * moved @ up])
    np.testing.assert_allclose(body.motion[1], np.tile(expected, (24, 1)))


def test_colours_are_the_stress_of_the_cell_behind(row, body_at):
    body = body_at(row(3, stress=[[0, 0, 0], [1e6, -2e6, 3e6]]))
    profile = body.profile()
    assert profile.columns.tolist() == [0.5, 1.5, 2.5] and profile.loc[1].tolist() == [
        1,
        -2,
        3,
    ]  # MPa


def test_colours_of_a_shear_wave_are_the_velocity_upwards(row, body_at):
    """Of the seen side: a twist about y moves the front up and the back down."""

    def twisted(points):
        x, z = points[:, 0], points[:, 2]
        return np.stack([-1e-3 * z, 0 * x, 1e-3 * x], axis=1)

    profile = body_at(row(1, displacement=twisted), quantity=VELOCITY).profile()
    assert profile.loc[1].tolist() == pytest.approx([0.5])  # 1e-3 rad x 0.5 m, in a millisecond


def test_speed_is_that_of_the_corners(row, body_at):
    body = body_at(row(displacement=lambda x: 0 * x + [0.0, 3e-3, 4e-3]), quantity=SPEED)
    np.testing.assert_allclose(body.values, np.outer([0.0, 5.0], np.ones(18)))


def test_the_principal_stress_of_larger_size_in_the_plane_and_in_space(row):
    """Of 3, -5 (and 1) MPa in random axes, and of a state in one plane by either rule."""
    turn = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
    stress = turn @ np.diag([3e6, -5e6, 1e6]) @ turn.T
    of_space = [stress[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2))]
    flat = [2e6, 1e6, 0.0, 3e6, 0.0, 0.0]
    settings = ViewSettings(Z, 1.0, 1.0, PRINCIPAL)
    space = body_of(row(1, "quad", stress=[[of_space], [flat]]), settings)
    plane = body_of(row(1, "quad", stress=[[[0] * 3], [[2e6, 1e6, 3e6]]]), settings)
    np.testing.assert_allclose(space.values[:, 0], [-5.0, plane.values[1, 0]], rtol=1e-12)
