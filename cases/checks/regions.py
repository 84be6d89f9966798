"""Contradictions of the regions of a rock mass with its domain and joint sets."""

from collections.abc import Iterator

import numpy as np
import shapely

from jointwave.cases.checks.scene import Wrong
from jointwave.cases.geometry.cell_complex import PARALLEL
from jointwave.cases.geometry.measure import cell_moments
from jointwave.cases.geometry.solids import taken_out
from jointwave.cases.partition.joints import attitude
from jointwave.cases.partition.regions import rocks_beside
from jointwave.cases.partition.scene import rock_of
from jointwave.cases.partition.shape import Shape
from jointwave.cases.schema.region import REST
from jointwave.cases.schema.rock_mass import RockMass


def of_regions(scene: RockMass, outline: Shape) -> Iterator[Wrong]:
    """Yield contradictions of the regions, and of the joint sets that name them."""
    names = [one.name for one in scene.regions]
    for i, name in enumerate(names):
        if name == REST or name in names[:i]:
            allowed = f"must be unique, and not {REST!r}, which is the name of [rock]"
            yield f"regions[{i}].name", name, allowed
    for i, one in enumerate(scene.joint_sets):
        for name in set(one.regions) - {REST, *names}:
            allowed = f"must name regions: {', '.join([REST, *names])}"
            yield f"joint_sets[{i}].regions", name, allowed
        if one.damping_ratio and len({rock.density for rock in rocks_beside(scene, one)}) > 1:
            allowed = f"needs rock of one density: restrict the set by joint_sets[{i}].regions"
            yield f"joint_sets[{i}].damping_ratio", one.damping_ratio, allowed
    if not names:
        return
    if key := scene.domain.file_key:
        yield "regions", len(names), f"cannot be combined with {key}"
    yield from _of_outlines(scene, outline)
    least = outline.tolerance * outline.size ** (scene.domain.dimension - 1)
    body = taken_out(rock_of(outline, scene.regions), outline.solids, outline.tolerance)
    volumes = cell_moments(body).size
    *held, rest = np.bincount(body.region % (len(names) + 1), volumes, len(names) + 1)
    for i, (region, area) in enumerate(zip(scene.regions, held, strict=True)):
        if area <= least:
            key = "through" if region.outline is None else "outline"
            allowed = "leaves the region empty: it is outside the domain, or later regions cover it"
            yield f"regions[{i}].{key}", getattr(region, key), allowed
    if rest <= least:
        yield "regions", len(names), "must leave part of the domain to [rock]"
    yield from _of_periodic_sides(scene)


def _of_outlines(scene: RockMass, outline: Shape) -> Iterator[Wrong]:
    """Yield outlines that are no polygons, and those on sides that waves enter through."""
    for i, one in enumerate(scene.regions):
        if one.outline is None:
            continue
        key, corners = f"regions[{i}].outline", len(one.outline)
        shape = shapely.Polygon(one.outline if corners > 2 else ())
        if not (shape.is_valid and shape.area > 0):
            yield key, corners, "must be a polygon that does not cross itself"
        within = shapely.Polygon(scene.domain.corners).exterior.distance(shape)
        if within <= outline.tolerance and (scene.waves or scene.boundaries.sides("periodic")):
            allowed = "must lie inside the domain, not on its sides, with waves or periodic sides"
            yield key, corners, allowed


def _of_periodic_sides(scene: RockMass) -> Iterator[Wrong]:
    """Yield boundaries that do not run from one periodic side to the other."""
    sides = ("left", "front", "bottom") if scene.in_space else ("left", "bottom")
    for i, one in enumerate(scene.regions):
        if one.outline is not None:
            continue
        normal = attitude(one, scene.domain.dimension)[0]
        for axis, side, across in zip("xyz", sides, normal, strict=False):
            if getattr(scene.boundaries, side) == "periodic" and abs(across) > PARALLEL:
                allowed = f"must be parallel to the {axis} axis: boundaries.{side} is periodic"
                yield f"regions[{i}].dip", one.dip, allowed
