"""Contradictions between the tables of a rock mass."""

from collections.abc import Iterator

import numpy as np
import shapely

from jointwave.cases.checks.rules import Wrong, of_damping, of_fracture, of_strength, within
from jointwave.cases.geometry.cell_complex import PARALLEL, GeometryError
from jointwave.cases.geometry.measure import cell_moments
from jointwave.cases.geometry.sets import cut_by_sets, in_order
from jointwave.cases.geometry.solids import taken_out
from jointwave.cases.partition.joints import plane_sets, rocks_beside
from jointwave.cases.partition.scene import rock_of
from jointwave.cases.partition.shape import BESIDE, Shape, distance, shape_of
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.pulse import PlaneLoad
from jointwave.cases.schema.rock_mass import REST, RockMass
from jointwave.cases.schema.tables import LEAN

GRAZING = 1e-6  #: cosine to the normal below which a wave travels along a side or joint
PARTNER = {"left": "right", "right": "left", "bottom": "top", "top": "bottom"}
PARTNER |= {"front": "back", "back": "front"}
NEEDS = (("offset", "spacing"), ("scatter", "spacing"), ("offset", "ends_at"), ("seed", "scatter"))


def rules(scene: RockMass) -> list[Iterator[Wrong]]:
    """Return the rules for a rock mass whose tables are each valid."""
    try:
        shape = shape_of(scene.domain)
    except GeometryError as error:
        return [iter([(error.key, None, str(error))])]
    loads = (within(key, _of_load(one, scene, shape)) for key, one in scene.entries("loads"))
    return [_of_sets(scene), *(one(scene, shape) for one in OF_SHAPE), *loads]


def _of_support(scene: RockMass, outline: Shape) -> Iterator[Wrong]:
    """Yield rock under gravity that no side bears, though some side holds it."""
    gravity, normals = scene.gravity, outline.normals()
    quiet = [side for side in scene.boundaries.sides("quiet") if side in normals]
    if gravity is None or scene.boundaries.sides("fixed"):
        return
    down = np.array(gravity.direction)
    if any((normals[side] @ down).max() > LEAN for side in quiet):
        return
    rollers = [normals[side][0] for side in scene.boundaries.sides("roller") if side in normals]
    if np.linalg.norm(down - sum(max(n @ down, 0.0) * n for n in rollers)) < GRAZING:
        return
    if gravity.static:
        allowed = "needs a fixed side, a quiet or roller one below it, or gravity.static = false"
        yield "gravity.static", True, allowed
    if quiet and gravity.acceleration:
        allowed = "does not bear the weight of the rock: needs a fixed side, a quiet or roller one"
        allowed += " below"
        yield f"boundaries.{quiet[0]}", "quiet", allowed


def _of_cuts(scene: RockMass, outline: Shape) -> Iterator[Wrong]:
    """Yield joints that miss the domain, except sets with spacings that fit into it and sets that
    end at others, which cutting checks. Assign the contacts of a file to joint sets."""
    if scene.domain.given is not None:
        normals = [one.normal for one in scene.joint_sets]
        scene.domain.join([one.name for one in scene.joint_sets], np.array(normals))
        return
    whole = rock_of(outline, scene.regions)
    for i, one in enumerate(plane_sets(scene.joint_sets, scene.regions)):
        if one.ends_at or one.widest < float(np.ptp(scene.domain.corners @ one.normal)):
            continue
        try:
            cut_by_sets(whole, [one], outline.tolerance)
        except GeometryError as error:
            yield error.key.replace("[0]", f"[{i}]"), None, str(error)


def _of_receivers(scene: RockMass, outline: Shape) -> Iterator[Wrong]:
    record = scene.record
    if not (record.points or record.joints or record.fields):
        yield "record", None, "give at least one of record.points, joints and fields"
    if record.joints and not scene.joint_sets:
        yield "record.joints", record.joints, "needs [[joint_sets]]"
    for key in ("points", "joints"):
        places = getattr(record, key)
        for i, place in enumerate(places):
            yield from _of_place(f"record.{key}[{i}]", place, outline)
            if place in places[:i]:
                yield f"record.{key}[{i}]", place, "must not repeat a position"


def _of_place(key: str, place: list[float], outline: Shape) -> Iterator[Wrong]:
    if not outline.holds(place):
        yield key, place, "must lie in the domain and outside its openings"


def _of_boundaries(scene: RockMass, outline: Shape) -> Iterator[Wrong]:
    normals = outline.normals()
    for side, held in scene.boundaries:
        if held != "free" and side not in normals:
            allowed = f"is not a side of this domain, which has {', '.join(normals)}"
            yield f"boundaries.{side}", held, allowed
    for side in scene.boundaries.sides("periodic"):
        if getattr(scene.boundaries, PARTNER[side]) != "periodic":
            allowed = f"needs boundaries.{PARTNER[side]} = 'periodic', too"
            yield f"boundaries.{side}", "periodic", allowed


def _of_waves(scene: RockMass, outline: Shape) -> Iterator[Wrong]:
    for i, wave in enumerate(scene.waves):
        for side, normals in outline.normals().items():
            held = getattr(scene.boundaries, side)
            if held != "quiet" and (normals @ np.array(wave.direction)).min() < -GRAZING:
                yield f"boundaries.{side}", held, f"must be 'quiet': waves[{i}] enters there"


def _of_load(load: PlaneLoad, scene: RockMass, outline: Shape) -> Iterator[Wrong]:
    if load.at is not None:
        yield from _of_place("at", load.at, outline)
        for side, held in scene.boundaries:
            for face in outline.faces_of(side) if held in ("fixed", "roller") else ():
                bears = held == "fixed" or abs(face[1] @ np.array(load.direction)) > GRAZING
                if bears and distance(np.array(load.at), [face]) <= BESIDE * outline.size:
                    yield "at", load.at, f"must not push on a {held} side, which bears it"
    holes = len(scene.domain.holes)
    if load.opening is not None and load.opening >= holes:
        yield "opening", load.opening, f"must be one of the {holes} openings, counted from 0"
    if load.side is not None:
        held, sides = getattr(scene.boundaries, load.side), ", ".join(outline.normals())
        if load.side not in outline.normals():
            yield "side", load.side, f"must be a side of this domain, which has {sides}"
        one, other = ("fixed" if load.kind == "base" else "free"), "quiet"
        if held not in (one, other):
            allowed = f"needs boundaries.{load.side} = '{one}' or '{other}', not '{held}'"
            yield "side", load.side, allowed
    if load.between is not None:
        faces = outline.faces_of(load.side, load.opening)
        for point in load.between:
            if distance(np.array(point), faces) > BESIDE * outline.size:
                yield "between", point, f"must lie on {load.side or f'openings[{load.opening}]'}"
        if np.hypot(*np.diff(load.between, axis=0)[0]) <= BESIDE * outline.size:
            yield "between", load.between, "must be two points"


def _of_sets(scene: RockMass) -> Iterator[Wrong]:
    """Yield contradictions of the joint sets."""
    sets, file = scene.joint_sets, scene.domain.file_key
    for i, one in enumerate(sets):
        names = _of_names(one, sets, i)
        for rule in (names, _of_places(one, file), _of_law(one, scene)):
            yield from within(f"joint_sets[{i}]", rule)
    try:
        in_order(plane_sets([one.model_copy(update={"regions": []}) for one in sets]))
    except ValueError as error:
        yield "joint_sets", None, str(error)


def _of_names(one: JointSet, sets: list[JointSet], index: int) -> Iterator[Wrong]:
    names = [other.name for other in sets]
    if one.name in names[:index]:
        yield "name", one.name, "must be unique"
    for name in one.ends_at:
        if name == one.name or name not in names:
            known = ", ".join(other for other in names if other != one.name)
            yield "ends_at", name, f"must name other sets: {known or 'none'}"
    if len(set(one.ends_at)) < len(one.ends_at):
        yield "ends_at", one.ends_at, "must not repeat a set"
    for other in (other for other in sets if other.name in one.ends_at):
        across = one.normal - (one.normal @ other.normal) * other.normal
        if np.linalg.norm(across) < PARALLEL:
            yield "ends_at", other.name, "cannot end there: the two sets are parallel"


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


def _of_regions(scene: RockMass, outline: Shape) -> Iterator[Wrong]:
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
    """Yield outlines that are not polygons, or lie on sides with waves or periodic sides."""
    for i, one in enumerate(scene.regions):
        if one.outline is None:
            continue
        key, corners = f"regions[{i}].outline", len(one.outline)
        shape = shapely.Polygon(one.outline if corners > 2 else ())
        if not (shape.is_valid and shape.area > 0):
            yield key, one.outline, "must be a polygon that does not cross itself"
        within = shapely.Polygon(scene.domain.corners).exterior.distance(shape)
        if within <= outline.tolerance and (scene.waves or scene.boundaries.sides("periodic")):
            allowed = "must lie inside the domain, not on its sides, with waves or periodic sides"
            yield key, one.outline, allowed


def _of_periodic_sides(scene: RockMass) -> Iterator[Wrong]:
    """Yield region boundaries that do not run from one periodic side to the other."""
    sides = ("left", "front", "bottom") if scene.in_space else ("left", "bottom")
    for i, one in enumerate(scene.regions):
        if one.outline is not None:
            continue
        for axis, side, across in zip("xyz", sides, one.normal, strict=False):
            if getattr(scene.boundaries, side) == "periodic" and abs(across) > PARALLEL:
                allowed = f"must be parallel to the {axis} axis: boundaries.{side} is periodic"
                yield f"regions[{i}].dip", one.dip, allowed


OF_SHAPE = (_of_regions, _of_cuts, _of_receivers, _of_boundaries, _of_waves, _of_support)
