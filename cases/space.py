"""A rock mass in space: the box of its domain, its openings and joints, and its blocks."""

from dataclasses import dataclass, replace
from itertools import combinations
from math import prod

import numpy as np
import shapely

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import Blocks, blocks_of
from jointwave.cases.geometry.cell_complex import Complex, GeometryError, box
from jointwave.cases.geometry.sets import PlaneSet, cut_by_sets
from jointwave.cases.geometry.slivers import Limits, without_slivers
from jointwave.cases.geometry.solids import (
    HalfSpace,
    Solid,
    check_convex,
    cut_into_regions,
    prism,
    taken_out,
)
from jointwave.cases.partition.joints import direction_of, plane_sets
from jointwave.cases.partition.outline import TOLERANCE
from jointwave.cases.partition.scene import least_width
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.size import require

SIDES = ("left", "right", "front", "back", "bottom", "top")  #: two for each axis
#: Bytes of memory for each block while a box is cut.
OF_BLOCK = 30_000


@dataclass(frozen=True)
class Box:
    """The domain of a scene in space: its upper corner [3], m, and its openings."""

    high: np.ndarray
    solids: list[Solid]

    @property
    def size(self) -> float:
        """The diagonal, m."""
        return float(np.linalg.norm(self.high))

    @property
    def tolerance(self) -> float:
        """Length below which points are one point, m."""
        return TOLERANCE * self.size

    def normals(self) -> dict[str, np.ndarray]:
        """Return the unit normals [1, 3] out of the sides."""
        return {side: (2 * (k % 2) - 1.0) * np.eye(3)[[k // 2]] for k, side in enumerate(SIDES)}

    def holds(self, point: list[float]) -> bool:
        """Return whether a point lies in the domain or on its boundary, and in no opening."""
        inside = np.abs(np.array(point) - self.high / 2) <= self.high / 2 + self.tolerance
        return bool(inside.all()) and not any(
            one.contains(np.array([point]))[0] for one in self.solids
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
    domain.solids.append(solid)


def attitude(dip: float, dip_direction: float | None) -> tuple[np.ndarray, np.ndarray]:
    """Return the normal [3] of a plane, which points up, and the horizontal along its strike and
    the line of dip in it [2, 3], by its dip and dip direction, degrees."""
    (down, up), turn = direction_of(dip), (dip_direction or 0.0) % 360
    north, east = direction_of(turn - 360 if turn > 180 else turn)
    normal = np.array([up * east, up * north, down])
    return normal, np.array([[north, -east, 0.0], [down * east, down * north, -up]])


def joint_planes(scene: RockMass) -> list[PlaneSet]:
    """Return the planes of the joint sets of a scene in space."""
    found = []
    for one, planes in zip(
        scene.joint_sets, plane_sets(scene.joint_sets, scene.regions), strict=True
    ):
        normal, along = attitude(one.dip, one.dip_direction)
        through = np.array(one.through or [0.0, 0.0, 0.0])
        found.append(replace(planes, normal=normal, along=along, through=through))
    return found


def uncut(scene: RockMass, outline: Box) -> Complex:
    """Return the box of a scene in cells of one region of rock each."""
    regions = [
        HalfSpace(attitude(one.dip, one.dip_direction)[0], np.array(one.through))
        for one in scene.regions
    ]
    return cut_into_regions(box(np.zeros(3), outline.high), regions, outline.tolerance)


def block_count(high: np.ndarray, sets: list[PlaneSet]) -> float:
    """Return about how many blocks a box is cut into, as one without ends of joints."""
    planes = [
        float(np.abs(high * one.normal).sum()) / one.spacing if one.spacing else 1.0 for one in sets
    ]
    return 1 + sum(
        prod(planes[k] for k in some) * float(np.sqrt(max(np.linalg.det(n @ n.T), 0.0)))
        for count in (1, 2, 3)
        for some in combinations(range(len(sets)), count)
        for n in [np.array([sets[k].normal for k in some])]
    )


def blocks_in_space(scene: RockMass) -> Blocks:
    """Return the blocks of a rock mass in space; `side` of their boundary is an index in SIDES, or
    of opening k, of the boxes and then the prisms, their number and k.

    Raises SceneError, in one line with place and cause, where it cannot be cut into convex blocks,
    or they would take more memory than a run may.
    """
    domain, sets = scene.domain, joint_planes(scene)
    try:
        outline = box_of(domain)
        require(OF_BLOCK * block_count(outline.high, sets), "the blocks")
        body = cut_by_sets(uncut(scene, outline), sets, outline.tolerance)
        solids = [(one, 1 + k) for k, one in enumerate(outline.solids)]
        body = taken_out(body, solids, outline.tolerance)
        if domain.non_convex == "refuse":
            check_convex(body, solids)
        limits = Limits(least_width(domain, scene.joint_sets), domain.least_angle)
        body = without_slivers(body, limits, domain.slivers == "merge", outline.tolerance)
        found = blocks_of(body, outline.tolerance)
    except (GeometryError, MemoryError) as error:
        raise SceneError(
            scene.where, getattr(error, "key", "joint_sets"), None, str(error)
        ) from None
    axis = np.abs(found.boundary.normal).argmax(axis=1)
    outer = 2 * axis + (np.take_along_axis(found.boundary.normal, axis[:, None], 1)[:, 0] > 0)
    side = np.where(found.boundary.side == 0, outer, len(SIDES) - 1 + found.boundary.side)
    return replace(found, boundary=replace(found.boundary, side=side))
