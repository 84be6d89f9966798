"""Domains cut into regions of rock: the region of each block, and joints along the boundaries."""

import numpy as np
import pytest

from jointwave.cases.geometry.cell_complex import NO_SET, GeometryError, Sliver
from jointwave.cases.partition.joints import ROCK, region_at
from jointwave.cases.partition.scene import blocks_of_domain as cut
from jointwave.cases.schema.rock_mass import Region


def region(name, y, dip=0.0, x=0.0):
    return Region(name=name, dip=dip, through=[x, y])


def of_region(found, k):
    """Return the area of a region's blocks."""
    return found.volume[found.body.region == k].sum()


def between(found):
    """Return which contacts lie between two regions."""
    one, other = found.body.region[found.contacts.blocks].T
    return one != other


@pytest.mark.parametrize("dip", [0.0, 17.0, -30.0])
def test_layers_share_the_domain_by_their_areas(rectangle, joints, dip):
    """8 m by 10 m with lines through (4, 3) and (4, 6): by symmetry their areas do not depend on
    the dip. What a joint crosses a boundary in is a corner of blocks of either side."""
    layers = [region("one", 3.0, dip, 4.0), region("two", 6.0, dip, 4.0)]
    found = cut(rectangle(8.0, 10.0), [joints("cross", 75.0, spacing=1.5)], (), layers)
    assert [of_region(found, k) for k in (ROCK, 0, 1)] == pytest.approx([24, 24, 32], rel=1e-12)
    welded = between(found)
    assert (found.contacts.joint_set[welded] == NO_SET).all()
    length = 2 * 8 / np.cos(np.radians(dip))
    assert found.contacts.area[welded].sum() == pytest.approx(length, rel=1e-12)
    assert (found.body.region == region_at(layers, found.centroid)).all()


def test_a_later_region_lies_over_one_that_dips(rectangle):
    """An unconformity: 45 degrees below y = 6, cut off there; nothing of it is cut above."""
    layers = [region("old", 0.0, 45.0), region("young", 6.0)]
    found = cut(rectangle(10.0, 10.0), [], (), layers)
    assert found.count == 3
    assert [of_region(found, k) for k in (ROCK, 0, 1)] == pytest.approx([42, 18, 40], rel=1e-12)


def test_sets_cut_the_regions_that_they_name_alone(rectangle, joints):
    """Beds 1 m apart in the lower 4 m of 10 m by 5 m, and a cross set in the rest."""
    beds = joints("bed", 0.0, spacing=1.0, regions=["rock"])
    cross = joints("cross", 90.0, spacing=2.5, regions=["upper"])
    found = cut(rectangle(10.0, 5.0), [beds, cross], (), [region("upper", 3.5)])
    of_set = [found.contacts.area[found.contacts.joint_set == k].sum() for k in (0, 1)]
    assert of_set == pytest.approx([30.0, 3 * 1.5], rel=1e-12)
    assert found.count == 4 + 4
    assert (found.body.region[found.contacts.blocks[found.contacts.joint_set == 0]] == ROCK).all()


def test_a_joint_along_a_boundary_is_what_that_is(rectangle, joints):
    """A single joint, or one of a set that cuts only one side."""
    layers, alone = [region("upper", 2.0)], joints("fault", 0.0, through=[3.0, 2.0])
    beds = joints("bed", 0.0, spacing=1.0, regions=["upper"])
    for one, count in ((alone, 2), (beds, 4)):
        found = cut(rectangle(6.0, 5.0), [one], (), layers)
        assert found.count == count
        assert (found.contacts.joint_set[between(found)] == 0).all()


def test_a_joint_beside_a_boundary_is_not_lost(rectangle, joints):
    """A bed of a millimetre above the boundary would take its joint into the region's next one; in
    the boundary the joint stays."""
    beds = [joints("bed", 0.0, spacing=2.0)]
    with pytest.raises(Sliver, match=r"0.001 m from a parallel joint or boundary .*\[2, 1.9995\]"):
        cut(rectangle(4.0, 6.0), beds, (), [region("upper", 1.999)])
    found = cut(rectangle(4.0, 6.0), beds, (), [region("upper", 2.0)])
    assert of_region(found, 0) == pytest.approx(4 * 4, rel=1e-12)
    assert (found.contacts.joint_set == 0).all() and found.count == 3


LENS = [[2.0, 3.0], [5.0, 2.0], [8.0, 3.5], [6.0, 5.5], [3.0, 5.0]]
DENT = [[2.0, 2.0], [5.0, 4.0], [8.0, 2.0], [6.0, 7.0], [3.0, 7.0]]  # not convex at its second


@pytest.mark.parametrize("corners", [LENS, DENT])
def test_an_outline_holds_its_own_area(rectangle, joints, corners):
    """Among crossing joints and over a stratum: each block is of one rock, and the boundary is as
    long as the outline."""
    x, y = np.array(corners).T
    area = abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2
    around = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T).sum()
    sets = [joints("bed", 10.0, spacing=1.7), joints("cross", -70.0, spacing=2.3)]
    both = [region("upper", 8.0), Region(name="lens", outline=corners)]
    domain = rectangle(10.0, 10.0, non_convex="cut", least_width=1e-3)
    found = cut(domain, sets, (), both)
    areas = [of_region(found, k) for k in (ROCK, 0, 1)]
    assert areas == pytest.approx([80 - area, 20, area], rel=1e-12)
    assert (found.body.region == region_at(both, found.centroid)).all()
    welded = between(found) & (found.body.region[found.contacts.blocks] == 1).any(axis=1)
    assert found.contacts.area[welded].sum() == pytest.approx(around, rel=1e-12)
    plain = cut(domain, sets)
    of_sets = [c.contacts.area[c.contacts.joint_set >= 0].sum() for c in (plain, found)]
    assert of_sets[0] == pytest.approx(of_sets[1], rel=1e-12)


def test_rock_around_an_outline_is_refused_or_cut_as_around_an_opening(rectangle):
    """Rock around a lens is no convex block; cut along its five faces it makes five."""
    lens = [Region(name="lens", outline=LENS)]
    with pytest.raises(GeometryError, match="not convex at an opening, a region or a corner"):
        cut(rectangle(10.0, 10.0), [], (), lens)
    found = cut(rectangle(10.0, 10.0, non_convex="cut"), [], (), lens)
    assert sorted(found.body.region) == [ROCK] * 5 + [0]
