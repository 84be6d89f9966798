"""Rock masses that cannot be cut: one line of file, key, place and cause; and those that can."""

import re
import tracemalloc

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.cell_complex import NO_SET, GeometryError, Sliver
from jointwave.cases.geometry.periodic import contacts_across
from jointwave.cases.partition.scene import block_count, blocks_of_scene, partition_bytes
from jointwave.cases.partition.scene import blocks_of_domain as cut

SIZE = {"size": [10.0, 6.0]}
ROWS = {"dip": 0.0, "spacing": 1.0}
SCATTERED = {"scatter": 0.01, "seed": 1}
NEAR = {"dip": 0.0, "through": [0.0, 2.005]}
TWO = [NEAR, {"dip": 0.0, "through": [0.0, 2.05]}]
FLAT = {"dip": 0.05, "spacing": 2.5, "through": [0.0, 2.003]}
BASE = {"dip": 0.0, "through": [0.0, 0.05]}
AWAY = {"dip": 45.0, "through": [20.0, 3.0]}
TUNNEL = SIZE | {"openings": [[[4.0, 1.0], [6.0, 1.0], [6.0, 2.5], [4.0, 2.5]]]}
DENT = {"outline": [[0.0, 0.0], [10.0, 0.0], [10.0, 6.0], [7.0, 6.0], [4.0, 3.5], [0.0, 3.5]]}


def wide(spacing):
    return ROWS | {"spacing": spacing}


#: Joint sets, the domain, and what the line holds.
MISSED = "joint_sets[0]: does not cut the domain, or only"
UNCUT = 'domain: a block is not convex ... domain.non_convex = "cut" ... , 2.5]'
THIN = "is 0.005 m wide ... domain.least_width = 0.01 ... near [5, 2.0025]"
LOST = "domain: a joint is 0.005 m from a parallel joint ... domain.least_width ... [5, 2.0025]"
MANY = "gives about 600,001 blocks ... about 1.5 GB of memory; 500 MB available"
REFUSED = {
    "a spacing beyond the domain": ([wide(7.0)], SIZE, MISSED),
    "the same with scatter": ([wide(7.0) | SCATTERED], SIZE, MISSED),
    "joints along those of another set": ([ROWS, wide(2.0)], SIZE, "joint_sets[1]: does not cut"),
    "joint outside": ([AWAY], SIZE, "joint_sets[0].through: must lie in the domain, near [20, 3]"),
    "a tunnel inside a row": ([ROWS], TUNNEL, UNCUT),
    "an outline that is not convex": ([ROWS], DENT, "corner of the outline ... near [4, 3.5]"),
    "a row that is too thin": ([ROWS, NEAR], SIZE | {"slivers": "refuse"}, THIN),
    "a joint lost with a row": ([ROWS, NEAR], SIZE, LOST),
    "a joint lost with a wedge": ([ROWS, NEAR | {"dip": 0.02}], SIZE, "a joint is 0.00"),
    "joints of a set lost with wedges": ([wide(2.0), FLAT], SIZE, "m from a parallel joint or"),
    "a joint beside another": (TWO, SIZE, "a joint is 0.045 m from a parallel joint"),
    "a joint beside a side": ([BASE], SIZE, "joint_sets[0]: is lost ... least_width = 0.06 m"),
    "more than the memory": ([wide(1e-5)], SIZE, f"joint_sets[0].spacing = 1e-05: {MANY}"),
    "far more": ([wide(1e-30)], SIZE, "joint_sets[0].spacing = 1e-30: gives about"),
}


@pytest.mark.parametrize(("sets", "domain", "words"), REFUSED.values(), ids=REFUSED)
def test_what_cannot_be_cut_is_refused_in_a_line(rock_with, sets, domain, words, monkeypatch):
    monkeypatch.setenv("JOINTWAVE_MEMORY", "0.5")
    with pytest.raises(SceneError) as error:
        blocks_of_scene(rock_with(*sets, domain=domain))
    said = str(error.value)
    assert said.startswith("scene.toml: ") and "\n" not in said and len(said) < 400
    for word in words.split(" ... "):
        assert word in said


@pytest.mark.parametrize(
    ("sets", "domain", "count"),
    [
        ([wide(5.5)], SIZE, 2),
        ([wide(5.5) | SCATTERED], SIZE, 2),
        ([ROWS], TUNNEL | {"non_convex": "cut"}, 6 + 1 + 2),
        ([ROWS, NEAR], SIZE | {"least_width": 0.004}, 7),
        (TWO, SIZE | {"least_width": 0.04}, 3),
    ],
)
def test_the_same_without_the_cause_is_cut(rock_with, sets, domain, count):
    found = blocks_of_scene(rock_with(*sets, domain=domain))
    assert found.count == count
    assert found.volume.sum() == pytest.approx(60 - 3 * ("openings" in domain), rel=1e-14)


FAN = [[4.1, 3.5], [4.1, 2.9], [4.5, 2.4], [4.9, 2.2], [5.2, 2.2], [5.8, 2.4]]
WEDGE = [[6.3, 3.3], [6.1, 4.0], [4.6, 4.7], [5.4, 2.0], [6.1, 2.6], [6.3, 3.2]]
ROOF = [[4.0, 2.0], [5.0, 1.0], [6.0, 2.0], [6.5, 2.9], [6.0, 3.0], [4.0, 2.9]]


@pytest.mark.parametrize(
    ("opening", "dips", "limits"),
    [
        (ROOF, {2.0: {"through": [6.0, 3.0]}, 70.0: {"through": [5.7, 3.0]}}, {}),
        (FAN, {-25.0: {"spacing": 2.4}}, {"least_width": 0.3, "least_angle": 5.0}),
        (
            WEDGE,
            {64.0: {"spacing": 2.6}, -43.0: {"spacing": 1.2}, 80.0: {"spacing": 2.2}},
            {"least_width": 0.1, "least_angle": 5.0},
        ),
    ],
    ids=["pointed", "two beside an opening", "three"],
)
def test_slivers_that_no_neighbour_takes(rectangle, joints, opening, dips, limits):
    """A joint along the roof of an opening leaves a point however it is cut; two slivers beside an
    opening, each cut where the other's side ends, pass no parts to each other for ever."""
    domain = rectangle(10.0, 6.0, openings=[opening], non_convex="cut", **limits)
    sets = [joints(str(d), d, **{"through": [5.0, 3.0]} | keys) for d, keys in dips.items()]
    with pytest.raises(Sliver, match="to a neighbour leaves no convex block, near"):
        cut(domain, sets)


def test_slivers_that_two_neighbours_take(rectangle, joints):
    """A thin row of bricks under rows with joints elsewhere: each brick is cut where the joint
    between the two below it ends."""
    rows = joints("rows", 0.0, spacing=1.0)
    cross = joints("cross", 90.0, spacing=2.0, ends_at=["rows"], offset=0.5)
    found = cut(rectangle(10.0, 3.005), [rows, cross])
    assert found.count == cut(rectangle(10.0, 3.0), [rows, cross]).count
    assert found.volume.sum() == pytest.approx(30.05, rel=1e-14)
    assert found.outlines.corners[:, 1].max() == 3.005 and (found.volume < 2.1).all()


def test_a_corner_of_less_than_the_least_angle(rectangle, joints):
    """A joint that leaves a corner at 0.5 degrees, and one that lies on a joint that it ends at."""
    one = joints("flat", 0.5, through=[0.0, 1.0])
    assert cut(rectangle(2.0, 2.0, least_angle=0.4), [one]).count == 2
    pointed = joints("flat", 0.5, through=[0.0, 0.0])
    with pytest.raises(Sliver, match=r"an angle of 0\.5 degrees"):
        cut(rectangle(2.0, 2.0, slivers="refuse", least_width=1e-6), [pointed])
    on = [joints("rows", 0.0, spacing=1.0)]
    on.append(joints("one", 60.0, through=[5.0, 2.0], ends_at=["rows"]))
    with pytest.raises(GeometryError, match=re.escape("on a joint of rows, near [5, 2]")):
        cut(rectangle(10.0, 6.0), on)


def across(rectangle, sets, size, pair=("left", "right"), **keys):
    """Return the contacts across periodic sides of a domain."""
    found, names = cut(rectangle(*size, **keys), sets), [one.name for one in sets]
    return contacts_across(found, int("top" in pair), pair, names)


def test_contacts_across_periodic_sides(rectangle, joints):
    """Of columns along both sides; of rows that climb by half a row from column to column, which
    split each other; of rows that each meet their own end; of joints at 45 degrees, which climb
    10 m and meet where they are 1 m apart."""
    rows, columns = joints("rows", 0.0, spacing=1.0), joints("columns", 90.0, spacing=2.0)
    found = across(rectangle, [rows, columns], (10.0, 6.0))
    assert len(found) == 6 and set(found.joint_set) == {1}
    assert (found.normal == [1.0, 0.0]).all() and (found.ends[..., 0] == 10.0).all()
    assert (found.ends[:, 1, 1] > found.ends[:, 0, 1]).all()
    assert len(across(rectangle, [rows, columns], (10.0, 6.0), ("bottom", "top"))) == 5
    bricks = joints("bricks", 0.0, spacing=1.0, ends_at=["columns"], offset=0.5)
    found = across(rectangle, [columns, bricks], (4.0, 4.0))
    assert len(found) == 8 and found.area == pytest.approx(np.full(8, 0.5))
    found = across(rectangle, [rows], (10.0, 6.0))
    assert len(found) == 6 and set(found.joint_set) == {NO_SET}
    steep = joints("steep", 45.0, spacing=0.5**0.5, through=[0.0, 0.5])
    assert len(across(rectangle, [steep], (10.0, 12.0))) == 13


def test_periodic_sides_that_do_not_match_are_refused(rectangle, joints, rock_with):
    """Joints along one side alone; those at 45 degrees and 4 m apart, which end 2 m from one
    another; an opening at the left, which leaves rock at the right that meets none."""
    rows, columns = joints("rows", 0.0, spacing=1.0), joints("columns", 90.0, spacing=2.0)
    with pytest.raises(GeometryError, match="no joint of one set runs along both sides"):
        across(rectangle, [rows, columns], (9.0, 6.0))
    missed = joints("steep", 45.0, spacing=8**0.5, through=[0.0, 1.0])
    with pytest.raises(GeometryError, match=r"a joint of 'steep' ends there .* near \[0, 1\]"):
        across(rectangle, [missed], (10.0, 12.0))
    hole = [[0.0, 2.0], [2.0, 2.0], [2.0, 4.0], [0.0, 4.0]]
    flat = joints("rows", 0.0, spacing=2.0)
    with pytest.raises(GeometryError, match=r"faces none on the left, near \[10, 3\]"):
        across(rectangle, [flat], (10.0, 6.0), openings=[hole], non_convex="cut")
    for sides in (("bottom", "top"), ("left", "right")):
        held = dict.fromkeys(sides, "periodic")
        assert blocks_of_scene(rock_with(ROWS, domain=SIZE, boundaries=held)).count == 6


@pytest.mark.parametrize("spacing", [0.5, 0.1])
def test_the_estimate_is_near_what_is_cut(rectangle, joints, spacing):
    sets = [
        joints("a", 30.0, spacing=spacing),
        joints("b", -60.0, spacing=2 * spacing, ends_at=["a"], offset=0.5),
        joints("c", 80.0, through=[5.0, 3.0]),
    ]
    domain = rectangle(10.0, 6.0)
    assert block_count(domain, sets) == pytest.approx(cut(domain, sets).count, rel=0.2)


def test_the_estimate_bounds_the_memory_that_is_taken(rock_with):
    """The peak of Python's allocations while 20,000 blocks are cut."""
    sets = [ROWS | {"spacing": 0.7}, {"dip": 60.0, "spacing": 0.7}]
    scene = rock_with(*sets, domain={"size": [100.0, 100.0]})
    blocks_of_scene(rock_with(ROWS))  # whatever is imported
    tracemalloc.start()
    found = blocks_of_scene(scene)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert found.count > 15_000
    assert found.nbytes < peak < partition_bytes(scene) < 4 * peak
