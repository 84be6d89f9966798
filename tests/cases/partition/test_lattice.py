"""Lattices that contain the joints of a scene: positions of their lines, and their errors."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.locate import contact_at
from jointwave.cases.material.rigid_blocks import rigid_joints
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.scene import OF_BLOCK, blocks_of_scene, partition_bytes
from tests.cases.partition.polygons import width

BOX = (6.0, 5.0, 4.0)


@pytest.fixture(scope="session")
def scene(rock_with):
    """A function of joint sets and more: a scene in blocks of about one size."""

    def make(*sets, block=1.0, poisson=0.0, size=(12.0, 10.0), width=None, layer=0, **boundaries):
        domain = {"size": list(size)} | ({"least_width": width} if width else {})
        tables = {"boundaries": boundaries, "numerics": {"dem": {"block": block}}}
        if layer:  # of this thickness within the rock
            origins = [[0.0] * (len(size) - 1) + [up] for up in (1.5, 1.5 + layer)]
            tables["regions"] = [{"name": f"{at[-1]}", "through": at} for at in origins]
        return rock_with(*sets, poisson=poisson, domain=domain, **tables)

    return make


def cut(own):
    return blocks_of_scene(own, further_sets(own))


def test_quiet_sides_are_met_in_the_middle_of_blocks(scene):
    """Half blocks at the left and the right, quarter ones at corners of two quiet sides; in space
    eighths where three of them meet."""
    sides = dict.fromkeys(("left", "right", "bottom"), "quiet")
    found = cut(scene(**sides))
    assert np.sort(found.volume)[:2] == pytest.approx([0.25 * 10 / 9.5] * 2, rel=1e-12)
    assert found.volume.sum() == pytest.approx(120, rel=1e-12)
    assert np.median(found.volume) == pytest.approx(10 / 9.5, rel=1e-12)
    found = cut(scene(size=BOX, **dict.fromkeys(("left", "front", "bottom"), "quiet")))
    assert found.volume.min() == pytest.approx(found.volume.max() / 8, rel=1e-9)
    assert found.volume.sum() == pytest.approx(120.0, rel=1e-12)


@pytest.mark.parametrize("dip", [0.0, 30.0, 45.0, -70.0])
def test_a_joint_alone_lies_on_a_line_of_squares_along_it(scene, dip):
    """All of it, and nothing besides: its contacts are as long as the joint in the domain."""
    own = scene({"dip": dip, "through": [6.0, 5.0]})
    alone, found = blocks_of_scene(own), cut(own)
    assert alone.count == 2
    mine = found.contacts.of_joints(1)
    assert found.contacts.area[mine].sum() == pytest.approx(alone.contacts.area[0], rel=1e-9)
    assert np.median(found.volume) == pytest.approx(1.0, rel=1e-9)
    assert (contact_at(found, np.array([[1.0, 1.0]]), 1) == np.flatnonzero(mine)).any()


@pytest.mark.parametrize("above", [0.8, 1.0, 1.3])
def test_a_joint_near_a_quiet_side_makes_no_blocks_twice_as_large(scene, above):
    """One block from the joint to a plane, half a block before the side, or that half alone."""
    own = scene({"dip": 0.0, "through": [6.0, above]}, bottom="quiet")
    spacing = further_sets(own)[0].spacing
    assert spacing == pytest.approx(above / 1.5)


def test_rock_with_a_poisson_effect_is_cut_in_triangles(scene):
    """Equilateral ones, of height h and area h^2 / sqrt(3), off the sides."""
    found = cut(scene({"dip": 30.0, "through": [6.0, 5.0]}, poisson=0.25))
    assert np.median(found.volume) == pytest.approx(1 / np.sqrt(3), rel=1e-9)
    assert np.median(np.diff(found.outlines.first)) == 3


def test_a_spacing_is_divided_by_a_whole_number(scene):
    """2 m in blocks of about 0.7 m: thirds; every third line is a joint."""
    own = scene({"dip": 0.0, "spacing": 2.0}, {"dip": 90.0, "spacing": 3.0}, block=0.7)
    spacings = [one.spacing for one in further_sets(own)]
    assert spacings == pytest.approx([2 / 3, 3 / 4])
    found = cut(own)
    assert found.count == 15 * 16
    of_set = found.contacts.joint_set
    assert [(of_set == k).sum() for k in range(4)] == [4 * 16, 3 * 15, 10 * 16, 12 * 15]


def test_further_cuts_where_joints_are_cut_nothing(scene):
    """A spacing of the blocks' own size needs no cuts, and a joint on a line of them cuts once."""
    own = scene({"dip": 0.0, "spacing": 1.0}, {"dip": 0.0, "through": [3.0, 5.0]}, block=1.0)
    assert [one.dip for one in further_sets(own)] == [-90.0]
    sets = [{"dip": 0.0, "through": [3.0, 5.0]}, {"dip": 90.0, "through": [6.0, 2.0]}]
    both = scene(*sets)
    assert cut(both).count == 120


def test_rock_no_wider_than_a_block_stays_whole(scene):
    """Without joints; on both sides of one; between those of a set; a column in its height only."""
    joint = {"dip": 20.0, "through": [6.0, 5.0]}
    for poisson in (0.0, 0.25):
        assert cut(scene(block=20.0, poisson=poisson)).count == 1
        assert cut(scene(joint, block=20.0, poisson=poisson)).count == 2
        assert cut(scene({"dip": 0.0, "spacing": 2.5}, block=20.0, poisson=poisson)).count == 4
        for size in ((2.5, 10.0), (10.0, 2.5)):
            assert cut(scene(block=2.5, poisson=poisson, size=size)).count == 4


def test_rows_of_blocks_share_their_stiffness_with_periodic_sides_across_them(scene):
    """Blocks touch their own images at a cut, as far apart as the sides are, unasked."""
    sides = {"left": "periodic", "right": "periodic"}
    (seam,) = further_sets(scene({"dip": 0.0, "spacing": 1.0}, block=None, **sides))
    assert (abs(seam.dip), seam.spacing) == (90.0, 12.0)


def test_periodic_sides_lie_on_lines(scene):
    sides = {"left": "periodic", "right": "periodic"}
    assert cut(scene({"dip": 0.0, "through": [6.0, 5.0]}, poisson=0.25, **sides)).count == 120


@pytest.mark.parametrize(
    "keys", [{"scatter": 0.2, "seed": 1}, {"ends_at": ["1"]}], ids=["scatter", "ends_at"]
)
def test_joints_without_a_lattice_and_too_many_blocks_are_refused(scene, keys):
    sets = {"dip": 0.0, "spacing": 2.0, **keys}, {"dip": 90.0, "spacing": 2.0}
    with pytest.raises(SceneError, match=r"numerics\.dem\.block = 1\.0: cannot cut") as caught:
        further_sets(scene(*sets))
    assert "\n" not in str(caught.value)
    with pytest.raises(SceneError, match=r"numerics\.dem\.block = 1e-05: gives about"):
        cut(scene(block=1e-5))


def test_blocks_are_counted_in_each_region(scene, monkeypatch):
    """Planes of one region cross none of another's; a refusal names the region that forces it."""
    monkeypatch.setenv("JOINTWAVE_MEMORY", "1")
    for layer in (0.3, 0.9):
        own = scene(poisson=0.25, layer=layer)
        count, bound = cut(own).count, partition_bytes(own, further_sets(own)) / OF_BLOCK[2]
        assert count < bound < 2 * count
    bedding = {"dip": 0.0, "spacing": 1e-3, "through": [0.0, 1.5], "regions": ["1.5"]}
    words = r"block = 1\.0: gives .* blocks, most of them in region '1\.5', cut 0\.001 m apart,"
    with pytest.raises(SceneError, match=words):
        cut(scene(bedding, poisson=0.25, layer=0.9))


def test_slivers_of_a_lattice_are_joined_along_joints_not_across_them(scene):
    """Triangles have slivers at all sides, and at the joint's ends as well: it keeps its length,
    and no block is thinner than 0.03 of the spacing."""
    own = scene({"dip": -40.0, "through": [5.3, 4.1]}, block=1.1, poisson=0.25)
    found, alone = cut(own), blocks_of_scene(own)
    mine = found.contacts.of_joints(1)
    assert found.contacts.area[mine].sum() == pytest.approx(alone.contacts.area[0], rel=1e-9)
    assert min(width(found.outlines.of(k)) for k in range(found.count)) > 0.03 * 1.1


BED = {"dip": 0.0, "spacing": 2.0}
STEEP = {"dip": 90.0, "dip_direction": 90.0, "spacing": 2.0}


@pytest.mark.parametrize("sets", [[], [BED], [STEEP], [BED, STEEP]])
def test_rock_in_space_is_cut_in_cubes(scene, sets):
    """Across all directions in which no joints cut."""
    found = cut(scene(*sets, size=BOX))
    assert found.count == 120 and found.volume == pytest.approx(np.ones(120), rel=1e-9)
    assert len(found.contacts) == 5 * 5 * 4 + 6 * 4 * 4 + 6 * 5 * 3
    of_joints = found.contacts.area[found.contacts.of_joints(len(sets))].sum()
    assert of_joints == pytest.approx(30.0 * (BED in sets) + 40.0 * (STEEP in sets), rel=1e-9)


def test_rock_in_space_with_a_poisson_effect_is_cut_in_tetrahedra(scene):
    """Five to a cube: a regular one in its middle, and four at corners."""
    volume = np.sort(cut(scene(BED, poisson=0.25, size=BOX)).volume)
    assert volume == pytest.approx(np.repeat([1 / 6, 1 / 3], [480, 120]), rel=1e-9)


dips, degrees = st.floats(-90.0, 90.0), st.floats(0.0, 360.0)


@settings(max_examples=15)
@given(
    poisson=st.floats(0.01, 0.45),
    dip=st.floats(1.0, 89.0),
    towards=degrees,
    layer=st.sampled_from([0.3, 0.9]),
)
def test_tetrahedra_have_any_poissons_ratio(scene, poisson, dip, towards, layer):
    """As triangles have: rigid blocks lack nothing of intact rock, however the joints lie."""
    one = {"dip": dip, "dip_direction": towards, "spacing": 2.0}
    layered = [scene(poisson=poisson, size=size, layer=layer) for size in (BOX, BOX[1:])]
    for own in (scene(one, poisson=poisson, size=BOX), scene(BED, poisson=poisson), *layered):
        joints = rigid_joints(own, further_sets(own))
        assert joints.left_over < 1e-6 and (joints.shear <= joints.normal).all()


@settings(max_examples=20)
@given(
    sets=st.lists(st.tuples(dips, st.booleans()), max_size=2, unique_by=lambda one: one[0]),
    poisson=st.sampled_from([0.0, 0.25]),
    held=st.lists(st.sampled_from(["quiet", "free"]), min_size=4, max_size=4),
)
def test_a_thin_plate_in_space_is_cut_as_the_plane_is(scene, sets, poisson, held):
    """Block for block: volumes are areas times the thickness, contacts likewise."""
    keys = dict(zip(("left", "right", "bottom", "top"), held, strict=True))
    keys |= {"poisson": poisson, "width": 0.02}
    each = [{"dip": dip, "spacing": 3.0} if many else {"dip": dip} for dip, many in sets]
    found = cut(scene(*(one | {"through": [5.0, 4.0]} for one in each), **keys))
    for one in each:
        one |= {"dip_direction": 270.0 if one["dip"] >= 0 else 90.0, "through": [5.0, 0.0, 4.0]}
        one["dip"] = abs(one["dip"])
    plate = cut(scene(*each, size=(12.0, 0.5, 10.0), **keys))
    assert np.sort(plate.volume) == pytest.approx(0.5 * np.sort(found.volume), rel=1e-6)
    for k in range(len(sets)):
        areas = [one.contacts.area[one.contacts.joint_set == k].sum() for one in (plate, found)]
        assert areas[0] == pytest.approx(0.5 * areas[1], rel=1e-6)
