"""Partitions whose blocks and contacts are counted and measured by hand."""

import numpy as np
import pytest

from jointwave.cases.partition.scene import blocks_of_domain as cut
from jointwave.cases.schema.domain import Domain

#: The first joints of a set with spacing 1, scatter 0.25 and seed 7: the same everywhere.
PINNED = [1.1083358519779094, 2.4523330943513377, 3.691083905563523]
SIDES = {"left": 0, "right": 1, "bottom": 2, "top": 3}
OPENING = 5  # the first opening, after the four sides and the rest of the outline


def test_two_orthogonal_sets_make_a_lattice(rectangle, joints):
    """10 x 6 squares of 1 m: 5 x 10 contacts across rows, 9 x 6 across columns, moments a^4/12."""
    sets = [joints("flat", 0.0, spacing=1.0), joints("steep", 90.0, spacing=1.0)]
    found = cut(rectangle(10.0, 6.0), sets)
    assert found.count == 60
    assert np.bincount(found.contacts.joint_set).tolist() == [50, 54]
    np.testing.assert_array_equal(found.contacts.area, 1.0)
    np.testing.assert_array_equal(found.volume, 1.0)
    np.testing.assert_allclose(found.second_moment, [np.eye(2) / 12] * 60, atol=1e-15)
    centres = {tuple(c) for c in np.round(found.centroid, 12)}
    assert centres == {(x + 0.5, y + 0.5) for x in range(10) for y in range(6)}
    sides = np.bincount(found.boundary.side, minlength=5)
    assert sides.tolist() == [6, 6, 10, 10, 0]


def test_brickwork(rectangle, joints):
    """Rows of 5 bricks of 2 m and of 4 with two halves: each whole brick has six neighbours."""
    rows = joints("rows", 0.0, spacing=1.0)
    cross = joints("cross", 90.0, spacing=2.0, ends_at=["rows"], offset=0.5)
    found = cut(rectangle(10.0, 6.0), [cross, rows])
    assert found.count == 3 * 5 + 3 * 6
    areas, count = np.unique(np.round(found.volume, 12), return_counts=True)
    assert areas.tolist() == [1.0, 2.0] and count.tolist() == [6, 27]
    beds = found.contacts.joint_set == 1
    assert beds.sum() == 5 * 10 and (found.contacts.area == 1.0).all()
    assert (~beds).sum() == 3 * 4 + 3 * 5
    degree = np.bincount(found.contacts.blocks.ravel())
    inner = (np.abs(found.centroid[:, 0] - 5) < 3) & (np.abs(found.centroid[:, 1] - 3) < 2)
    assert (degree[inner] == 6).all()


def test_cross_joints_without_offset_go_through(rectangle, joints):
    rows, keys = joints("rows", 0.0, spacing=1.0), {"spacing": 2.0}
    ends = cut(rectangle(10.0, 6.0), [rows, joints("cross", 90.0, ends_at=["rows"], **keys)])
    through = cut(rectangle(10.0, 6.0), [rows, joints("cross", 90.0, **keys)])
    np.testing.assert_array_equal(ends.outlines.corners, through.outlines.corners)
    np.testing.assert_array_equal(ends.contacts.blocks, through.contacts.blocks)


def test_offset_runs_on_from_joint_to_joint(rectangle, joints):
    """A third of the spacing more in each row: cross joints at 0, 1, 2, 0, ... m of 3."""
    sets = [
        joints("rows", 0.0, spacing=1.0),
        joints("cross", 90.0, spacing=3.0, ends_at=["rows"], offset=1 / 3),
    ]
    found = cut(rectangle(9.0, 4.0), sets)
    cross = found.contacts.joint_set == 1
    x, y = found.contacts.ends[cross, 0, 0], np.floor(found.contacts.ends[cross, :, 1].min(axis=1))
    places = {row: sorted(set(np.round(x[y == row], 9))) for row in range(4)}
    assert places == {0: [3, 6], 1: [1, 4, 7], 2: [2, 5, 8], 3: [3, 6]}


def test_one_joint_that_ends_at_others(rectangle, joints):
    """It cuts the one block that holds its point, and its ends are points of others' edges."""
    grid = [joints("rows", 0.0, spacing=1.0), joints("columns", 90.0, spacing=1.0)]
    one = joints("one", 45.0, through=[2.5, 1.5], ends_at=["rows", "columns"])
    found = cut(rectangle(5.0, 3.0), [*grid, one])
    assert found.count == 16
    own = np.flatnonzero(found.contacts.joint_set == 2)
    assert len(own) == 1 and found.contacts.area[own[0]] == pytest.approx(2**0.5)


def test_three_sets_through_common_points(rectangle, joints):
    """Equilateral triangles of side 1: sixty degrees, all three sets through every corner."""
    height = 3**0.5 / 2
    sets = [joints(name, dip, spacing=height) for name, dip in (("a", 0.0), ("b", 60.0))]
    found = cut(rectangle(10.0, 8 * height), [*sets, joints("c", -60.0, spacing=height)])
    whole = np.isclose(found.volume, 3**0.5 / 4, rtol=1e-9)
    assert set(np.diff(found.outlines.first)[whole]) == {3}
    assert whole.sum() == 8 * 19 and found.count == whole.sum() + 8 * 2


def test_a_tunnel_is_cut_out_and_its_blocks_are_cut_along_its_faces(rectangle, joints):
    """A square tunnel in one block of rock: four convex parts, and no area but that lost."""
    tunnel = [[4.0, 4.0], [6.0, 4.0], [6.0, 6.0], [4.0, 6.0]]
    domain = rectangle(10.0, 10.0, openings=[tunnel], non_convex="cut")
    found = cut(domain, [joints("far", 90.0, through=[9.0, 5.0])])
    assert found.volume.sum() == pytest.approx(96.0, rel=1e-14)
    assert found.count == 5 and (found.contacts.joint_set == -1).sum() == 4
    faces = found.boundary.side == OPENING
    assert found.boundary.area[faces].sum() == pytest.approx(8.0, rel=1e-14)
    assert np.abs(found.boundary.normal[faces].sum(axis=0)).max() < 1e-14


def test_a_tunnel_between_joints_needs_no_cut(rectangle, joints):
    """Its faces lie on joints: blocks are taken out whole, and none is refused."""
    tunnel = [[4.0, 4.0], [6.0, 4.0], [6.0, 6.0], [4.0, 6.0]]
    sets = [joints("rows", 0.0, spacing=1.0), joints("columns", 90.0, spacing=1.0)]
    found = cut(rectangle(10.0, 10.0, openings=[tunnel]), sets)
    assert found.count == 96 and (found.contacts.joint_set >= 0).all()
    faces = found.boundary.side == OPENING
    assert faces.sum() == 8 and set(found.boundary.joint_set[faces]) == {0, 1}


def test_joints_along_the_boundary_are_known(rectangle, joints):
    """Rows of 1 m meet the bottom and the top of 6 m; columns of 4 m only the left of 10 m."""
    sets = [joints("rows", 0.0, spacing=1.0), joints("columns", 90.0, spacing=4.0)]
    edges = cut(rectangle(10.0, 6.0), sets).boundary
    known = {name: set(edges.joint_set[edges.side == k]) for name, k in SIDES.items()}
    assert known == {"left": {1}, "right": {-1}, "bottom": {0}, "top": {0}}


def test_a_slope_is_an_outline_that_is_not_convex(joints):
    """Area by hand: 20 x 4, and a trapezium of 12 and 6 m at 6 m height."""
    corners = [[0.0, 0.0], [20.0, 0.0], [20.0, 10.0], [14.0, 10.0], [8.0, 4.0], [0.0, 4.0]]
    sets = [joints("a", 35.0, spacing=1.0), joints("b", -50.0, spacing=1.0)]
    found = cut(Domain(outline=corners, non_convex="cut"), sets)
    assert found.volume.sum() == pytest.approx(80 + 9 * 6, rel=1e-13)
    length = np.bincount(found.boundary.side, weights=found.boundary.area)
    np.testing.assert_allclose(length, [4, 10, 20, 6, 8 + 6 * 2**0.5], rtol=1e-13)


def test_an_opening_may_open_the_boundary(rectangle, joints):
    """A bench at the upper right corner: its two faces, and the rest of right and top."""
    bench = [[6.0, 3.0], [10.0, 3.0], [10.0, 6.0], [6.0, 6.0]]
    sets = [joints("rows", 0.0, spacing=1.0), joints("columns", 90.0, spacing=1.0)]
    found = cut(rectangle(10.0, 6.0, openings=[bench]), sets)
    assert found.count == 60 - 12
    length = np.bincount(found.boundary.side, weights=found.boundary.area)
    np.testing.assert_allclose(length, [6, 3, 10, 6, 0, 7], rtol=1e-14)


@pytest.mark.parametrize("x, y", [(40.0, 10.0), (10.0, 40.0)])
def test_neighbours_are_near_each_other_in_memory(rectangle, joints, x, y):
    """Along rows across the longer extent: a lattice has the least bandwidth, the shorter one."""
    sets = [joints("rows", 0.0, spacing=1.0), joints("columns", 90.0, spacing=1.0)]
    contacts = cut(rectangle(x, y), sets).contacts
    assert (contacts.blocks[:, 1] - contacts.blocks[:, 0]).max() == 10


def test_scattered_spacings_are_the_stream_of_their_seed(rectangle, joints):
    """Uniform about the mean with the deviation that was asked for, from PCG64 whose streams are
    those of every platform; the joints that are there do not depend on the domain's size."""
    rows = joints("rows", 0.0, spacing=1.0, scatter=0.25, seed=7)
    draws = np.random.Generator(np.random.PCG64([7, 0, 0])).random(1000)
    expected = np.cumsum(1 + 3**0.5 * 0.25 * (2 * draws - 1))
    tall, short = (cut(rectangle(2.0, height), [rows]) for height in (900.0, 5.0))
    places = np.sort(tall.contacts.ends[:, 0, 1])
    np.testing.assert_allclose(places, expected[: len(places)], rtol=1e-13)
    np.testing.assert_allclose(np.sort(short.contacts.ends[:, 0, 1]), places[:4], rtol=1e-13)
    assert np.diff(places).std() == pytest.approx(0.25, rel=0.05)
    assert places[:3].tolist() == pytest.approx(PINNED, rel=1e-15)
