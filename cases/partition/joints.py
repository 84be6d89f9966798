"""A scene's joint sets as sets of planes, and its regions of rock."""

from collections.abc import Sequence
from math import atan2, degrees, hypot

import numpy as np
import shapely

from jointwave.cases.geometry.sets import PlaneSet
from jointwave.cases.geometry.solids import ROCK, HalfSpace, Solid, polygon_solid
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import REST, IntactRock, Region, RockMass

#: Attributes that a plane set copies from its joint set.
SAME = ("name", "normal", "spacing", "offset", "scatter", "seed")


def dips_of(normal: np.ndarray) -> dict[str, float]:
    """Return the dip, degrees, and in space the dip direction, of planes with a unit normal [d]."""
    *across, up = np.array(normal) + 0.0  # no -0
    if len(across) == 1:
        return {"dip": round((degrees(atan2(-across[0], up)) + 90) % 180 - 90, 12)}
    east, north = across if up >= 0 else (-across[0], -across[1])
    dip, towards = atan2(hypot(east, north), abs(up)), atan2(east, north)
    return {"dip": round(degrees(dip), 12), "dip_direction": round(degrees(towards) % 360, 12)}


def plane_sets(sets: Sequence[JointSet], regions: Sequence[Region] = ()) -> list[PlaneSet]:
    """Return the plane sets of joint sets in a domain with regions of rock."""
    numbers = {REST: -1, **{one.name: k for k, one in enumerate(regions)}}
    found = []
    for one in sets:
        own = tuple(numbers[name] for name in one.regions) or None
        same = {key: getattr(one, key) for key in SAME} | {"ends_at": tuple(one.ends_at)}
        found.append(PlaneSet(along=one.frame[1:], through=one.origin, regions=own, **same))
    return found


def region_at(regions: Sequence[Region], places: np.ndarray) -> np.ndarray:
    """Return the last region that contains each place (float array [n, d], m), or ROCK."""
    found = np.full(len(places), ROCK)
    for k, one in enumerate(bounded(regions)):
        found[one.contains(places)] = k
    return found


def rocks_of(scene: RockMass) -> list[IntactRock]:
    """Return the rock of each region, then the rock outside all regions."""
    return [*(one.rock(scene.rock) for one in scene.regions), scene.rock]


def rocks_beside(scene: RockMass, one: JointSet) -> list[IntactRock]:
    """Return the rocks that a joint set cuts."""
    return [each.rock for each in within(scene, [one]) if each.joint_sets]


def within(scene: RockMass, sets: Sequence[JointSet]) -> list[RockMass]:
    """Return each region, then the rest, as a one-rock scene with its joint sets, not validated."""
    names = [*(one.name for one in scene.regions), REST]
    return [
        scene.model_copy(
            update={
                "rock": rock,
                "regions": [],
                "joint_sets": [one for one in sets if not one.regions or name in one.regions],
            }
        )
        for name, rock in zip(names, rocks_of(scene), strict=True)
    ]


def strata(regions: Sequence[Region]) -> list[Region]:
    """Return the regions that are bounded by a line."""
    return [one for one in regions if one.outline is None]


def bounded(regions: Sequence[Region]) -> list[Solid | HalfSpace]:
    """Return the boundary of each region."""
    return [
        HalfSpace(one.normal, np.array(one.through))
        if one.outline is None
        else polygon_solid(shapely.Polygon(one.outline))
        for one in regions
    ]
