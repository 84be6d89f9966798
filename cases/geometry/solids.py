"""Solids that cut a complex along their faces: openings, regions of rock, bays of an outline.

A solid is a polygon in the plane, or a prism in space. The face planes cut the cells that they pass
through, so that cells stay convex; pieces of one cell are then merged as far as they stay convex.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from jointwave.cases.geometry.cell_complex import NO_SET, Complex, GeometryError, Halves
from jointwave.cases.geometry.cut import cut, one_plane
from jointwave.cases.geometry.pieces import Pieces, clipped
from jointwave.cases.geometry.relations import groups

STRAIGHT = 1e-9  #: sine of the turn below which a polygon's corner is collinear
ROCK = -1  #: instead of a region index: rock outside all regions


@dataclass(frozen=True)
class Solid:
    """A polygon in the plane, or a prism in space.

    corners : float array [k, 2], m, counter-clockwise in the axes of the base.
    axes : float array [d, d], unit vectors: two of the base, and in space the prism's axis.
    span : start and end of the prism along its axis, m; unused in the plane.
    """

    corners: np.ndarray
    axes: np.ndarray
    span: tuple[float, float] = (0.0, 0.0)

    def faces(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Return the corners [n, d], m, and the outward normal [d] of each face; ends of a prism
        that are not convex are replaced by their convex hull."""
        start, end = self.corners, np.roll(self.corners, -1, axis=0)
        out = np.stack([end[:, 1] - start[:, 1], start[:, 0] - end[:, 0]], axis=1)
        out = out / np.hypot(*out.T)[:, None] @ self.axes[:2]
        edges = np.stack([start, end], axis=1) @ self.axes[:2]
        if len(self.axes) == 2:
            return list(zip(edges, out, strict=True))
        low, high = np.outer(self.span, self.axes[2])
        sides = [np.concatenate([edge + low, edge[::-1] + high]) for edge in edges]
        hull = corners_of(shapely.Polygon(self.corners).convex_hull) @ self.axes[:2]
        ends = [(hull[::-1] + low, -self.axes[2]), (hull + high, self.axes[2])]
        return [*zip(sides, out, strict=True), *ends]

    def points(self) -> np.ndarray:
        """Return the corners of all faces, face by face [n, d], m."""
        return np.concatenate([corners for corners, _ in self.faces()])

    @property
    def volume(self) -> float:
        """Volume, m^d."""
        length = self.span[1] - self.span[0] if len(self.axes) == 3 else 1.0
        return float(shapely.Polygon(self.corners).area * length)

    def contains(self, points: np.ndarray) -> np.ndarray:
        """Return which points [n, d] lie inside, bool array."""
        own = points @ self.axes.T
        inside = shapely.contains_xy(shapely.Polygon(self.corners), own[:, :2])
        if len(self.axes) == 3:
            inside &= (own[:, 2] > self.span[0]) & (own[:, 2] < self.span[1])
        return inside


def polygon_solid(polygon: shapely.Geometry) -> Solid:
    """Return the solid of a polygon in the plane, m."""
    return Solid(corners_of(polygon), np.eye(2))


def prism(corners: np.ndarray, axis: int, span: tuple[float, float]) -> Solid:
    """Return the prism of a polygon along axis 0, 1 or 2 in space.

    corners : float array [k, 2], m, coordinates along the two other axes in cyclic order (y and z
    along x, z and x along y, x and y along z). span : m, along the axis.
    """
    own = corners_of(shapely.Polygon(corners))
    return Solid(own, np.eye(3)[[(axis + 1) % 3, (axis + 2) % 3, axis]], span)


def corners_of(polygon: shapely.Geometry) -> np.ndarray:
    """Return a polygon's corners [n, 2], not collinear, counter-clockwise from the lower left."""
    once = shapely.remove_repeated_points(polygon, STRAIGHT * polygon.length)
    points = shapely.get_coordinates(shapely.geometry.polygon.orient(once).exterior)[:-1]
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    turn = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    flat = np.abs(turn) <= STRAIGHT * np.hypot(*before.T) * np.hypot(*after.T)
    kept = points[~flat]
    return np.roll(kept, -np.lexsort([kept[:, 1], kept[:, 0]])[0], axis=0)


@dataclass(frozen=True)
class HalfSpace:
    """The half-space that the normal [d] of a plane points into; through : a point of the plane."""

    normal: np.ndarray
    through: np.ndarray

    def contains(self, points: np.ndarray) -> np.ndarray:
        """Return which points [n, d] lie above, bool array."""
        return (points - self.through) @ self.normal > 0


def cut_into_regions(
    body: Complex, regions: Sequence[Solid | HalfSpace], tolerance: float
) -> Complex:
    """Return a complex cut along region boundaries, each cell with the last region that contains
    it. `taken_out` later merges the cuts that the face planes leave in the surrounding rock."""
    for k in reversed(range(len(regions))):
        one = regions[k]
        if isinstance(one, Solid):
            for face, normal in one.faces():
                passed = _cells_crossed(body, body.region == ROCK, face, normal, tolerance)
                body = cut(body, one_plane(normal, face[0] @ normal, passed), tolerance).body
        else:
            plane = one_plane(one.normal, one.through @ one.normal, body.region == ROCK)
            body = cut(body, plane, tolerance).body
        inside = one.contains(body.centres()) & (body.region == ROCK)
        body = replace(body, region=np.where(inside, k, body.region))
    return body


def taken_out(body: Complex, solids: Sequence[tuple[Solid, int]], tolerance: float) -> Complex:
    """Return a complex without some solids, each given with the side number of its faces. Blocks
    are cut along the face planes; parts of one rock are merged again as far as they stay convex."""
    whole = np.arange(body.count)  # the original block of each cell
    for solid, side in solids:
        near = _cells_near(body, body.halves(), solid.points(), tolerance)
        for face, normal in solid.faces():
            passed = _cells_crossed(body, near, face, normal, tolerance)
            split = near & np.isin(whole, whole[passed])  # all cells of the block are cut
            found = cut(body, one_plane(normal, face[0] @ normal, split), tolerance)
            body, near, whole = found.body, near[found.parent], whole[found.parent]
        gone = np.zeros(body.count, bool)
        at = np.flatnonzero(near)
        gone[at] = solid.contains(body.centres(body.beside(near))[at])
        body = body.removed(gone, side)
    whole_again: Complex | None = body
    while whole_again is not None:  # thinnest piece first, across its largest face
        body, cuts = whole_again, _through_rock(whole_again)
        pieces = Pieces(body, np.isin(np.arange(body.count), body.sides[cuts]), cuts)
        order = sorted(pieces.thickness, key=lambda cell: (pieces.thickness[cell], cell))
        whole_again = pieces.joined(order, tolerance)[0]
    return body


def check_convex(body: Complex, solids: Sequence[tuple[Solid, int]]) -> None:
    """Raise GeometryError if a block had to be cut through intact rock at an opening."""
    cuts = np.flatnonzero(_through_rock(body))
    if not len(cuts):
        return
    at = body.vertices[body.vertices_of(np.array([[0, cuts[0]]]))[:, 1]]
    if solids:
        corners = np.concatenate([solid.points() for solid, _ in solids])
        away = np.linalg.norm(at[:, None] - corners, axis=2).min(axis=0)
        at = corners[[np.argmin(away)]]
    raise GeometryError(
        at.mean(axis=0),
        "a block is not convex at an opening, a region or a corner of the outline; "
        'set domain.non_convex = "cut" to cut it into convex parts',
    )


def _cells_near(body: Complex, half: Halves, corners: np.ndarray, tolerance: float) -> np.ndarray:
    """Return which cells' bounding boxes meet that of some points [n, d], bool array [count]."""
    low, high = body.extents(half, body.vertices)
    meets = (low <= corners.max(axis=0) + tolerance) & (high >= corners.min(axis=0) - tolerance)
    return meets.all(axis=1)


def _cells_crossed(
    body: Complex, cells: np.ndarray, face: np.ndarray, normal: np.ndarray, tolerance: float
) -> np.ndarray:
    """Return which of some cells (bool array [count]) a convex face, float array [n, d], passes
    through by more than the tolerance (m)."""
    half = body.beside(cells)
    low, high = body.extents(half, (body.vertices - face[0]) @ normal)
    crossed = (low < -tolerance) & (high > tolerance) & _cells_near(body, half, face, tolerance)
    half, found = body.beside(crossed), np.zeros(body.count, bool)
    place = body.places(half)
    for own in groups(half.cell):
        part = face
        for k in own:
            if len(part):
                part = clipped(part, place[k] - tolerance - part @ half.outward[k])
        if len(part) and np.ptp(part, axis=0).max() > tolerance:
            found[half.cell[own]] = True
    return found


def _through_rock(body: Complex) -> np.ndarray:
    """Return which facets are cuts through the rock of one region, bool array [f]."""
    return body.in_rock & (body.joint_set == NO_SET)
