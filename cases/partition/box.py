"""The domain of a scene in space: a box, and the boxes and prisms excavated from it."""

from dataclasses import dataclass

import numpy as np
import shapely

from jointwave.cases.geometry.blocks import Facets
from jointwave.cases.geometry.cell_complex import Complex, GeometryError, box
from jointwave.cases.geometry.solids import Solid, prism
from jointwave.cases.partition.outline import TOLERANCE
from jointwave.cases.schema.domain import Domain

SIDES = ("left", "right", "front", "back", "bottom", "top")  #: two for each axis


@dataclass(frozen=True)
class Box:
    """The domain of a scene in space: its upper corner [3], m, and its openings with the number of
    the side that each makes."""

    high: np.ndarray
    solids: list[tuple[Solid, int]]

    @property
    def size(self) -> float:
        """The diagonal, m."""
        return float(np.linalg.norm(self.high))

    @property
    def tolerance(self) -> float:
        """Length below which points are one point, m."""
        return TOLERANCE * self.size

    @property
    def sides(self) -> tuple[str, ...]:
        """Names of the sides, those of openings last."""
        return (*SIDES, *(f"opening {k}" for k in range(len(self.solids))))

    @property
    def volume(self) -> float:
        """Volume, openings included, m3."""
        return float(np.prod(self.high))

    def whole(self) -> Complex:
        """Return the domain without its openings as one cell."""
        return box(np.zeros(3), self.high)

    def sides_of(self, facets: Facets) -> np.ndarray:
        """Return the index in `sides` of facets of the outer boundary and of openings."""
        axis = np.abs(facets.normal).argmax(axis=1)
        outer = 2 * axis + (facets.normal[np.arange(len(axis)), axis] > 0)
        return np.where(facets.side == 0, outer, len(SIDES) - 1 + facets.side)

    def normals(self) -> dict[str, np.ndarray]:
        """Return the unit normals [1, 3] out of the sides."""
        return {side: (2 * (k % 2) - 1.0) * np.eye(3)[[k // 2]] for k, side in enumerate(SIDES)}

    def holds(self, point: list[float]) -> bool:
        """Return whether a point lies in the domain or on its boundary, and in no opening."""
        inside = np.abs(np.array(point) - self.high / 2) <= self.high / 2 + self.tolerance
        return bool(inside.all()) and not any(
            one.contains(np.array([point]))[0] for one, _ in self.solids
        )


def box_of(domain: Domain) -> Box:
    """Return the box of a domain; raises GeometryError for an opening that is none or outside."""
    high = np.array(domain.size)
    found = Box(high, [])
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
    outside = np.abs(corners - domain.high / 2) > domain.high / 2 + domain.tolerance
    if outside.any():
        raise GeometryError(corners[outside.any(axis=1)][0], "must lie in the domain", key)
    domain.solids.append((solid, 1 + len(domain.solids)))
