"""The contact points of a face: area, bending stiffness, symmetry."""

import numpy as np
import pytest

from jointwave.cases.material.contact_points import face_points

SIDE = 0.5
RULES = ["midpoint", "gauss"]


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("n", [1, 2, 3, 4, 7, 16])
def test_points_share_the_whole_face(rule, n):
    x, z, area = face_points(SIDE, n, rule)
    assert x.shape == z.shape == area.shape == (n * n,)
    assert (area > 0).all() and area.sum() == pytest.approx(SIDE**2, rel=1e-14)
    assert max(np.abs(x).max(), np.abs(z).max()) < SIDE / 2


@pytest.mark.parametrize("n", range(1, 9))
def test_midpoints_carry_their_share_of_the_bending_stiffness(n):
    x, z, area = face_points(SIDE, n, "midpoint")
    expected = pytest.approx((1 - 1 / n**2) * SIDE**4 / 12, rel=1e-14, abs=1e-18)
    assert (area * x**2).sum() == expected
    assert (area * z**2).sum() == expected


@pytest.mark.parametrize("n", range(2, 9))
def test_gauss_points_carry_all_of_the_bending_stiffness(n):
    x, z, area = face_points(SIDE, n, "gauss")
    assert (area * x**2).sum() == pytest.approx(SIDE**4 / 12, rel=1e-13)
    assert (area * z**2).sum() == pytest.approx(SIDE**4 / 12, rel=1e-13)


def test_points_of_the_paper_are_the_centres_of_quarters():
    x, z, area = face_points(SIDE, 2, "midpoint")
    assert sorted(zip(x, z, strict=True)) == [
        (i, j) for i in (-0.125, 0.125) for j in (-0.125, 0.125)
    ]
    assert (area == 0.0625).all()


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("n", [2, 3, 5, 16])
@pytest.mark.parametrize(
    "mirror", [lambda x, z: (z, x), lambda x, z: (-x, z), lambda x, z: (x, -z)]
)
def test_faces_are_symmetric_to_the_last_bit(rule, n, mirror):
    x, z, area = face_points(SIDE, n, rule)
    points = set(zip(x, z, area, strict=True))
    assert len(points) == n * n
    assert set(zip(*mirror(x, z), area, strict=True)) == points
