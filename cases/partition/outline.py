"""The domain's shape: its convex hull, and the polygons excluded from it."""

from dataclasses import dataclass

import numpy as np
import shapely

from jointwave.cases.geometry.blocks import Facets
from jointwave.cases.geometry.cell_complex import Complex, GeometryError, polygon
from jointwave.cases.geometry.solids import Solid, corners_of, polygon_solid
from jointwave.cases.schema.domain import Domain

SIDES = ("left", "right", "bottom", "top", "outline")

#: Lengths over the size of the domain: below it points are one point.
TOLERANCE = 1e-9


@dataclass(frozen=True)
class Outline:
    """A domain as polygons.

    Attributes
    ----------
    corners : float array [m, 2], of the domain with its openings, counter-clockwise, m.
    hull : float array [n, 2], convex, counter-clockwise, m.
    taken : what is taken out of the hull: polygons, each float array [k, 2], with the side that its
        edges become: 0 for a bay of the outline, 1 + k for opening k.
    shape : the shapely polygon of the domain less its openings.
    tolerance : m.
    """

    corners: np.ndarray
    hull: np.ndarray
    taken: list[tuple[np.ndarray, int]]
    shape: shapely.Geometry
    tolerance: float

    def along(self, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Return the index in SIDES of edges of the outer boundary from `start` to `end`, float
        arrays [n, 2], m: along the left, right, bottom or top of the domain, or elsewhere."""
        low, high = self.corners.min(axis=0), self.corners.max(axis=0)
        side = np.full(len(start), SIDES.index("outline"))
        for k, (axis, place) in enumerate([(0, low), (0, high), (1, low), (1, high)]):
            off = np.maximum(
                np.abs(start[:, axis] - place[axis]), np.abs(end[:, axis] - place[axis])
            )
            side[off <= self.tolerance] = k
        return side

    @property
    def sides(self) -> tuple[str, ...]:
        """Names of the sides, those of openings last."""
        openings = sum(side > 0 for _, side in self.taken)
        return (*SIDES, *(f"opening {k}" for k in range(openings)))

    @property
    def solids(self) -> list[tuple[Solid, int]]:
        """What is taken out of the hull, with the side that its edges become."""
        return [(polygon_solid(corners), side) for corners, side in self.taken]

    @property
    def volume(self) -> float:
        """Area, openings included, m2."""
        return float(shapely.Polygon(self.corners).area)

    def whole(self) -> Complex:
        """Return the hull as one cell."""
        return polygon(self.hull)

    def sides_of(self, facets: Facets) -> np.ndarray:
        """Return the index in `sides` of facets of the outer boundary and of openings."""
        ends = facets.outlines.corners.reshape(-1, 2, 2)
        outer = self.along(ends[:, 0], ends[:, 1])
        return np.where(facets.side == 0, outer, len(SIDES) - 1 + facets.side)

    @property
    def size(self) -> float:
        """Diagonal of the bounding box, m."""
        return float(np.hypot(*np.ptp(self.corners, axis=0)))

    def edges(self, side: str | None = None, opening: int | None = None) -> np.ndarray:
        """Return the edges of a side, or of an opening, from point to point [n, 2, 2], m."""
        if opening is not None:
            corners = next(corners for corners, k in self.taken if k == 1 + opening)
            return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)
        start, end = self.corners, np.roll(self.corners, -1, axis=0)
        chosen = self.along(start, end) == SIDES.index(side or "outline")
        return np.stack([start, end], axis=1)[chosen]

    def normals(self) -> dict[str, np.ndarray]:
        """Return the unit normals [n, 2] out of the edges of each side that there is."""
        found = {}
        for side in SIDES:
            along = np.diff(self.edges(side), axis=1)[:, 0]
            if len(along):
                outward = np.stack([along[:, 1], -along[:, 0]], axis=1)
                found[side] = outward / np.hypot(*along.T)[:, None]
        return found

    def holds(self, point: list[float]) -> bool:
        """Return whether a point lies in the domain or on its boundary, and in no opening."""
        return bool(shapely.dwithin(self.shape, shapely.Point(point), self.tolerance))


def outline_of(domain: Domain) -> Outline:
    """Return the shape of a domain; raises GeometryError if it is invalid."""
    whole = _polygon(domain.corners, "domain.outline")
    openings = [
        _polygon(opening, f"domain.openings[{k}]") for k, opening in enumerate(domain.holes)
    ]
    _check_openings(whole, openings)
    hull = whole.convex_hull
    size = float(np.hypot(*np.ptp(shapely.get_coordinates(hull), axis=0)))
    bays = [] if hull.equals(whole) else _parts(hull.difference(whole))
    bays = [
        bay for bay in bays if bay.area > TOLERANCE * size**2
    ]  # no round-off of a straight side
    return Outline(
        corners=corners_of(whole),
        hull=corners_of(hull),
        taken=[
            *((corners_of(bay), 0) for bay in bays),
            *((corners_of(opening), 1 + k) for k, opening in enumerate(openings)),
        ],
        shape=whole.difference(shapely.union_all(openings)) if openings else whole,
        tolerance=TOLERANCE * size,
    )


def _polygon(corners: list[list[float]], key: str) -> shapely.Polygon:
    polygon = shapely.Polygon(corners) if len(corners) > 2 else shapely.Polygon()
    if not polygon.is_valid or not polygon.area > 0:
        why = "it has no area" if polygon.is_valid else shapely.is_valid_reason(polygon)
        raise GeometryError(None, f"must be a polygon that does not cross itself ({why})", key)
    return polygon


def _check_openings(whole: shapely.Polygon, openings: list[shapely.Polygon]) -> None:
    for k, opening in enumerate(openings):
        key, at = f"domain.openings[{k}]", np.array(opening.centroid.coords[0])
        if not whole.covers(opening):
            raise GeometryError(at, "must lie in the domain", key)
        if opening.equals(whole):
            raise GeometryError(at, "must leave rock", key)
        for i, other in enumerate(openings[:k]):
            if opening.intersection(other).area > TOLERANCE * opening.area:
                raise GeometryError(at, f"must not overlap openings[{i}]", key)


def _parts(shape: shapely.Geometry) -> list[shapely.Polygon]:
    parts = getattr(shape, "geoms", [shape])
    return [part for part in parts if isinstance(part, shapely.Polygon) and part.area > 0]
