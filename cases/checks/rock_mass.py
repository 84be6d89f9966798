"""Contradictions between the tables of a rock mass."""

from functools import partial
from typing import Any

import numpy as np
from pydantic_core import PydanticCustomError

from jointwave.cases.checks.joint_sets import check_sets
from jointwave.cases.checks.regions import check_regions
from jointwave.cases.checks.shared import check_fields, check_quality, check_time, found_by
from jointwave.cases.geometry.cell_complex import GeometryError
from jointwave.cases.geometry.sets import cut_by_sets
from jointwave.cases.partition.box import Box
from jointwave.cases.partition.joints import attitude, plane_sets
from jointwave.cases.partition.outline import Outline
from jointwave.cases.partition.scene import rock_of, shape_of
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.sources import PlaneLoad
from jointwave.cases.schema.tables import LEAN
from jointwave.cases.schema.values import contradiction

GRAZING = 1e-6  #: cosine below which a wave travels along a side or a joint
PARTNER = {"left": "right", "right": "left", "bottom": "top", "top": "bottom"}
PARTNER |= {"front": "back", "back": "front"}
#: Tolerance of points on the boundary, over the size of the domain.
BESIDE = 1e-6


def contradictions(scene: RockMass) -> list[PydanticCustomError]:
    """Return the contradictions of a rock mass whose tables are each right."""
    try:
        outline = shape_of(scene.domain)
    except GeometryError as error:
        return [contradiction(error.key, None, str(error))]
    cuts = _check_cuts if scene.domain.given is None else _join
    of_shape = (check_regions, cuts, _check_receivers, _check_boundaries, _check_waves)
    of_loads = ((f"loads[{i}]", load) for i, load in enumerate(scene.loads))
    return found_by(
        partial(check_sets, scene),
        *(partial(one, scene, outline) for one in of_shape),
        *(partial(one, scene) for one in (check_time, check_fields, check_quality)),
        partial(_check_support, scene, outline),
        *(partial(_check_load, table, load, scene, outline) for table, load in of_loads),
    )


def _check_support(scene: RockMass, outline: Outline | Box) -> None:
    """Refuse rock under gravity that no side bears, though some side holds it back."""
    gravity, normals = scene.gravity, outline.normals()
    quiet = [side for side in scene.boundaries.sides("quiet") if side in normals]
    if gravity is None or scene.boundaries.sides("fixed"):
        return
    below = any((normals[side] @ np.array(gravity.direction)).max() > LEAN for side in quiet)
    if gravity.static and not below:
        allowed = "needs a fixed side, a quiet one below the rock, or gravity.static = false"
        raise contradiction("gravity.static", True, allowed)
    if quiet and gravity.acceleration and not below:
        allowed = "does not bear the weight of the rock: needs a fixed side, or a quiet one below"
        raise contradiction(f"boundaries.{quiet[0]}", "quiet", allowed)


def _join(scene: RockMass, _: Outline | Box) -> None:
    """Let the contacts of a file be those of the joint sets."""
    normals = [attitude(one, scene.domain.dimension)[0] for one in scene.joint_sets]
    scene.domain.join([one.name for one in scene.joint_sets], np.array(normals))


def _check_cuts(scene: RockMass, outline: Any) -> None:
    """Refuse joints that miss the domain. Those of spacings that fit into it do not, and sets that
    end at others are known when they are cut."""
    whole = rock_of(outline, scene.regions)
    sets = plane_sets(scene.joint_sets, scene.regions, scene.domain.dimension)
    for i, one in enumerate(sets):
        if one.ends_at or one.widest < float(np.ptp(scene.domain.corners @ one.normal)):
            continue
        try:
            cut_by_sets(whole, [one], outline.tolerance)
        except GeometryError as error:
            key = error.key.replace("[0]", f"[{i}]")
            raise contradiction(key, None, str(error)) from None


def _check_receivers(scene: RockMass, outline: Outline | Box) -> None:
    record = scene.record
    if not (record.points or record.joints or record.fields):
        raise contradiction("record", None, "give at least one of record.points, joints and fields")
    if record.joints and not scene.joint_sets:
        raise contradiction("record.joints", record.joints, "needs [[joint_sets]]")
    for key in ("points", "joints"):
        places = getattr(record, key)
        for i, place in enumerate(places):
            _check_in_rock(f"record.{key}[{i}]", place, outline)
            if place in places[:i]:
                raise contradiction(f"record.{key}[{i}]", place, "must not repeat a position")


def _check_in_rock(key: str, place: list[float], outline: Outline | Box) -> None:
    if not outline.holds(place):
        allowed = "must lie in the domain and outside its openings"
        raise contradiction(key, place, allowed)


def _check_boundaries(scene: RockMass, outline: Outline | Box) -> None:
    normals = outline.normals()
    for side, held in scene.boundaries:
        if held != "free" and side not in normals:
            allowed = f"is not a side of this domain, which has {', '.join(normals)}"
            raise contradiction(f"boundaries.{side}", held, allowed)
    for side, other in PARTNER.items():
        held, across = getattr(scene.boundaries, side), getattr(scene.boundaries, other)
        if held == "periodic" and across != "periodic":
            allowed = f"needs boundaries.{other} = 'periodic', too"
            raise contradiction(f"boundaries.{side}", held, allowed)


def _check_waves(scene: RockMass, outline: Outline | Box) -> None:
    for i, wave in enumerate(scene.waves):
        for side, normals in outline.normals().items():
            held = getattr(scene.boundaries, side)
            if held != "quiet" and (normals @ np.array(wave.direction)).min() < -GRAZING:
                allowed = f"must be 'quiet': waves[{i}] enters there"
                raise contradiction(f"boundaries.{side}", held, allowed)


def _check_load(table: str, load: PlaneLoad, scene: RockMass, outline: Outline | Box) -> None:
    if load.at is not None:
        _check_in_rock(f"{table}.at", load.at, outline)
    if load.opening is not None and load.opening >= len(scene.domain.holes):
        allowed = f"must be one of the {len(scene.domain.holes)} openings, counted from 0"
        raise contradiction(f"{table}.opening", load.opening, allowed)
    if load.side is not None:
        _check_side(table, load, scene, outline)
    if load.between is not None:
        _check_part(table, load, outline)


def _check_side(table: str, load: PlaneLoad, scene: RockMass, outline: Outline | Box) -> None:
    assert load.side is not None
    key, held = f"{table}.side", getattr(scene.boundaries, load.side)
    if load.side not in outline.normals():
        known = ", ".join(outline.normals())
        raise contradiction(key, load.side, f"must be a side of this domain, which has {known}")
    wanted = ("fixed", "quiet") if load.kind == "base" else ("free", "quiet")
    if held not in wanted:
        allowed = f"needs boundaries.{load.side} = '{wanted[0]}' or '{wanted[1]}', not '{held}'"
        raise contradiction(key, load.side, allowed)


def _check_part(table: str, load: PlaneLoad, outline: Any) -> None:
    """Refuse `between` points that are not on the loaded side or opening."""
    assert load.between is not None
    edges = outline.edges(load.side, load.opening)
    for point in load.between:
        if distance(np.array(point), edges) > BESIDE * outline.size:
            on = load.side or f"openings[{load.opening}]"
            raise contradiction(f"{table}.between", point, f"must lie on {on}")
    if np.hypot(*np.diff(load.between, axis=0)[0]) <= BESIDE * outline.size:
        raise contradiction(f"{table}.between", load.between, "must be two points")


def distance(point: np.ndarray, edges: np.ndarray) -> float:
    """Return the distance of a point from the nearest of some edges [n, 2, 2], m."""
    start, along = edges[:, 0], edges[:, 1] - edges[:, 0]
    t = ((point - start) * along).sum(axis=1) / (along**2).sum(axis=1)
    foot = start + np.clip(t, 0, 1)[:, None] * along
    return float(np.hypot(*(point - foot).T).min())
