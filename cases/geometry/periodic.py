"""Contacts across a pair of opposite sides of a domain, whose facets overlap when one is moved by
the domain's extent, with a joint there or without."""

from collections.abc import Sequence

import numpy as np
import shapely

from jointwave.cases.geometry.blocks import Blocks, Facets
from jointwave.cases.geometry.cell_complex import NO_SET, GeometryError
from jointwave.cases.geometry.measure import around, outline_moments

SAME = 1e-9  #: of the domain's extent: lengths below which places on a side are one


def contacts_across(
    blocks: Blocks, axis: int, sides: tuple[str, str], names: Sequence[str]
) -> Facets:
    """Return the contacts of blocks i at the high end of an axis with blocks j at its low end.

    Normals and outlines are those at blocks i; i and j are in no order. sides : names of the low
    and the high end. names : of the joint sets, which are the first ones of all.

    Raises GeometryError where rock faces no rock, a joint runs along one of the sides only, or ends
    at one of them only.
    """
    joints, least = len(names), SAME * float(np.ptp(blocks.body.vertices, axis=0).max())
    ends = [_Side(blocks, axis, k) for k in (1, 0)]
    if not all(len(one.facets) for one in ends):
        raise GeometryError(None, "is periodic, but the domain has no such side", "boundaries")
    here, there = ends
    i, j = shapely.STRtree(there.shapes).query(here.shapes, predicate="intersects")
    shared = shapely.intersection(here.shapes[i], there.shapes[j])
    wide = shapely.area(shared) > least * np.maximum(shapely.length(shared) / 4, 1)
    i, j, shared = i[wide], j[wide], shared[wide]
    key = f"boundaries.{sides[0]}"
    for one, which, name in ((here, i, sides[0]), (there, j, sides[1])):
        left = shapely.area(one.shapes) - np.bincount(
            which, weights=shapely.area(shared), minlength=len(one.shapes)
        )
        if (left > least * np.maximum(shapely.length(one.shapes) / 4, 1)).any():
            at = blocks.boundary.centroid[one.facets[np.argmax(left)]]
            raise GeometryError(at, f"is periodic, but rock there faces none on the {name}", key)
    own, beyond = (blocks.boundary.joint_set[e.facets[k]] for e, k in ((here, i), (there, j)))
    sets = np.where(own == beyond, own, NO_SET)
    joint = ((own >= 0) & (own < joints)) | ((beyond >= 0) & (beyond < joints))
    found = _facets(blocks, axis, here, there, (i, j), shared, sets)
    wrong = joint & (sets == NO_SET)
    if wrong.any():
        cause = "is periodic, but no joint of one set runs along both sides"
        raise GeometryError(found.centroid[np.argmax(wrong)], cause, key)
    _check_ends(blocks, axis, sides, shared[~joint], names, least)
    return found


class _Side:
    """One end of an axis: its boundary facets (int array), and these as polygons in the plane of
    the other axes; in fewer dimensions with a width of 1 across what there is."""

    def __init__(self, blocks: Blocks, axis: int, end: int) -> None:
        x, outer = blocks.body.vertices[:, axis], blocks.boundary
        self.place = float(x.max() if end else x.min())
        normal = np.eye(blocks.body.dim)[axis] * (1 if end else -1)
        along = outer.normal @ normal > 1 - 1e-12
        near = np.abs(outer.centroid[:, axis] - self.place) <= SAME * np.ptp(x)
        self.facets = np.flatnonzero(along & near)
        corners = [np.delete(outer.outlines.of(k), axis, axis=1) for k in self.facets]
        self.shapes = np.array([shape_of(one) for one in corners], dtype=object)


def shape_of(corners: np.ndarray) -> shapely.Polygon:
    """Return a piece of a side as a polygon; corners [n, d - 1], m."""
    if corners.shape[1] == 2:
        return shapely.Polygon(corners)
    ends = corners[:, 0] if corners.shape[1] else np.array([0.0, 1.0])
    return shapely.box(ends.min(), 0.0, ends.max(), 1.0)


def _facets(
    blocks: Blocks,
    axis: int,
    here: _Side,
    there: _Side,
    pairs: tuple[np.ndarray, np.ndarray],
    shared: np.ndarray,
    sets: np.ndarray,
) -> Facets:
    """Return overlaps of facets as contacts."""
    outer, normal = blocks.boundary, blocks.boundary.normal[here.facets[pairs[0]]]
    corners, of = shapely.get_coordinates(shared, return_index=True)
    own = np.unique(np.column_stack([of, corners[:, : blocks.body.dim - 1]]), axis=0)
    x = np.insert(own[:, 1:], axis, here.place, axis=1)
    outlines = around(x, own[:, 0].astype(np.int64), normal, 0.0)
    m = outline_moments(outlines)
    return Facets(
        blocks=np.stack(
            [outer.blocks[e.facets[k], 0] for e, k in zip((here, there), pairs, strict=True)],
            axis=1,
        ),
        normal=normal,
        area=m.size,
        centroid=m.centroid,
        second_moment=m.second,
        joint_set=sets,
        side=np.zeros(len(sets), np.int64),
        outlines=outlines,
    )


def _check_ends(
    blocks: Blocks,
    axis: int,
    sides: tuple[str, str],
    rock: np.ndarray,
    names: Sequence[str],
    least: float,
) -> None:
    """Raise GeometryError where a joint ends at one of two sides only, amid rock.

    rock : what the sides share without a joint there, polygons.
    """
    x = blocks.body.vertices[:, axis]
    traces = [_traces(blocks, axis, place, len(names), least) for place in (x.min(), x.max())]
    if not len(rock):
        return
    inner = shapely.buffer(shapely.box(*shapely.total_bounds(rock)), -least)
    for one, beyond, name in ((0, 1, sides[1]), (1, 0, sides[0])):
        for k, trace, at in traces[one]:
            middle = shapely.centroid(trace)
            amid = inner.contains(middle) and shapely.dwithin(rock, middle, least).any()
            partners = [other for own, other, _ in traces[beyond] if own == k]
            if amid and not shapely.dwithin(partners, middle, least).any():
                cause = (
                    f"is periodic, but a joint of {names[k]!r} ends there and not at the same "
                    f"place on the {name}"
                )
                raise GeometryError(at, cause, f"boundaries.{sides[0]}")


def _traces(
    blocks: Blocks, axis: int, place: float, joints: int, least: float
) -> list[tuple[int, shapely.Geometry, np.ndarray]]:
    """Return where joints end at a side: the set, the line in the plane of the other axes, and a
    point of it [d]."""
    contacts, found = blocks.contacts, []
    for k in np.flatnonzero(contacts.of_joints(joints)):
        corners = contacts.outlines.of(k)
        on = corners[np.abs(corners[:, axis] - place) <= least]
        if len(on) == blocks.body.dim - 1 and len(on):
            own = np.delete(on, axis, axis=1)
            if own.shape[1] == 1:
                own = np.array([[own[0, 0], 0.0], [own[0, 0], 1.0]])
            found.append((int(contacts.joint_set[k]), shapely.LineString(own), on[0]))
    return found
