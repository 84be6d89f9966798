"""Properties of domains cut by planes, in one, two and three dimensions, over random sets."""

from dataclasses import replace
from math import factorial

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull, HalfspaceIntersection

from jointwave.cases.geometry.blocks import blocks_of
from jointwave.cases.geometry.cell_complex import OUTSIDE, GeometryError, box
from jointwave.cases.geometry.measure import least_angles, outline_moments, widths
from jointwave.cases.geometry.periodic import contacts_across
from jointwave.cases.geometry.pieces import without_slivers
from jointwave.cases.geometry.sets import PlaneSet, cut_by_sets
from tests.cases.partition.polygons import closed

SIZE = np.array([3.0, 2.0, 2.5])
TOLERANCE = 1e-9


def plane_set(name, normal, **keys):
    """A set of planes of a normal that need not be of unit length."""
    normal = np.asarray(normal) / np.linalg.norm(normal)
    along = np.linalg.svd(normal[None])[2][1:]
    return PlaneSet(name, normal, along, **({"through": np.zeros(len(normal))} | keys))


@st.composite
def domains(draw, most=3, dims=(1, 2, 3), rows=True):
    """A box and up to three sets, spaced, scattered or single, some of which end at others."""
    dim = draw(st.sampled_from(dims))
    found = []
    for i in range(draw(st.integers(1, most))):
        normal = np.array(draw(st.lists(st.floats(-1, 1), min_size=dim, max_size=dim)))
        assume(np.linalg.norm(normal) > 0.1)
        through = draw(st.lists(st.floats(0.2, 0.8), min_size=dim, max_size=dim)) * SIZE[:dim]
        keys = {"through": through, "spacing": None}
        if not i or draw(st.booleans()):
            keys["spacing"] = draw(st.floats(0.4, 2.0))
            if draw(st.booleans()):
                keys |= {"scatter": draw(st.floats(0.05, 0.5)), "seed": draw(st.integers(0, 99))}
        if i and rows and draw(st.booleans()):
            keys["ends_at"] = (f"set {draw(st.integers(0, i - 1))}",)
            keys["offset"] = draw(st.floats(0, 0.9))
        found.append(plane_set(f"set {i}", normal, **keys))
    return dim, found


def blocks(dim, sets):
    """The blocks of a box; a refusal must say why, and is no example."""
    whole = box(np.zeros(dim), SIZE[:dim])
    try:
        return blocks_of(cut_by_sets(whole, sets, TOLERANCE, needed=0), TOLERANCE)
    except GeometryError as error:
        assert error.cause
        assume(False)


@given(domains())
def test_blocks_add_up_to_the_domain_and_are_closed(domain):
    """Volumes, and first and second moments; every facet has one owner or two, whose areas are one
    array, and n A vanishes in sum around each block."""
    dim, sets = domain
    found = blocks(dim, sets)
    volume = np.prod(SIZE[:dim])
    assert found.volume.sum() == pytest.approx(volume, rel=1e-12)
    np.testing.assert_allclose(found.volume @ found.centroid / volume, SIZE[:dim] / 2, rtol=1e-12)
    second = found.second_moment.sum(axis=0) + np.einsum(
        "n,ni,nj->ij", found.volume, found.centroid, found.centroid
    )
    expected = volume * (np.outer(SIZE, SIZE) / 4 + np.diag(SIZE**2 / 12))[:dim, :dim]
    np.testing.assert_allclose(second, expected, rtol=1e-11)
    assert (found.body.sides != OUTSIDE).any(axis=1).all()
    closed(found, 1e-12 * SIZE[:dim].prod())
    contacts = found.contacts
    i, j = contacts.blocks.T
    assert (i < j).all() and len(np.unique(contacts.blocks, axis=0)) == len(contacts)
    towards = ((found.centroid[j] - found.centroid[i]) * contacts.normal).sum(axis=1)
    assert towards.min(initial=1.0) > 0


@given(domains(dims=(2, 3)))
def test_euler_s_formula_for_the_domain_and_for_each_block(domain):
    dim, sets = domain
    found = blocks(dim, sets)
    assert sum((-1) ** k * n for k, n in enumerate(found.body.numbers())) == 1
    block, _, outlines = found.faces(TOLERANCE)
    for k in range(found.count):
        faces = np.flatnonzero(block == k)
        corners = np.concatenate([outlines.of(face) for face in faces])
        distinct = len(np.unique(np.round(corners, 7), axis=0))
        edges = len(corners) / 2
        assert (distinct - len(faces) == 0) if dim == 2 else (distinct - edges + len(faces) == 2)


@given(domains(dims=(2, 3)))
def test_moments_are_those_of_intersected_half_spaces(domain):
    """Against Qhull: the hull of the corners that the planes of a block's faces meet at; those of
    contacts by their outlines."""
    dim, sets = domain
    found = blocks(dim, sets)
    block, normal, outlines = found.faces(TOLERANCE)
    place = (normal * outlines.corners[outlines.first[:-1]]).sum(axis=1)
    for k in range(min(found.count, 8)):
        mine = block == k
        assume(found.volume[k] > 1e-6)
        planes = np.column_stack([normal[mine], -place[mine]])
        corners = HalfspaceIntersection(planes, found.centroid[k]).intersections
        x = corners[ConvexHull(corners).simplices] - found.centroid[k]
        volume = np.abs(np.linalg.det(x)) / factorial(dim)
        total, share = x.sum(axis=1), volume / ((dim + 1) * (dim + 2))
        second = np.einsum("n,nki,nkj->ij", share, x, x)
        second += np.einsum("n,ni,nj->ij", share, total, total)
        assert volume.sum() == pytest.approx(found.volume[k], rel=1e-8)
        np.testing.assert_allclose(second, found.second_moment[k], atol=1e-8)
    moments = outline_moments(found.contacts.outlines)
    np.testing.assert_allclose(moments.size, found.contacts.area, atol=1e-10)
    np.testing.assert_allclose(moments.second, found.contacts.second_moment, atol=1e-10)


@given(domains(dims=(2, 3), rows=False), st.integers(0, 1))
def test_a_mirrored_domain_is_cut_into_mirrored_blocks(domain, axis):
    dim, sets = domain
    flip, move = np.ones(dim), np.zeros(dim)
    flip[axis], move[axis] = -1, SIZE[axis]
    mirrored = [replace(s, normal=s.normal * flip, through=s.through * flip + move) for s in sets]
    one, other = blocks(dim, sets), blocks(dim, mirrored)
    assert one.count == other.count and len(one.contacts) == len(other.contacts)
    centre = one.centroid * flip + move
    pair = np.argmin(np.linalg.norm(centre[:, None] - other.centroid, axis=2), axis=1)
    np.testing.assert_allclose(other.volume[pair], one.volume, atol=1e-12)
    np.testing.assert_allclose(other.centroid[pair], centre, atol=1e-7)


@given(domain=domains(dims=(2, 3)), merge=st.booleans())
def test_slivers_are_merged_or_refused_with_place_and_cause(domain, merge):
    dim, sets = domain
    body = blocks(dim, sets).body
    try:
        found = without_slivers(body, 0.05, 5.0, merge, TOLERANCE)
    except GeometryError as error:
        assert ((error.at >= 0) & (error.at <= SIZE[:dim])).all() and "least_width" in error.cause
        return
    half = found.halves()
    used = np.unique(half.cell)
    assert widths(found, half)[used].min() >= 0.05
    assert least_angles(found, half)[used].min() >= 5.0
    assert blocks_of(found, TOLERANCE).volume.sum() == pytest.approx(SIZE[:dim].prod(), rel=1e-9)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_periodic_sides_join_every_facet_once(dim):
    sets = [plane_set(str(k), np.eye(dim)[k], spacing=SIZE[k] / 3) for k in range(dim)]
    sets[0] = plane_set("0", np.eye(dim)[0], spacing=1.0, through=np.full(dim, 0.25))
    found = blocks(dim, sets)
    across = contacts_across(found, 0, ("left", "right"), [one.name for one in sets])
    assert across.area.sum() == pytest.approx(SIZE[1:dim].prod(), rel=1e-12)
    assert len(across) == 3 ** (dim - 1) and (across.joint_set == -1).all()
    away = found.centroid[across.blocks[:, 0]] - found.centroid[across.blocks[:, 1]]
    np.testing.assert_allclose(away[:, 1:], 0, atol=1e-12)
    np.testing.assert_allclose(across.centroid[:, 0], SIZE[0])
