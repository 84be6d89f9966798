"""Regions of rock in a domain: which one contains a place, and the cuts between them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import shapely

from jointwave.cases.partition.joints import direction_of
from jointwave.cases.partition.lines import one_line
from jointwave.cases.partition.openings import passed_by
from jointwave.cases.partition.outline import corners_of
from jointwave.cases.partition.split import split
from jointwave.cases.partition.subdivision import Subdivision
from jointwave.cases.schema.region import REST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jointwave.cases.partition.outline import Outline
    from jointwave.cases.schema.joint_set import JointSet
    from jointwave.cases.schema.plane import IntactRock
    from jointwave.cases.schema.region import Region
    from jointwave.cases.schema.rock_mass import RockMass

ROCK = -1  #: in place of a region: rock outside all regions
FAR = 4.0  #: sizes of a domain: beyond all of it


def region_at(regions: Sequence[Region], places: np.ndarray) -> np.ndarray:
    """Return the region that contains each place (float array [n, 2], m), or ROCK: the last of
    those whose line it lies above, or whose outline it lies in."""
    found = np.full(len(places), ROCK)
    for k, one in enumerate(regions):
        if one.outline is not None:
            found[shapely.contains_xy(shapely.Polygon(one.outline), places)] = k
        else:
            found[_above(one, places) > 0] = k
    return found


def _above(one: Region, places: np.ndarray) -> np.ndarray:
    """Return the heights of places [n, 2] (m) above the line of a region [n], m."""
    assert one.through is not None
    x, y = direction_of(one.dip)
    return (places - np.array(one.through)) @ [-y, x]


def on_boundary(regions: Sequence[Region], places: np.ndarray, tolerance: float) -> np.ndarray:
    """Return which places [n, 2] (m) lie on the line or the outline of a region, bool [n]."""
    found = np.zeros(len(places), bool)
    for one in regions:
        if one.outline is not None:
            ring = shapely.Polygon(one.outline).exterior
            found |= shapely.dwithin(ring, shapely.points(places), tolerance)
        else:
            found |= np.abs(_above(one, places)) <= tolerance
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


def strata(regions: Sequence[Region]) -> list[Region]:
    """Return the regions that are bounded by a line."""
    return [one for one in regions if one.outline is None]


def cut_into_regions(sub: Subdivision, regions: Sequence[Region], tolerance: float) -> Subdivision:
    """Return a subdivision cut along the boundaries of regions, each cell with its region.

    An outline is cut along the lines of its faces, so that cells stay convex; what they cut of the
    rock around it is joined again by `openings.taken_out`.
    """
    for k in reversed(range(len(regions))):
        one = regions[k]
        if one.outline is not None:
            corners = corners_of(shapely.Polygon(one.outline))
            for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
                free = sub.region == ROCK
                passed = free & passed_by(sub, sub.halves(), start, end, tolerance)
                line = one_line((end - start) / np.hypot(*(end - start)), start, passed)
                sub = split(sub, line, tolerance).subdivision
            inside = shapely.contains_xy(shapely.Polygon(corners), sub.centres())
        else:
            assert one.through is not None
            line = one_line(direction_of(one.dip), np.array(one.through), sub.region == ROCK)
            sub = split(sub, line, tolerance).subdivision
            inside = _above(one, sub.centres()) > 0
        sub = replace(sub, region=np.where(inside & (sub.region == ROCK), k, sub.region))
    return sub


def shapes(regions: Sequence[Region], outline: Outline) -> list[shapely.Geometry]:
    """Return the part of a domain in each region, and last the remainder."""
    left, found = outline.shape, []
    for one in reversed(regions):
        whole = shapely.Polygon(_corners(one, outline))
        found.append(left.intersection(whole))
        left = left.difference(whole)
    return [*reversed(found), left]


def _corners(one: Region, outline: Outline) -> list:
    """Return the corners of a region without the others, far beyond the domain's where it is
    bounded by a line."""
    if one.outline is not None:
        return one.outline
    along = FAR * outline.size * direction_of(one.dip)
    up, at = np.array([-along[1], along[0]]), np.array(one.through)
    foot = at + (outline.corners.mean(axis=0) - at) @ along / (along @ along) * along
    return [foot - along, foot + along, foot + along + up, foot - along + up]
