"""Regions of rock in a domain: which one contains a place, and the rock of each."""

from collections.abc import Sequence

import numpy as np
import shapely

from jointwave.cases.geometry.solids import ROCK, HalfSpace, Solid, corners_of, polygon_solid
from jointwave.cases.partition.joints import attitude
from jointwave.cases.schema.joint_set import JointSet
from jointwave.cases.schema.plane import IntactRock
from jointwave.cases.schema.region import REST, Region
from jointwave.cases.schema.rock_mass import RockMass


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
