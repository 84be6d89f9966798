"""Joint sets of a scene as sets of planes, its regions of rock, and the attitude of planes."""

from collections.abc import Sequence
from math import atan2, cos, degrees, hypot, radians, sin

import numpy as np
import shapely

from jointwave.cases.geometry.sets import PlaneSet
from jointwave.cases.geometry.solids import ROCK, HalfSpace, Solid, corners_of, polygon_solid
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import REST, IntactRock, Region, RockMass

#: Cosine and sine of dips, degrees, that are exact.
EXACT = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0)}


def direction_of(dip: float) -> np.ndarray:
    """Return the unit vector [2] along joints of this dip, degrees from the horizontal."""
    exact = EXACT.get(abs(dip), (cos(radians(dip)), sin(radians(abs(dip)))))
    return np.array([exact[0], exact[1] if dip >= 0 else -exact[1]])


def attitude(one: JointSet | Region, dim: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the unit normal [d] of planes, which points up, and unit vectors in them [d - 1, d].

    In the plane these are the direction of joints, in space the strike and the line of dip.
    """
    down, up = direction_of(one.dip)
    if dim == 2:
        return np.array([-up, down]), np.array([[down, up]])
    turn = (one.dip_direction or 0.0) % 360
    north, east = direction_of(turn - 360 if turn > 180 else turn)
    along = np.array([[north, -east, 0.0], [down * east, down * north, -up]])
    return np.array([up * east, up * north, down]), along


def dips_of(normal: np.ndarray) -> dict[str, float]:
    """Return the dip, degrees, and in space the dip direction of planes with a unit normal [d]."""
    *across, up = np.array(normal) + 0.0  # no -0
    if len(across) == 1:
        return {"dip": round((degrees(atan2(-across[0], up)) + 90) % 180 - 90, 12)}
    east, north = across if up >= 0 else (-across[0], -across[1])
    dip, towards = atan2(hypot(east, north), abs(up)), atan2(east, north)
    return {"dip": round(degrees(dip), 12), "dip_direction": round(degrees(towards) % 360, 12)}


def plane_sets(
    sets: Sequence[JointSet], regions: Sequence[Region] = (), dim: int = 2
) -> list[PlaneSet]:
    """Return the planes of joint sets in a domain with some regions of rock."""
    numbers = {REST: -1, **{one.name: k for k, one in enumerate(regions)}}
    found = []
    for one in sets:
        normal, along = attitude(one, dim)
        found.append(
            PlaneSet(
                name=one.name,
                normal=normal,
                along=along,
                spacing=one.spacing,
                through=np.zeros(dim) if one.through is None else np.array(one.through),
                ends_at=tuple(one.ends_at),
                offset=one.offset,
                scatter=one.scatter,
                seed=one.seed,
                regions=tuple(numbers[name] for name in one.regions) if one.regions else None,
            )
        )
    return found


def region_at(regions: Sequence[Region], places: np.ndarray) -> np.ndarray:
    """Return the region that contains each place (float array [n, d], m), or ROCK: the last of
    those whose line it lies above, or whose outline it lies in."""
    found = np.full(len(places), ROCK)
    for k, one in enumerate(bounded(regions, places.shape[1])):
        found[one.contains(places)] = k
    return found


def rocks_of(scene: RockMass) -> list[IntactRock]:
    """Return the rock of each region, and last that of the rest."""
    return [*(one.rock(scene.rock) for one in scene.regions), scene.rock]


def rocks_beside(scene: RockMass, one: JointSet) -> list[IntactRock]:
    """Return the rocks that a joint set cuts."""
    return [each.rock for each in within(scene, [one]) if each.joint_sets]


def within(scene: RockMass, sets: Sequence[JointSet]) -> list[RockMass]:
    """Return each region, and last the rest, as a scene of one rock with those of some joint sets
    that cut it; none is validated."""
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


def bounded(regions: Sequence[Region], dim: int = 2) -> list[Solid | HalfSpace]:
    """Return what bounds each region."""
    found: list[Solid | HalfSpace] = []
    for one in regions:
        if one.outline is not None:
            found.append(polygon_solid(corners_of(shapely.Polygon(one.outline))))
        else:
            found.append(HalfSpace(attitude(one, dim)[0], np.array(one.through)))
    return found
