"""Bodies: the outside of blocks, where they move to, in colours of their cells, near before far."""

import numpy as np
import pytest
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from jointwave.compare.figures.animation import bodies
from jointwave.compare.figures.animation.bodies import Body, body_of
from jointwave.compare.figures.animation.snapshots import PRINCIPAL, STRESS, VELOCITY, ViewSettings
from jointwave.compare.figures.export import blank
from jointwave.compare.figures.style import RC

X, Y, Z = np.eye(3)
PLATE = np.array([[0.0, 0, 0], [2, 0, 0], [4, 0, 0], [4, 0, 1], [2, 0, 1], [0, 0, 1]])
COLOURS = ScalarMappable(Normalize(-1.0, 1.0), "RdBu_r")


def body_at(s, up=X, scale=1.0, stretch=1.0, quantity=STRESS):
    """Return the body of snapshots of a pillar of unit side."""
    return body_of(s, ViewSettings(np.array(up), scale, stretch, quantity, Y, 1.0))


@pytest.mark.parametrize("kind", ["line", "quad", "hexahedron"])
def test_every_kind_of_cells_is_a_row_of_boxes(row, kind):
    """Six faces a block, from side to side of the section, y to the right."""
    body = body_at(row(kind=kind))
    assert body.faces.shape == (18, 4) and body.values.shape == (2, 18)
    np.testing.assert_allclose(body.rest.min(axis=0), [0, -0.5, -0.5])
    np.testing.assert_allclose(body.rest.max(axis=0), [3, 0.5, 0.5])
    first, second, _, last = body.rest[body.faces].swapaxes(0, 1)
    area = np.linalg.norm(np.cross(second - first, last - first), axis=1)
    np.testing.assert_allclose(area, 1.0)


def test_cells_of_one_block_have_no_face_between_them(row):
    """Two boxes that share four nodes: ten faces."""
    two = row(count=2)
    same = (two.points[:, None] == two.points).all(axis=2).argmax(axis=1)
    assert len(body_at(two._replace(cells=same[two.cells])).faces) == 10


@pytest.mark.parametrize("up", [X, Z, (X + Z) / np.sqrt(2)])
def test_the_axes_of_the_picture_keep_lengths_and_right_hands(row, up):
    """Displacement is exaggerated, thickness stretched; away is up x y."""
    moved = np.array([0.1, 0.2, 0.3])
    body = body_at(row(displacement=lambda x: np.tile(moved, (len(x), 1))), up, 10.0, 2.0)
    away = np.cross(up, [0.0, 1.0, 0.0])
    expected = 10 * np.array([moved[1], 2 * moved @ away, 2 * moved @ up])
    np.testing.assert_allclose(body.motion[1], np.tile(expected, (24, 1)))


def test_colours_are_the_stress_of_the_cell_behind(row):
    profile = body_at(row(3, stress=[[0, 0, 0], [1e6, -2e6, 3e6]])).profile()
    assert profile.columns.tolist() == [0.5, 1.5, 2.5]
    assert profile.loc[1].tolist() == [1, -2, 3]  # MPa


def test_colours_of_a_shear_wave_are_the_velocity_upwards(row):
    """Of the seen side: a twist about y moves the front up and the back down."""

    def twisted(points):
        x, z = points[:, 0], points[:, 2]
        return np.stack([-1e-3 * z, 0 * x, 1e-3 * x], axis=1)

    profile = body_at(row(1, displacement=twisted), quantity=VELOCITY).profile()
    assert profile.loc[1].tolist() == pytest.approx([0.5])  # 1e-3 rad x 0.5 m, in a millisecond


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


def picture(body, per_away):
    """Return the picture of a body at its first instant."""
    with blank(2.0, RC | {"figure.figsize": (10.0, 2.0)}) as figure:
        figure.set_layout_engine("none")
        ax = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        ax.set_axis_off()
        bodies.BodyView(ax, body, COLOURS, per_away).show(0)
        figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[..., :3].astype(int)


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
@pytest.mark.parametrize("per_away", [bodies.FRONT, bodies.OBLIQUE])
def test_what_is_near_hides_what_is_far(per_away, order):
    """Two plates of which the first is nearer to the viewer by 0.1 m, in any order."""
    rest = np.concatenate([PLATE, PLATE + np.array([0.0, 0.1, 0.0])])
    faces, values = np.array([[0, 2, 3, 5], [6, 8, 9, 11]]), np.array([[1.0, -1.0]])
    still = np.zeros((1, 12, 3))
    shown = picture(Body(rest, still, faces[order], values[:, order], np.array(order)), per_away)
    middle = shown[shown.shape[0] // 2, shown.shape[1] // 2]
    assert middle[0] > middle[2] + 50


@pytest.mark.parametrize("order", [[0, 1], [1, 0]])
def test_a_small_block_stands_in_front_of_the_large_one_under_it(order):
    """On the far left corner of a slab of 10 m x 10 m x 1 m a cube of 2 m shows its front, right
    side and top, 4 + 1.6 + 1.2 m2 as drawn, and hides its base's 1.2 of the slab's 10 + 4 + 30."""
    corner = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    unit = np.concatenate([corner, corner + Z])
    rest = np.concatenate([unit * [10, 10, 1], unit * 2 + [0, 8, 1]])
    rings = np.array(bodies.FACES["hexahedron"])
    values = np.repeat([-1.0, 1.0], 6)[None]  # blue and red
    still, faces = np.zeros((1, 16, 3)), np.concatenate([rings, rings + 8])
    body = Body(rest, still, faces, values, np.repeat(order, 6))
    red, _, blue = np.moveaxis(picture(body, bodies.ABOVE), -1, 0)
    share = (red > blue + 50).sum() / (blue > red + 50).sum()
    assert share == pytest.approx(6.8 / 42.8, rel=0.05)  # edges are drawn, too
