"""Errors when a rock mass is cut: in one line, with file, key, place and cause."""

import re

import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.cell_complex import NO_SET, GeometryError, NonConvex, Sliver
from jointwave.cases.partition.scene import block_count, blocks_of_scene, partition_bytes
from jointwave.cases.partition.scene import blocks_of_domain as cut
from jointwave.cases.read import load_variant
from tests.cases.partition.polygons import periodic_contacts

SCENE = """\
title = "rows"
[domain]
size = [10.0, 6.0]
[rock]
density = 2600.0
intact_modulus = 5.0e10
[[joint_sets]]
name = "rows"
dip = 0.0
spacing = 1.0
normal_stiffness = 1.0e10
shear_stiffness = 4.0e9
[time]
duration = 0.1
[record]
points = [[4.0, 3.5]]
"""


@pytest.fixture
def scene(tmp_path):
    """Return a function of changes: the scene of six rows."""
    path = tmp_path / "rows.toml"
    path.write_text(SCENE)
    return lambda **changes: load_variant(
        path, "", {k.replace("__", "."): v for k, v in changes.items()}
    )


def line(scene):
    """Return the one line that refuses a scene, without its file."""
    with pytest.raises(SceneError) as error:
        blocks_of_scene(scene)
    said = str(error.value)
    assert said.startswith(scene.where) and "\n" not in said
    return said.removeprefix(f"{scene.where}: ")


def test_the_scene_is_cut(scene):
    assert blocks_of_scene(scene()).count == 6


@pytest.mark.parametrize("scatter", [{}, {"scatter": 0.01, "seed": 1}])
def test_a_set_that_cuts_nothing_is_refused_when_it_is_read(scene, scatter):
    """The spacing of its joints exceeds the domain's height, and one lies along its bottom."""
    changes = {f"joint_sets__0__{key}": value for key, value in scatter.items()}
    with pytest.raises(
        SceneError,
        match=r"rows.toml: joint_sets\[0\]: does not cut the domain, or only",
    ):
        scene(joint_sets__0__spacing=7.0, **changes)
    assert blocks_of_scene(scene(joint_sets__0__spacing=5.5, **changes)).count == 2


def test_a_set_along_the_joints_of_another_cuts_nothing(scene):
    law = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
    sets = [{"name": n, "dip": 0.0, "spacing": s, **law} for n, s in (("a", 1.0), ("b", 2.0))]
    assert line(scene(joint_sets=sets)).startswith("joint_sets[1]: does not cut")


def test_one_joint_outside(scene):
    """Through a point of no block."""
    law = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
    one = {"name": "one", "dip": 45.0, "through": [20.0, 3.0], **law}
    said = r"joint_sets\[0\].through: must lie in the domain, near \[20, 3\]$"
    with pytest.raises(SceneError, match=said):
        scene(joint_sets=[one])


def test_one_joint_on_the_joint_that_it_ends_at(scene, joints):
    from jointwave.cases.schema.domain import Domain

    sets = [joints("rows", 0.0, spacing=1.0)]
    one = joints("one", 60.0, through=[5.0, 2.0], ends_at=["rows"])
    with pytest.raises(
        GeometryError, match=re.escape("must not lie on a joint of rows, near [5, 2]")
    ):
        cut(Domain(size=[10.0, 6.0]), [*sets, one])


def test_blocks_that_are_not_convex(scene):
    """At a corner of the tunnel inside a row, unless cutting is requested."""
    tunnel = [[4.0, 1.0], [6.0, 1.0], [6.0, 2.5], [4.0, 2.5]]
    said = line(scene(domain__openings=[tunnel], record__points=[[1.0, 1.0]]))
    assert said.startswith("domain: a block is not convex") and 'domain.non_convex = "cut"' in said
    assert re.search(r"near \[[46], 2.5\]$", said)
    changes = {"domain__openings": [tunnel], "domain__non_convex": "cut"}
    assert blocks_of_scene(scene(**changes, record__points=[[1.0, 1.0]])).count == 6 + 1 + 2


def test_an_outline_that_is_not_convex(scene):
    corners = [[0.0, 0.0], [10.0, 0.0], [10.0, 6.0], [7.0, 6.0], [4.0, 3.5], [0.0, 3.5]]
    said = line(scene(domain={"outline": corners}))
    assert said.endswith("near [4, 3.5]") and "corner of the outline" in said


@pytest.mark.parametrize("slivers", ["merge", "refuse"])
def test_a_row_that_is_too_thin(scene, slivers):
    """Two joints 5 mm apart: joined to the row above or below, or refused on request."""
    law = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
    near = {"name": "near", "dip": 0.0, "through": [0.0, 2.005], **law}
    changed = scene(domain__slivers=slivers)
    changed = changed.model_copy(
        update={"joint_sets": [*changed.joint_sets, type(changed.joint_sets[0])(**near)]}
    )
    if slivers == "merge":
        found = blocks_of_scene(changed)
        assert found.count == 6 and found.volume.sum() == pytest.approx(60, rel=1e-14)
    else:
        said = line(changed)
        assert "is 0.005 m wide" in said and "domain.least_width = 0.01" in said
        assert said.endswith("near [5, 2.0025]")


def test_slivers_that_two_neighbours_take(rectangle, joints):
    """A thin row of bricks under rows with joints elsewhere: each brick is cut where the joint
    between the two below it ends."""
    rows = joints("rows", 0.0, spacing=1.0)
    cross = joints("cross", 90.0, spacing=2.0, ends_at=["rows"], offset=0.5)
    found = cut(rectangle(10.0, 3.005), [rows, cross])
    assert found.count == cut(rectangle(10.0, 3.0), [rows, cross]).count
    assert found.volume.sum() == pytest.approx(30.05, rel=1e-14)
    assert found.outlines.corners[:, 1].max() == 3.005 and (found.volume < 2.1).all()


def test_slivers_that_no_neighbour_takes(rectangle, joints):
    """A joint along the roof of an opening, at less than a degree: what is between them stays
    pointed, however it is cut."""
    opening = [[4.0, 2.0], [5.0, 1.0], [6.0, 2.0], [6.5, 2.9], [6.0, 3.0], [4.0, 2.9]]
    domain = rectangle(10.0, 6.0, openings=[opening], non_convex="cut")
    sets = [joints("roof", 2.0, through=[6.0, 3.0]), joints("steep", 70.0, through=[5.7, 3.0])]
    with pytest.raises(Sliver, match="to a neighbour leaves no convex block, near"):
        cut(domain, sets)


FAN = [[4.1, 3.5], [4.1, 2.9], [4.5, 2.4], [4.9, 2.2], [5.2, 2.2], [5.8, 2.4]]
WEDGE = [[6.3, 3.3], [6.1, 4.0], [4.6, 4.7], [5.4, 2.0], [6.1, 2.6], [6.3, 3.2]]


@pytest.mark.parametrize(
    ("opening", "dips", "least"),
    [(FAN, {-25.0: 2.4}, 0.3), (WEDGE, {64.0: 2.6, -43.0: 1.2, 80.0: 2.2}, 0.1)],
)
def test_slivers_do_not_pass_parts_to_each_other_for_ever(opening, dips, least, rectangle, joints):
    """Two beside an opening, each cut where the other's side ends."""
    limits = {"least_width": least, "least_angle": 5.0}
    domain = rectangle(10.0, 6.0, openings=[opening], non_convex="cut", **limits)
    sets = [
        joints(f"{dip:g}", dip, spacing=spacing, through=[5.0, 3.0])
        for dip, spacing in dips.items()
    ]
    with pytest.raises(Sliver, match="to a neighbour leaves no convex block, near"):
        cut(domain, sets)


def test_a_corner_of_less_than_the_least_angle(rectangle, joints):
    """One joint that leaves a corner at 0.5 degrees: joined, and nothing is left of the joint."""
    one = joints("flat", 0.5, through=[0.0, 1.0])
    found = cut(rectangle(2.0, 2.0, least_angle=0.4), [one])
    assert found.count == 2
    pointed = joints("flat", 0.5, through=[0.0, 0.0])
    with pytest.raises(Sliver, match=r"an angle of 0\.5 degrees"):
        cut(rectangle(2.0, 2.0, slivers="refuse", least_width=1e-6), [pointed])


def test_periodic_sides_need_the_same_joint_on_both(rectangle, joints):
    rows, columns = joints("rows", 0.0, spacing=1.0), joints("columns", 90.0, spacing=2.0)
    sets = [rows, columns]
    found = cut(rectangle(10.0, 6.0), sets)
    across = periodic_contacts(found, "left", sets)
    assert len(across) == 6 and set(across.joint_set) == {1}
    assert (across.normal == [1.0, 0.0]).all() and (across.ends[..., 0] == 10.0).all()
    assert (across.ends[:, 1, 1] > across.ends[:, 0, 1]).all()
    assert len(periodic_contacts(found, "bottom", sets)) == 5
    with pytest.raises(GeometryError, match="no joint of one set runs along both sides"):
        periodic_contacts(cut(rectangle(9.0, 6.0), sets), "left", sets)


def test_periodic_sides_of_other_rows_split_each_other(rectangle, joints):
    """Rows that climb by half a row from column to column: each block meets two across."""
    columns = joints("columns", 90.0, spacing=2.0)
    bricks = joints("bricks", 0.0, spacing=1.0, ends_at=["columns"], offset=0.5)
    sets = [columns, bricks]
    across = periodic_contacts(cut(rectangle(4.0, 4.0), sets), "left", sets)
    assert across.area.sum() == pytest.approx(4.0, rel=1e-14)
    assert len(across) == 8 and across.area.max() == pytest.approx(0.5)


def test_a_periodic_scene_needs_faces_that_match(scene, rectangle, joints):
    """Rows lie along the bottom and the top, and end at the left and the right, where each meets
    its own end. Joints at 45 degrees climb 10 m: those 1 m apart meet, those 4 m apart end 2 m
    from one another. An opening at the left leaves rock at the right that meets none."""
    for sides in (("bottom", "top"), ("left", "right")):
        assert blocks_of_scene(scene(boundaries=dict.fromkeys(sides, "periodic"))).count == 6
    across = periodic_contacts(blocks_of_scene(scene()), "left", scene().joint_sets)
    assert len(across) == 6 and set(across.joint_set) == {NO_SET}
    met = [joints("steep", 45.0, spacing=0.5**0.5, through=[0.0, 0.5])]
    assert len(periodic_contacts(cut(rectangle(10.0, 12.0), met), "left", met)) == 13
    missed = [joints("steep", 45.0, spacing=8**0.5, through=[0.0, 1.0])]
    with pytest.raises(GeometryError, match=r"a joint of 'steep' ends there .* near \[0, 1\]"):
        periodic_contacts(cut(rectangle(10.0, 12.0), missed), "left", missed)
    hole = [[0.0, 2.0], [2.0, 2.0], [2.0, 4.0], [0.0, 4.0]]
    flat = joints("rows", 0.0, spacing=2.0)
    open_at_left = cut(rectangle(10.0, 6.0, openings=[hole], non_convex="cut"), [flat])
    with pytest.raises(GeometryError, match=r"faces none on the left, near \[10, 3\]"):
        periodic_contacts(open_at_left, "left", [flat])


def test_a_size_beyond_the_memory(scene, monkeypatch):
    """Refused with the estimate, before anything is cut."""
    monkeypatch.setenv("JOINTWAVE_MEMORY", "0.5")
    said = line(scene(joint_sets__0__spacing=1e-5))
    assert said.startswith("joint_sets[0].spacing = 1e-05: gives about 600,001 blocks")
    assert "about 1.5 GB of memory; 500 MB available" in said
    tiny = line(scene(joint_sets__0__spacing=1e-30))
    assert "e+" in tiny or len(tiny) < 400


@pytest.mark.parametrize("spacing", [0.5, 0.1])
def test_the_estimate_is_near_what_is_cut(rectangle, joints, spacing):
    sets = [
        joints("a", 30.0, spacing=spacing),
        joints("b", -60.0, spacing=2 * spacing, ends_at=["a"], offset=0.5),
        joints("c", 80.0, through=[5.0, 3.0]),
    ]
    domain = rectangle(10.0, 6.0)
    assert block_count(domain, sets) == pytest.approx(cut(domain, sets).count, rel=0.2)


def test_the_estimate_bounds_the_memory_that_is_taken(rectangle, joints, scene):
    """The peak of Python's allocations while 20,000 blocks are cut."""
    import tracemalloc

    changed = scene(domain__size=[100.0, 100.0], joint_sets__0__spacing=0.7)
    steep = joints("steep", 60.0, spacing=0.7)
    changed = changed.model_copy(update={"joint_sets": [*changed.joint_sets, steep]})
    blocks_of_scene(changed)  # whatever is imported
    tracemalloc.start()
    found = blocks_of_scene(changed)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert found.count > 15_000
    assert found.nbytes < peak < partition_bytes(changed) < 4 * peak


def test_faults_are_told_apart():
    assert issubclass(Sliver, GeometryError) and issubclass(NonConvex, GeometryError)
