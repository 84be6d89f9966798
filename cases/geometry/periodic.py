"""Contacts across pairs of periodic sides: facets that overlap once shifted by the domain's
extent."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import shapely

from jointwave.cases.geometry.blocks import Blocks, Facets
from jointwave.cases.geometry.cell_complex import NO_SET, GeometryError
from jointwave.cases.geometry.measure import Outlines, around, outline_moments
from jointwave.cases.geometry.relations import sums

SAME = 1e-9  #: tolerance over the domain's extent: nearer places on a side coincide


class Across(NamedTuple):
    """Contacts across a pair of periodic sides, of a joint set where a joint runs along both sides.
    Block i is at the far side, block j at the near one, in no order; outlines and normals are those
    at i. shift : [d], m, offset of blocks j. sides : names of the pair, the near one first."""

    contacts: Facets
    shift: np.ndarray
    sides: tuple[str, str]


def of_all(blocks: Blocks, across: Sequence[Across], key: str) -> np.ndarray:
    """Return an array over all contacts, those across periodic sides last."""
    parts = blocks.contacts, *(one.contacts for one in across)
    return np.concatenate([getattr(part, key) for part in parts])


def contacts_across(
    blocks: Blocks, axis: int, sides: tuple[str, str], names: Sequence[str]
) -> Facets:
    """Return the contacts of blocks i at the high end of an axis with blocks j at its low end.

    Normals and outlines are those at blocks i; i and j are in no order. sides : names of the low
    and the high end. names : of the scene's joint sets, which come first.

    Raises GeometryError where rock faces no rock, or a joint runs along or ends at one side only.
    """
    outer, joints, x = blocks.boundary, len(names), blocks.body.vertices
    least, key = SAME * float(np.ptp(x, axis=0).max()), f"boundaries.{sides[0]}"
    far, near = (_facets_at(blocks, axis, sign) for sign in (1, -1))
    if not len(far) or not len(near):
        raise GeometryError(None, "is periodic, but the domain has no such side", "boundaries")
    here, there = (
        np.array([_polygon(outer.outlines.of(k), axis) for k in one], dtype=object)
        for one in (far, near)
    )
    i, j = shapely.STRtree(there).query(here, predicate="intersects")
    shared = shapely.intersection(here[i], there[j])
    wide = shapely.area(shared) > _sliver(shared, least)
    i, j, shared = i[wide], j[wide], shared[wide]
    for facets, shapes, which, name in ((far, here, i, sides[0]), (near, there, j, sides[1])):
        left = shapely.area(shapes) - sums(which, shapely.area(shared), len(shapes))
        if (left > _sliver(shapes, least)).any():
            at = outer.centroid[facets[np.argmax(left)]]
            raise GeometryError(at, f"is periodic, but rock there faces none on the {name}", key)
    pairs = np.stack([far[i], near[j]], axis=1)
    own, beyond = outer.joint_set[pairs].T
    joint = ((own >= 0) & (own < joints)) | ((beyond >= 0) & (beyond < joints))
    normal = outer.normal[far[i]]
    outlines = _outlines(shared, axis, float(x[:, axis].max()), normal)
    m, sets = outline_moments(outlines), np.where(own == beyond, own, NO_SET)
    wrong = joint & (sets == NO_SET)
    if wrong.any():
        cause = "is periodic, but no joint of one set runs along both sides"
        raise GeometryError(m.centroid[np.argmax(wrong)], cause, key)
    _check_ends(blocks, axis, sides, shared[~joint], names, least)
    return Facets(outer.blocks[pairs, 0], normal, *m, sets, np.zeros(len(sets), np.int64), outlines)


def _sliver(shapes: np.ndarray, least: float) -> np.ndarray:
    """Return the area below which an overlap is ignored, m2."""
    return least * np.maximum(shapely.length(shapes) / 4, 1)


def _facets_at(blocks: Blocks, axis: int, sign: int) -> np.ndarray:
    """Return the boundary facets at the high (1) or the low end (-1) of an axis, int array."""
    x, outer = blocks.body.vertices[:, axis], blocks.boundary
    off = np.abs(sign * outer.centroid[:, axis] - (sign * x).max())
    along = sign * outer.normal[:, axis] > 1 - 1e-12
    return np.flatnonzero(along & (off <= SAME * np.ptp(x)))


def _polygon(corners: np.ndarray, axis: int) -> shapely.Polygon:
    """Return a piece of a side, corners [n, d], m, as a polygon; missing axes have unit width."""
    own = np.delete(corners, axis, axis=1)
    if own.shape[1] == 2:
        return shapely.Polygon(own)
    ends = own[:, 0] if own.shape[1] else np.array([0.0, 1.0])
    return shapely.box(ends.min(), 0.0, ends.max(), 1.0)


def _outlines(shared: np.ndarray, axis: int, place: float, normal: np.ndarray) -> Outlines:
    """Return the outlines of polygons made by `_polygon`, around a normal [n, d] each."""
    corners, of = shapely.get_coordinates(shared, return_index=True)
    own = np.unique(np.column_stack([of, corners[:, : normal.shape[1] - 1]]), axis=0)
    x = np.insert(own[:, 1:], axis, place, axis=1)
    return around(x, own[:, 0].astype(np.int64), normal, 0.0)


def _check_ends(
    blocks: Blocks,
    axis: int,
    sides: tuple[str, str],
    rock: np.ndarray,
    names: Sequence[str],
    least: float,
) -> None:
    """Raise GeometryError where a joint ends at only one of two sides, inside rock.

    rock : polygons, m, that the sides share without a joint.
    """
    if not len(rock):
        return
    x, contacts, traces = blocks.body.vertices[:, axis], blocks.contacts, []
    for place in (x.min(), x.max()):  # traces of joints: set, line in the side, a point of it
        found: list[tuple[int, shapely.Geometry, np.ndarray]] = []
        for k in np.flatnonzero(contacts.of_joints(len(names))):
            corners = contacts.outlines.of(k)
            on = corners[np.abs(corners[:, axis] - place) <= least]
            if len(on) == blocks.body.dim - 1 > 0:
                own = np.delete(on, axis, axis=1)
                ends = own if len(own) > 1 else [[own[0, 0], 0.0], [own[0, 0], 1.0]]
                found.append((int(contacts.joint_set[k]), shapely.LineString(ends), on[0]))
        traces.append(found)
    inner = shapely.buffer(shapely.box(*shapely.total_bounds(rock)), -least)
    for one, beyond, name in zip(traces, traces[::-1], sides[::-1], strict=True):
        for k, trace, at in one:
            middle = shapely.centroid(trace)
            amid = inner.contains(middle) and shapely.dwithin(rock, middle, least).any()
            partners = [other for own, other, _ in beyond if own == k]
            if amid and not shapely.dwithin(partners, middle, least).any():
                cause = (
                    f"is periodic, but a joint of {names[k]!r} ends there and not at the same "
                    f"place on the {name}"
                )
                raise GeometryError(at, cause, f"boundaries.{sides[0]}")
