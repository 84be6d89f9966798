"""The shape of a scene's domain: outer boundary, openings and bays, and loaded boundary parts."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import shapely

from jointwave.cases.geometry.cell_complex import Complex, GeometryError, box, polygon
from jointwave.cases.geometry.locate import distance_from
from jointwave.cases.geometry.measure import Outlines, cell_moments, outlines, outlines_of
from jointwave.cases.geometry.solids import (
    ROCK,
    Solid,
    corners_of,
    cut_into_regions,
    polygon_solid,
    prism,
)
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.pulse import PlaneLoad

#: Sides by the number of dimensions: two for each axis, and the rest of the outline.
SIDES = {
    2: ("left", "right", "bottom", "top", "outline"),
    3: ("left", "right", "front", "back", "bottom", "top", "outline"),
}
TOLERANCE = 1e-9  #: tolerance over the domain's size: nearer points coincide
SAME = 1e-6  #: the same for the blocks of a file in space
BESIDE = 1e-6  #: tolerated distance of points and edges from the boundary, over the size


Face = tuple[np.ndarray, np.ndarray]  #: corners [k, d], m, and outward unit normal [d]


@dataclass(frozen=True)
class Shape:
    """A domain in the plane or in space.

    hull : its convex hull in the plane, its bounding box in space, as one cell.
    faces : of its outer boundary; in the plane edges, counter-clockwise.
    solids : removed from the hull, with the side number of their faces: 0 for a bay of the outline,
        1 + k for opening k.
    tolerance : distance below which points coincide, m.
    given : the blocks of a file in space, if these are the domain.
    """

    hull: Complex
    faces: list[Face]
    solids: list[tuple[Solid, int]]
    tolerance: float
    given: Complex | None = None

    @property
    def low(self) -> np.ndarray:
        """Lower corner of the bounding box [d], m."""
        return self.hull.vertices.min(axis=0)

    @property
    def high(self) -> np.ndarray:
        """Upper corner of the bounding box [d], m."""
        return self.hull.vertices.max(axis=0)

    @property
    def size(self) -> float:
        """Diagonal of the bounding box, m."""
        return float(np.linalg.norm(self.high - self.low))

    @property
    def sides(self) -> tuple[str, ...]:
        """Names of the sides, openings last."""
        numbers = self.given.side if self.given is not None else [side for _, side in self.solids]
        return (*SIDES[self.hull.dim], *(f"opening {k}" for k in range(max(numbers, default=0))))

    def sides_of(self, facets: Outlines, side: np.ndarray) -> np.ndarray:
        """Return the index in `sides` of boundary facets; side : 0 outer, 1 + k opening k."""
        return np.where(side == 0, self._along(facets), len(SIDES[self.hull.dim]) - 1 + side)

    def _along(self, pieces: Outlines) -> np.ndarray:
        """Return the index in `sides` of pieces of the outer boundary."""
        (corners, first), found = pieces, np.full(len(pieces.first) - 1, 2 * self.hull.dim)
        for k, place in enumerate(np.stack([self.low, self.high], axis=1).ravel()):
            off = np.maximum.reduceat(np.abs(corners[:, k // 2] - place), first[:-1])
            found[off <= self.tolerance] = k
        return found

    def faces_of(self, side: str | None = None, opening: int | None = None) -> list[Face]:
        """Return the faces of a side, or of an opening."""
        if opening is not None and self.given is not None:
            return _faces(self.given, 1 + opening, self.tolerance)
        if opening is not None:
            return next(solid.faces() for solid, k in self.solids if k == 1 + opening)
        along = self._along(outlines_of([corners for corners, _ in self.faces]))
        index = SIDES[self.hull.dim].index(side or "outline")
        return [self.faces[k] for k in np.flatnonzero(along == index)]

    def edges(self, side: str | None = None, opening: int | None = None) -> np.ndarray:
        """Return the edges of a side or an opening in the plane [n, 2, 2], m, from end to end."""
        found = [corners for corners, _ in self.faces_of(side, opening)]
        return np.array(found).reshape(-1, 2, 2)

    def normals(self) -> dict[str, np.ndarray]:
        """Return the outward unit normals [n, d] of the faces of each existing side."""
        found = {side: self.faces_of(side) for side in SIDES[self.hull.dim]}
        return {side: np.array([n for _, n in faces]) for side, faces in found.items() if faces}

    def holds(self, point: list[float]) -> bool:
        """Return whether a point lies in the domain or on its boundary, and in no opening."""
        place, body = np.array(point), self.hull if self.given is None else self.given
        return bool(body.depths(place).max() >= -self.tolerance) and not any(
            solid.contains(place[None])[0] and distance(place, solid.faces()) > self.tolerance
            for solid, _ in self.solids
        )


def shape_of(domain: Domain) -> Shape:
    """Return the shape of a domain; raises GeometryError if it is invalid."""
    if domain.dimension == 3:
        low, high = (at(domain.corners, axis=0) for at in (np.min, np.max))
        hull, outer, bays = box(low, high), _box(low, high), list[Solid]()
    else:
        whole = _polygon(domain.corners, "domain.outline")
        hull, outer = polygon(corners_of(whole.convex_hull)), polygon_solid(whole)
        left = whole.convex_hull - whole
        least = TOLERANCE * np.hypot(*np.ptp(np.reshape(left.bounds, (2, 2)), axis=0)) ** 2
        parts = (one for one in shapely.get_parts(left) if one.area > least)  # beyond round-off
        bays = [polygon_solid(one) for one in parts]
    found = Shape(hull, outer.faces(), [(bay, 0) for bay in bays], 0.0)
    found = replace(found, tolerance=TOLERANCE * found.size)
    if domain.given is not None and domain.dimension == 3:
        tolerance = SAME * found.size
        faces = _faces(domain.given, 0, tolerance)
        return replace(found, faces=faces, tolerance=tolerance, given=domain.given)
    names = ["domain"] * len(bays)
    for number, (key, solid) in enumerate(_openings(domain)):
        _check_opening(found, solid, key, names)
        found.solids.append((solid, 1 + number))
        names.append(key)
    return found


def distance(point: np.ndarray, faces: list[Face]) -> float:
    """Return the distance of a point [d] from the nearest of some faces, m."""
    return min(distance_from(*face, point) for face in faces)


def _faces(body: Complex, side: int, tolerance: float) -> list[Face]:
    """Return the boundary faces with a given side number."""
    half = body.halves(~body.inner & (body.side == side))
    found = outlines(body, half.facet, np.arange(len(half.facet)), half.outward, tolerance)
    return [(found.of(k), normal) for k, normal in enumerate(half.outward)]


def _box(low: np.ndarray, high: np.ndarray) -> Solid:
    """Return a box in space from two opposite corners [3], m."""
    return prism(shapely.get_coordinates(shapely.box(*low[:2], *high[:2])), 2, (low[2], high[2]))


def _openings(domain: Domain) -> Iterator[tuple[str, Solid]]:
    """Yield the openings of a domain, each with its key."""
    in_space = domain.dimension == 3
    for k, corners in enumerate(domain.openings if in_space else domain.holes):
        key = f"domain.openings[{k}]"
        if not in_space:
            yield key, polygon_solid(_polygon(corners, key))
        elif len(corners) != 2 or not np.ptp(corners, axis=0).all():
            raise GeometryError(None, "must be two opposite corners of a box", key)
        else:
            yield key, _box(*np.sort(corners, axis=0))
    for k, one in enumerate(domain.prisms):
        axis, key = "xyz".index(one.axis), f"domain.prisms[{k}]"
        low, top = one.ends or np.array(domain.corners)[[0, -1], axis]
        corners = np.array(_polygon(one.polygon, f"{key}.polygon").exterior.coords[:-1])
        yield key, prism(corners[:, ::-1] if one.axis == "y" else corners, axis, (low, top))


def _polygon(corners: list[list[float]], key: str) -> shapely.Polygon:
    polygon = shapely.Polygon(corners) if len(corners) > 2 else shapely.Polygon()
    if not polygon.is_valid or not polygon.area > 0:
        why = "it has no area" if polygon.is_valid else shapely.is_valid_reason(polygon)
        raise GeometryError(None, f"must be a polygon that does not cross itself ({why})", key)
    return polygon


def _check_opening(shape: Shape, solid: Solid, key: str, names: list[str]) -> None:
    """Raise GeometryError for an opening that leaves the domain, overlaps another or leaves no
    rock; names : keys of the solids removed so far."""
    corners = solid.points()
    outside = np.array([shape.hull.depths(one).max() for one in corners]) < -shape.tolerance
    if outside.any():
        raise GeometryError(corners[outside][0], "must lie in the domain", key)
    for (other, side), name in zip(shape.solids, names, strict=True):
        both = corners, other.points()
        low, high = ([at(one, axis=0) for one in both] for at in (np.min, np.max))
        if (np.maximum(*low) >= np.minimum(*high) - shape.tolerance).any():
            continue
        body = cut_into_regions(shape.hull, [solid], shape.tolerance)
        body = body.removed(body.region == ROCK, 0)
        body = replace(body, region=np.full(body.count, ROCK))
        m = cell_moments(body := cut_into_regions(body, [other], shape.tolerance))
        size = np.where(body.region == ROCK, 0.0, m.size)
        if size.sum() > TOLERANCE * min(solid.volume, other.volume):
            what = f"not overlap {name.removeprefix('domain.')}" if side else "lie in the domain"
            raise GeometryError(m.centroid[size.argmax()], f"must {what}", key)
    left = cell_moments(shape.hull).size[0] - sum(
        one.volume for one in (solid, *(one for one, _ in shape.solids))
    )
    if left <= TOLERANCE * shape.size**shape.hull.dim:
        raise GeometryError(corners.mean(axis=0), "must leave rock", key)


def covered(domain: Domain, load: PlaneLoad, ends: np.ndarray) -> np.ndarray:
    """Return the part of each edge of a side or opening that a load between two points acts on, [n,
    2]: start and end over the edge's length, both 0 off the load. ends : float array [n, 2, 2],
    m."""
    outline = shape_of(domain)
    part, tolerance = np.zeros((len(ends), 2)), BESIDE * outline.size
    for start, end in loaded_lines(outline, load):
        length = float(np.hypot(*(end - start)))
        if length <= tolerance:
            continue
        along = (end - start) / length
        s, off = (ends - start) @ along, np.abs((ends - start) @ [-along[1], along[0]])
        low, high = np.maximum(s.min(axis=1), 0.0), np.minimum(s.max(axis=1), length)
        meets = (off.max(axis=1) <= tolerance) & (high - low > tolerance)
        place = (np.stack([low, high], axis=1) - s[:, :1])[meets] / np.diff(s, axis=1)[meets]
        part[meets] = np.sort(place, axis=1)
    return part


def loaded_lines(outline: Shape, load: PlaneLoad) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return the straight boundary parts, as pairs of points, between the two points of a load: the
    segment between them on one face; from one to the other along an open side; else, as around an
    opening, from the first to the second counter-clockwise."""
    lines, between = outline.edges(load.side, load.opening), np.array(load.between)
    if (_distances(lines, between) <= BESIDE * outline.size).all(axis=0).any():
        return [(between[0], between[1])]
    gaps = np.flatnonzero((lines[:, 0] != np.roll(lines[:, 1], 1, axis=0)).any(axis=1))
    if gaps.size:
        lines = np.roll(lines, -gaps[0], axis=0)
    i, j = _distances(lines, between).argmin(axis=1)
    if gaps.size and j < i:
        i, j, between = j, i, between[::-1]
    found = lines[np.arange(i, j + 1 + (len(lines) if j < i else 0)) % len(lines)]
    found[0, 0], found[-1, 1] = between
    return [(start, end) for start, end in found]


def _distances(lines: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the distances of points [m, 2] from lines, [m, n], m."""
    found = shapely.distance(shapely.linestrings(lines), shapely.points(points)[:, None])
    return np.asarray(found)
