"""Properties of every partition, over random domains and joint sets."""

import numpy as np
import pytest
import shapely
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from jointwave.cases.geometry.cell_complex import GeometryError
from jointwave.cases.geometry.locate import contact_at
from jointwave.cases.geometry.sets import places_between
from jointwave.cases.partition.joints import plane_sets
from jointwave.cases.partition.scene import blocks_of_domain as cut
from jointwave.cases.partition.scene import least_width
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint import JointSet, direction_of
from tests.cases.partition.polygons import angles, block_at, closed, width

LAW = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
HEXAGON = [[0.0, 1.0], [4.0, 0.0], [9.0, 0.5], [10.0, 4.0], [6.0, 7.0], [1.0, 5.0]]
SLOPE = [[0.0, 0.0], [10.0, 0.0], [10.0, 6.0], [7.0, 6.0], [4.0, 3.0], [0.0, 3.0]]
ANGLES = np.linspace(0.1, 0.1 + 2 * np.pi, 12, endpoint=False)
TUNNEL = np.round([6 + 1.1 * np.cos(ANGLES), 2.4 + 1.1 * np.sin(ANGLES)], 6).T.tolist()

DOMAINS = [
    {"size": [10.0, 6.0]},
    {"outline": HEXAGON},
    {"outline": SLOPE},
    {"size": [10.0, 6.0], "openings": [TUNNEL]},
    {"outline": HEXAGON, "openings": [[[3.0, 2.0], [4.0, 2.5], [3.5, 4.0]], TUNNEL]},
]
places = st.tuples(st.floats(2.0, 8.0), st.floats(1.0, 4.0)).map(list)


@st.composite
def joint_sets(draw, most=3):
    """Up to three sets, spaced, scattered or single, some of which end at those before."""
    found = []
    for i in range(draw(st.integers(1, most))):
        keys = {"dip": round(draw(st.floats(-90, 90)), 3), "through": draw(places)}
        if not i or draw(st.booleans()):
            keys["spacing"] = draw(st.floats(0.7, 3.0))
            if draw(st.booleans()):
                keys |= {"scatter": draw(st.floats(0.05, 0.5)), "seed": draw(st.integers(0, 99))}
        if i and draw(st.booleans()):
            keys["ends_at"] = [f"set {draw(st.integers(0, i - 1))}"]
            if "spacing" in keys:
                keys["offset"] = draw(st.floats(0, 0.9))
        found.append(JointSet(name=f"set {i}", **keys, **LAW))
    return found


def rock_by_shapely(domain):
    """The domain minus its openings, by shapely only."""
    whole = shapely.Polygon(domain.corners)
    return whole.difference(shapely.union_all([shapely.Polygon(o) for o in domain.openings]))


def partition(domain, sets):
    """A partition; a refusal must say where in the domain, and is no example."""
    try:
        return cut(domain, sets)
    except GeometryError as error:
        assert error.cause and error.key.startswith(("domain", "joint_sets"))
        if error.key.startswith("domain"):
            assert shapely.Point(error.at).distance(rock_by_shapely(domain)) < 1e-6
        assume(False)


#: Joints beside others of their direction, which they end at.
PARALLEL = [JointSet(name="set 0", dip=2.0, spacing=1.0, through=[2.0, 1.5], **LAW)]
ENDING = {"spacing": 2.0, "through": [2.0, 1.0], "ends_at": ["set 0"], "offset": 0.75}
PARALLEL.append(JointSet(name="set 1", dip=2.0, **ENDING, **LAW))

domains = st.sampled_from([Domain(**keys, non_convex="cut", least_angle=0.5) for keys in DOMAINS])


@settings(max_examples=25)
@given(domain=domains, sets=joint_sets())
def test_convex_blocks_without_slivers_fill_the_domain_and_do_not_overlap(domain, sets):
    """By shapely: the union of all blocks is the domain, so that no area is counted twice."""
    found, shape = partition(domain, sets), rock_by_shapely(domain)
    assert found.volume.sum() == pytest.approx(shape.area, rel=1e-12)
    whole = (found.volume @ found.centroid) / shape.area
    np.testing.assert_allclose(whole, shape.centroid.coords[0], rtol=1e-11)
    outlines = [found.outlines.of(k) for k in range(found.count)]
    union = shapely.union_all([shapely.Polygon(one) for one in outlines], grid_size=1e-10)
    assert union.symmetric_difference(shape).area < 1e-7 * shape.area
    for one in outlines:
        inside = angles(one)
        assert domain.least_angle <= inside.min() and inside.max() < 180 - 1e-7
        assert inside.sum() == pytest.approx(180 * (len(one) - 2), rel=1e-9)  # once around
        assert width(one) >= least_width(domain, sets)


@settings(max_examples=25)
@given(domain=domains, sets=joint_sets())
def test_contacts_close_every_block_and_points_are_found_in_them(domain, sets):
    """i < j, once a pair and joint set; from i to j; the set's own normal. Lengths make up the
    perimeter: every inner edge belongs to two blocks, every outer to one."""
    found = partition(domain, sets)
    contacts = found.contacts
    i, j = contacts.blocks.T
    laws = np.column_stack([contacts.blocks, contacts.joint_set])
    assert (i < j).all() and len(np.unique(laws, axis=0)) == len(contacts)
    assert (np.lexsort([j, i]) == np.arange(len(i))).all()
    chord = np.diff(contacts.ends, axis=1)[:, 0]
    tangent = np.stack([-contacts.normal[:, 1], contacts.normal[:, 0]], axis=1)
    np.testing.assert_allclose(tangent * contacts.area[:, None], chord, atol=1e-8)
    for which, sign in ((i, -1), (j, 1)):
        away = sign * ((found.centroid[which] - contacts.ends[:, 0]) * contacts.normal).sum(axis=1)
        assert away.min(initial=1.0) > 0
    for k, one in enumerate(sets):
        own = contacts.normal[contacts.joint_set == k]
        normal = direction_of(one.dip)[::-1] * [-1, 1]
        assert (np.abs(own) == np.abs(normal)).all() and (own @ normal != 0).all()
    around = [shapely.Polygon(found.outlines.of(k)).length for k in range(found.count)]
    np.testing.assert_allclose(closed(found, 1e-8), around, rtol=1e-8)
    assert found.boundary.area.sum() == pytest.approx(rock_by_shapely(domain).length, rel=1e-9)
    np.testing.assert_array_equal(block_at(found, found.centroid), np.arange(found.count))
    assert block_at(found, np.array([[-1.0, 3.0], [5.0, 60.0]])).tolist() == [-1, -1]
    for opening in domain.openings:
        centre = np.mean(opening, axis=0)
        assert block_at(found, centre[None]).tolist() == [-1]
    inner = np.flatnonzero(contacts.joint_set >= 0)
    middle = contacts.ends[inner].mean(axis=1)
    np.testing.assert_array_equal(block_at(found, middle), contacts.blocks[inner, 0])
    # Nearer than any end: where rows nearly meet, a contact is no longer than what sets them apart.
    beside = middle + 1e-6 * contacts.area[inner, None] * contacts.normal[inner]
    np.testing.assert_array_equal(contact_at(found, beside, len(sets)), inner)


@settings(max_examples=25)
@given(sets=joint_sets(most=2), angle=st.floats(-20, 20))
@example(sets=PARALLEL, angle=1.0)
def test_a_turned_domain_is_cut_into_turned_blocks(sets, angle):
    """Turned with its joint sets, openings included; the same blocks in any order."""
    assume(all(abs(one.dip + angle) < 90 for one in sets))  # else rows are counted the other way
    turn = np.array([direction_of(angle), direction_of(angle + 90)])
    keys = {"non_convex": "cut", "least_width": 0.0123, "least_angle": 0.5123}
    one = Domain(outline=HEXAGON, openings=[TUNNEL], **keys)
    outline, tunnel = (np.round(np.array(x) @ turn, 12).tolist() for x in (HEXAGON, TUNNEL))
    other = Domain(outline=outline, openings=[tunnel], **keys)
    found = partition(one, sets)
    keys = [{"dip": s.dip + angle, "through": (np.array(s.through) @ turn).tolist()} for s in sets]
    turned = cut(other, [s.model_copy(update=k) for s, k in zip(sets, keys, strict=True)])
    assert turned.count == found.count and len(turned.contacts) == len(found.contacts)
    pair = block_at(turned, found.centroid @ turn)
    assert sorted(pair) == list(range(found.count))
    np.testing.assert_allclose(turned.centroid[pair], found.centroid @ turn, atol=1e-8)
    np.testing.assert_allclose(turned.volume[pair], found.volume, rtol=1e-6)
    polar = [np.trace(each.second_moment, axis1=1, axis2=2) for each in (turned, found)]
    np.testing.assert_allclose(polar[0][pair], polar[1], rtol=1e-6)
    known = {tuple(sorted(blocks)) for blocks in turned.contacts.blocks}
    assert known == {tuple(sorted(pair[blocks])) for blocks in found.contacts.blocks}


@settings(max_examples=25)
@given(sets=joint_sets().filter(lambda sets: not any(one.ends_at for one in sets)))
def test_blocks_are_those_of_polygonize(sets):
    """Through-going sets against shapely's noding of lines, an independent way to cut."""
    domain = Domain(size=[10.0, 6.0], slivers="refuse", least_width=1e-4, least_angle=0.0)
    found, box = partition(domain, sets), shapely.box(0, 0, 10, 6)
    lines = [box.exterior]
    for one in sets:
        along, at = direction_of(one.dip), np.array(one.through)
        places = [0.0]
        if one.spacing is not None:
            places, _ = places_between(plane_sets([one])[0], np.array([0]), 0.0, -20.0, 20.0)
        across = np.array([-along[1], along[0]])
        lines += [
            shapely.LineString([at + s * across - 40 * along, at + s * across + 40 * along])
            for s in places
        ]
    cells = shapely.get_parts(shapely.polygonize([shapely.union_all(lines)]))
    inside = [cell.area for cell in cells if box.contains(cell.representative_point())]
    areas = np.sort([area for area in inside if area > 1e-10])  # three lines meet to round-off
    assert len(areas) == found.count
    np.testing.assert_allclose(np.sort(found.volume), areas, rtol=1e-7, atol=1e-9)
