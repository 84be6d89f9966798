"""Regions of rock in a domain: which one holds a place, and the cuts between them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import shapely

from cases.partition.joints import direction_of
from cases.partition.lines import one_line
from cases.partition.split import split
from cases.partition.subdivision import Subdivision
from cases.schema.region import REST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from cases.partition.outline import Outline
    from cases.schema.joint_set import JointSet
    from cases.schema.plane import IntactRock
    from cases.schema.region import Region
    from cases.schema.rock_mass import RockMass

ROCK = -1  #: in place of a region: the rock that no region holds
FAR = 4.0  #: sizes of a domain: beyond all of it


def region_at(regions: Sequence[Region], places: np.ndarray) -> np.ndarray:
    """Return the region that holds each place (float array [n, 2], m), or ROCK: the last of those
    whose line it lies above."""
    found = np.full(len(places), ROCK)
    for k, one in enumerate(regions):
        x, y = direction_of(one.dip)
        found[(places - one.through) @ [-y, x] > 0] = k
    return found


def on_boundary(regions: Sequence[Region], places: np.ndarray, tolerance: float) -> np.ndarray:
    """Return which places [n, 2] (m) lie on the line of a region, bool array [n]."""
    found = np.zeros(len(places), bool)
    for one in regions:
        x, y = direction_of(one.dip)
        found |= np.abs((places - one.through) @ [-y, x]) <= tolerance
    return found


def rocks_of(scene: RockMass) -> list[IntactRock]:
    """Return the rock of each region, and last that of the rest."""
    return [*(one.rock(scene.rock) for one in scene.regions), scene.rock]


def rocks_beside(scene: RockMass, one: JointSet) -> list[IntactRock]:
    """Return the rocks that a joint set cuts."""
    names = [*(region.name for region in scene.regions), REST]
    rocks = zip(names, rocks_of(scene), strict=True)
    return [rock for name, rock in rocks if not one.regions or name in one.regions]


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


def cut_into_regions(sub: Subdivision, regions: Sequence[Region], tolerance: float) -> Subdivision:
    """Return a subdivision cut along the boundaries of regions, each cell with its region."""
    for k in reversed(range(len(regions))):
        one, free = regions[k], sub.region == ROCK
        line = one_line(direction_of(one.dip), np.array(one.through), free)
        found = split(sub, line, tolerance)
        sub = found.subdivision
        above = (found.number == 0) & free[found.parent]
        sub = replace(sub, region=np.where(above, k, sub.region))
    return sub


def shapes(regions: Sequence[Region], outline: Outline) -> list[shapely.Geometry]:
    """Return what of a domain each region holds, and last what is left of it."""
    left, found, reach = outline.shape, [], FAR * outline.size
    for one in reversed(regions):
        along = reach * direction_of(one.dip)
        up = np.array([-along[1], along[0]])
        at = np.array(one.through)
        foot = at + (outline.corners.mean(axis=0) - at) @ along / reach**2 * along
        ends = [foot - along, foot + along, foot + along + up, foot - along + up]
        above = shapely.Polygon(ends)
        found.append(left.intersection(above))
        left = left.difference(above)
    return [*reversed(found), left]
