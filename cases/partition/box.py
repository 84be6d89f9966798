"""The domain of a scene in space: a box less boxes and prisms, or the blocks of a file."""

from dataclasses import dataclass

import numpy as np
import shapely

from jointwave.cases.geometry.blocks import Facets
from jointwave.cases.geometry.cell_complex import Complex, GeometryError, box
from jointwave.cases.geometry.solids import Solid, prism
from jointwave.cases.partition.outline import TOLERANCE
from jointwave.cases.schema.domain import Domain

#: Two for each axis, and what lies on none of them.
SIDES = ("left", "right", "front", "back", "bottom", "top", "outline")
SAME = 1e-6  #: of the size: what the blocks of a file may lie beside a side


@dataclass(frozen=True)
class Box:
    """The domain of a scene in space.

    Attributes
    ----------
    low, high : corners of the box around it, float arrays [3], m.
    solids : openings, with the number of the side that each makes.
    given : the blocks of a file, if these are the domain.
    """

    low: np.ndarray
    high: np.ndarray
    solids: list[tuple[Solid, int]]
    given: Complex | None = None

    @property
    def size(self) -> float:
        """The diagonal, m."""
        return float(np.linalg.norm(self.high - self.low))

    @property
    def tolerance(self) -> float:
        """Length below which points are one point, m."""
        return (TOLERANCE if self.given is None else SAME) * self.size

    @property
    def sides(self) -> tuple[str, ...]:
        """Names of the sides, those of openings last."""
        openings = len(self.solids) if self.given is None else self.given.side.max()
        return (*SIDES, *(f"opening {k}" for k in range(openings)))

    @property
    def volume(self) -> float:
        """Volume, openings included, m3."""
        return float(np.prod(self.high - self.low))

    def whole(self) -> Complex:
        """Return the domain without its openings as one cell."""
        return box(self.low, self.high)

    def sides_of(self, facets: Facets) -> np.ndarray:
        """Return the index in `sides` of facets of the outer boundary and of openings."""
        return np.where(
            facets.side == 0, self._along(*facets.outlines), len(SIDES) - 1 + facets.side
        )

    def _along(self, corners: np.ndarray, first: np.ndarray) -> np.ndarray:
        """Return the index in SIDES of pieces of the outer boundary, as those of `Outlines`."""
        found = np.full(len(first) - 1, SIDES.index("outline"))
        for k, place in enumerate(np.stack([self.low, self.high], axis=1).ravel()):
            off = np.maximum.reduceat(np.abs(corners[:, k // 2] - place), first[:-1])
            found[off <= self.tolerance] = k
        return found

    def normals(self) -> dict[str, np.ndarray]:
        """Return the unit normals [n, 3] out of each side that there is."""
        if self.given is None:
            return {
                one: (2 * (k % 2) - 1.0) * np.eye(3)[[k // 2]] for k, one in enumerate(SIDES[:6])
            }
        half = self.given.halves(~self.given.inner & (self.given.side == 0))
        number = np.arange(len(half.facet))
        facet, vertex = self.given.vertices_of(np.stack([number, half.facet], axis=1)).T
        first = np.searchsorted(facet, np.arange(len(number) + 1))
        side = self._along(self.given.vertices[vertex], first)
        found = {one: half.outward[side == k] for k, one in enumerate(SIDES)}
        return {one: np.unique(normals, axis=0) for one, normals in found.items() if len(normals)}

    def holds(self, point: list[float]) -> bool:
        """Return whether a point lies in the domain or on its boundary, and in no opening."""
        place = np.array(point)
        if self.given is not None:
            return bool(self.given.depths(place).max() >= -self.tolerance)
        inside = (place >= self.low - self.tolerance) & (place <= self.high + self.tolerance)
        return bool(inside.all()) and not any(
            one.contains(place[None])[0] for one, _ in self.solids
        )


def box_of(domain: Domain) -> Box:
    """Return the box of a domain; raises GeometryError for an opening that is none or outside."""
    low, high = (at(domain.corners, axis=0) for at in (np.min, np.max))
    found = Box(low, high, [], domain.given)
    if found.given is not None:
        return found
    for k, corners in enumerate(domain.openings):
        key = f"domain.openings[{k}]"
        if len(corners) != 2 or not np.ptp(corners, axis=0).all():
            raise GeometryError(None, "must be two opposite corners of a box", key)
        (x, y, z), (far_x, far_y, far_z) = np.sort(corners, axis=0)
        base = np.array([[x, y], [far_x, y], [far_x, far_y], [x, far_y]])
        _add(found, prism(base, 2, (z, far_z)), key)
    for k, one in enumerate(domain.prisms):
        axis, key = "xyz".index(one.axis), f"domain.prisms[{k}]"
        polygon = shapely.Polygon(one.polygon)
        if not (polygon.is_valid and polygon.area > 0):
            raise GeometryError(
                None, "must be a polygon that does not cross itself", f"{key}.polygon"
            )
        low, top = one.ends or (0.0, high[axis])
        if not low < top:
            raise GeometryError(None, "must be two increasing numbers", f"{key}.ends")
        cyclic = np.array(one.polygon)[:, ::-1] if one.axis == "y" else np.array(one.polygon)
        _add(found, prism(cyclic, axis, (low, top)), key)
    return found


def _add(domain: Box, solid: Solid, key: str) -> None:
    corners = np.concatenate([corners for corners, _ in solid.faces()])
    outside = (corners < domain.low - domain.tolerance) | (corners > domain.high + domain.tolerance)
    if outside.any():
        raise GeometryError(corners[outside.any(axis=1)][0], "must lie in the domain", key)
    domain.solids.append((solid, 1 + len(domain.solids)))
