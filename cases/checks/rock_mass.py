"""Contradictions between the tables of a rock mass."""

from collections.abc import Iterator

import numpy as np

from jointwave.cases.checks.joint_sets import of_regions, of_sets
from jointwave.cases.checks.rules import Wrong, within
from jointwave.cases.geometry.cell_complex import GeometryError
from jointwave.cases.geometry.sets import cut_by_sets
from jointwave.cases.partition.joints import attitude, plane_sets
from jointwave.cases.partition.scene import rock_of
from jointwave.cases.partition.shape import BESIDE, Shape, distance, shape_of
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.sources import PlaneLoad
from jointwave.cases.schema.tables import LEAN

GRAZING = 1e-6  #: cosine below which a wave travels along a side or a joint
PARTNER = {"left": "right", "right": "left", "bottom": "top", "top": "bottom"}
PARTNER |= {"front": "back", "back": "front"}


def rules(scene: RockMass) -> list[Iterator[Wrong]]:
    """Return the rules of a rock mass whose tables are each right."""
    try:
        shape = shape_of(scene.domain)
    except GeometryError as error:
        return [iter([(error.key, None, str(error))])]
    loads = (within(key, _of_load(one, scene, shape)) for key, one in scene.entries("loads"))
    return [of_sets(scene), *(one(scene, shape) for one in OF_SHAPE), *loads]


def _of_support(scene: RockMass, outline: Shape) -> Iterator[Wrong]:
    """Yield rock under gravity that no side bears, though some side holds it back."""
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
    """Yield joints that miss the domain. Those of spacings that fit into it do not, and sets that
    end at others are known when they are cut. The contacts of a file become those of the sets."""
    dimension = scene.domain.dimension
    if scene.domain.given is not None:
        normals = [attitude(one, dimension)[0] for one in scene.joint_sets]
        scene.domain.join([one.name for one in scene.joint_sets], np.array(normals))
        return
    whole = rock_of(outline, scene.regions)
    for i, one in enumerate(plane_sets(scene.joint_sets, scene.regions, dimension)):
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


OF_SHAPE = (of_regions, _of_cuts, _of_receivers, _of_boundaries, _of_waves, _of_support)
