"""Partitions whose blocks and contacts are counted and measured by hand."""

import numpy as np
import pytest

from jointwave.cases.partition.scene import blocks_of_domain as cut
from jointwave.cases.schema.domain import Domain

#: The first joints of a set with spacing 1, scatter 0.25 and seed 7: the same everywhere.
PINNED = [1.1083358519779094, 2.4523330943513377, 3.691083905563523]
SIDES = {"left": 0, "right": 1, "bottom": 2, "top": 3}


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


def test_joints_along_the_boundary_are_known(rectangle, joints):
    """Rows of 1 m meet the bottom and the top of 6 m; columns of 4 m only the left of 10 m."""
    sets = [joints("rows", 0.0, spacing=1.0), joints("columns", 90.0, spacing=4.0)]
    edges = cut(rectangle(10.0, 6.0), sets).boundary
    known = {name: set(edges.joint_set[edges.side == k]) for name, k in SIDES.items()}
    assert known == {"left": {1}, "right": {-1}, "bottom": {0}, "top": {0}}


SQUARES = {"rows": {"dip": 0.0, "spacing": 1.0}, "columns": {"dip": 90.0, "spacing": 1.0}}
TUNNEL = [[4.0, 4.0], [6.0, 4.0], [6.0, 6.0], [4.0, 6.0]]
BENCH = [[6.0, 3.0], [10.0, 3.0], [10.0, 6.0], [6.0, 6.0]]
SLOPE = [[0.0, 0.0], [20.0, 0.0], [20.0, 10.0], [14.0, 10.0], [8.0, 4.0], [0.0, 4.0]]
HOLED = {"size": [10.0, 10.0], "openings": [TUNNEL]}
DIPPING = {"a": {"dip": 35.0, "spacing": 1.0}, "b": {"dip": -50.0, "spacing": 1.0}}
CUT, AROUND = {"non_convex": "cut"}, [10, 10, 10, 10, 0, 8]
ALONE = {"far": {"dip": 90.0, "through": [9.0, 5.0]}}
#: The domain, its joint sets, the number of blocks, and lengths of left, right, bottom, top, the
#: rest of the outline and openings.
SIDED = {
    "one block around a tunnel is cut along its faces": (HOLED | CUT, ALONE, 5, AROUND),
    "a tunnel between joints needs no cut": (HOLED, SQUARES, 96, AROUND),
    "an opening may open the boundary": (
        {"size": [10.0, 6.0], "openings": [BENCH]},
        *(SQUARES, 60 - 12, [6, 3, 10, 6, 0, 7]),
    ),
    "a slope is an outline that is not convex": (
        {"outline": SLOPE} | CUT,
        *(DIPPING, None, [4, 10, 20, 6, 8 + 6 * 2**0.5]),
    ),
}


@pytest.mark.parametrize(("domain", "sets", "count", "lengths"), SIDED.values(), ids=SIDED)
def test_outlines_and_openings_by_their_sides(joints, domain, sets, count, lengths):
    found = cut(Domain(**domain), [joints(name, **keys) for name, keys in sets.items()])
    assert count in (None, found.count)
    length = np.bincount(found.boundary.side, weights=found.boundary.area)
    np.testing.assert_allclose(length, lengths, rtol=1e-13)


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
