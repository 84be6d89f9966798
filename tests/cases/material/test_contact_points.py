"""The contact points of faces: what their rules integrate, and the moments of any convex face."""

import numpy as np
import pytest

from closed_forms.square_face import face_points
from jointwave.cases.material.contact_points import bending, lever, points_of, vertex_points


@pytest.mark.parametrize("count", range(1, 9))
def test_rules_integrate_what_they_should(count):
    """Gauss: polynomials up to degree 2 n - 1; midpoint: 1 - 1/n^2 of the bending stiffness."""
    x, w = points_of("gauss", count)
    for degree in range(2 * count):
        assert w @ x**degree == pytest.approx(1 / (degree + 1), rel=1e-13)
    x, w = points_of("midpoint", count)
    assert x == pytest.approx((np.arange(count) + 0.5) / count, rel=1e-14)
    assert w == pytest.approx(np.full(count, 1 / count), rel=1e-14)
    assert bending("midpoint", count) == pytest.approx(1 - 1 / count**2, rel=1e-14)
    assert 12 * w @ (x - 0.5) ** 2 == pytest.approx(1 - 1 / count**2, abs=1e-14)


def test_the_paper_s_points_are_the_centres_of_quarters(pillar):
    """(2) of Guo & Li (2002), in its scenes; a scene's own default are the vertices."""
    paper = pillar().joints
    assert (paper.contact_points, paper.point_rule) == (None, "midpoint")
    x, z, area = face_points(3.0, None, "midpoint")
    assert sorted(zip(x, z, strict=True)) == [(i, j) for i in (-0.75, 0.75) for j in (-0.75, 0.75)]
    assert (area == 2.25).all()
    assert pillar(joints={}).joints.point_rule == "vertices"


def polygon(rng, corners):
    """Return the corners of a convex polygon, from its centroid, its area and second moments over
    the area, by triangles between the first corner and each edge."""
    angles = np.sort(rng.uniform(0, 2 * np.pi, corners))
    x = np.stack([np.cos(angles), np.sin(angles)], axis=1) @ rng.normal(size=(2, 2))
    fans = np.array([[x[0], x[k], x[k + 1]] for k in range(1, corners - 1)])
    areas = np.abs(np.linalg.det(fans[:, 1:] - fans[:, :1])) / 2
    centre = (areas @ fans.mean(axis=1)) / areas.sum()
    x, fans = x - centre, fans - centre
    total = fans.sum(axis=1)
    second = np.einsum("fki,fkj->fij", fans, fans) + total[:, :, None] * total[:, None]
    return x, np.tensordot(areas, second, 1) / 12 / areas.sum()


@pytest.mark.parametrize("corners", [3, 4, 5, 6, 8, 12])
def test_vertices_have_the_moments_of_any_convex_face(corners):
    """Corners and what lies within, with positive weights: area, centroid and second moments."""
    rng = np.random.default_rng(corners)
    for x, spread in (polygon(rng, corners) for _ in range(50)):
        filled = np.concatenate([x, x[[-1, -1]]])  # as beside faces of more corners
        for at in (x, filled):
            (places,), (shares,) = vertex_points(at[None], spread[None])
            size = np.sqrt(np.trace(spread))
            assert len(places) - len(at) == (1 if corners == 3 else 2)
            np.testing.assert_array_equal(places[: len(at)], at)
            assert (shares >= 0).all() and (shares[:corners] > 0).sum() >= corners - 1
            assert shares.sum() == pytest.approx(1, rel=1e-12)
            np.testing.assert_allclose(shares @ places / size, 0, atol=1e-9)
            second = places.T @ (shares[:, None] * places)
            np.testing.assert_allclose(second, spread, rtol=0, atol=1e-9 * size**2)
            edges = np.roll(x, -1, axis=0) - x
            for point in places[len(at) :]:
                away = point - x
                side = edges[:, 0] * away[:, 1] - edges[:, 1] * away[:, 0]
                assert (side > 0).all() or (side < 0).all()


def test_triangles_and_parallelograms_have_corners_and_centroid():
    """By twelfths: 3 x 1/12 and 3/4; 4 x 1/12 and 2/3; on an edge 1/6, 2/3, 1/6."""
    turn = np.array([[0.8, 0.3], [-0.2, 1.7]])
    three, four = [[-1, -1], [2, -1], [-1, 2]], [[-1, -1], [1, -1], [1, 1], [-1, 1]]
    faces = {3: (three, [[0.5, -0.25], [-0.25, 0.5]]), 4: (four, np.eye(2) / 3)}
    for corners, (x, spread) in faces.items():
        x, spread = x @ turn, turn.T @ spread @ turn
        places, shares = vertex_points(x[None], spread[None])
        np.testing.assert_allclose(shares[0], [1 / 12] * corners + [1 - corners / 12], rtol=1e-12)
        np.testing.assert_array_equal(places[0], [*x, [0, 0]])
    edge = vertex_points(np.array([[[-0.3], [0.3]]]), np.array([[[0.03]]]))
    np.testing.assert_allclose(edge[1][0], [1 / 6, 1 / 6, 2 / 3], rtol=1e-14)


def test_vertices_of_a_square_are_those_of_any_face():
    x, z, area = face_points(0.5, None, "vertices")
    corners, spread = np.stack([x, z], axis=1)[[0, 1, 3, 2]], np.eye(2) * 0.5**2 / 12
    (places,), (shares,) = vertex_points(corners[None], spread[None])
    found = zip(*places.T, 0.5**2 * shares, strict=True)
    np.testing.assert_allclose(sorted(zip(x, z, area, strict=True)), sorted(found), rtol=1e-14)
    assert bending("vertices") == pytest.approx(1, rel=1e-15) and lever("vertices") == 1
    assert lever("midpoint", 2) == 1 / 2
