"""Contradictions within and between the joint sets and the regions of a rock mass."""

from collections.abc import Iterator

import numpy as np
import shapely

from jointwave.cases.checks.rules import Wrong, of_damping, of_fracture, of_strength, within
from jointwave.cases.geometry.cell_complex import PARALLEL
from jointwave.cases.geometry.measure import cell_moments
from jointwave.cases.geometry.sets import in_order
from jointwave.cases.geometry.solids import taken_out
from jointwave.cases.partition.joints import attitude, plane_sets, rocks_beside
from jointwave.cases.partition.scene import rock_of
from jointwave.cases.partition.shape import Shape
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.plane import REST
from jointwave.cases.schema.rock_mass import RockMass

NEEDS = (("offset", "spacing"), ("scatter", "spacing"), ("offset", "ends_at"), ("seed", "scatter"))


def of_sets(scene: RockMass) -> Iterator[Wrong]:
    """Yield contradictions of the joint sets."""
    sets, file = scene.joint_sets, scene.domain.file_key
    for i, one in enumerate(sets):
        names = _of_names(one, [other.name for other in sets], i)
        for rule in (names, _of_places(one, file), _of_law(one, scene)):
            yield from within(f"joint_sets[{i}]", rule)
    try:
        in_order(plane_sets([one.model_copy(update={"regions": []}) for one in sets]))
    except ValueError as error:
        yield "joint_sets", None, str(error)


def _of_names(one: JointSet, names: list[str], index: int) -> Iterator[Wrong]:
    if one.name in names[:index]:
        yield "name", one.name, "must be unique"
    for name in one.ends_at:
        if name == one.name or name not in names:
            known = ", ".join(other for other in names if other != one.name)
            yield "ends_at", name, f"must name other sets: {known or 'none'}"
    if len(set(one.ends_at)) < len(one.ends_at):
        yield "ends_at", one.ends_at, "must not repeat a set"


def _of_places(one: JointSet, file: str | None) -> Iterator[Wrong]:
    for key in ("through", "ends_at", "regions", "offset", "scatter", "seed") if file else ():
        if value := getattr(one, key):
            yield key, value, f"has no effect: {file} has the joints"
    if file:
        return
    if one.spacing is None and one.through is None:
        allowed = "give a spacing, or through = [x, y], in space [x, y, z], for one joint"
        yield "spacing", None, allowed
    for key, other in NEEDS:
        if one.gives(key) and not getattr(one, other):
            yield key, getattr(one, key), f"has no meaning without {{table}}.{other}"
    if one.scatter and one.seed is None:
        yield "seed", None, "is required with {table}.scatter"


def _of_law(one: JointSet, scene: RockMass) -> Iterator[Wrong]:
    for key in ("normal_stiffness", "shear_stiffness"):
        if getattr(one, key) is None:
            yield key, None, "is required"
    yield from of_strength(one)
    yield from of_damping(one, scene)
    assert one.normal_stiffness is not None
    yield from of_fracture(one, one.normal_stiffness, "K_n")


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
