"""Further cuts through intact rock, for rigid blocks: lattices that contain the joints.

`numerics.dem.block` asks for blocks of about that size. Every direction of joints gets parallel
lines, at a whole part of the spacing, or at about the size beside joints that are alone; where all
have one direction, or there are none, lines across them are added: at 60 and 120 degrees, as far
apart, which makes equilateral triangles, or at right angles. A side along which lines run is
met in the middle of a block where it is quiet, since the motion of a block is that of the lattice
in its middle, and at a line elsewhere. Every region of rock has a lattice of its own, with a line
along its boundary. Rock no wider than the size asked for is not cut.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.solids import corners_of
from jointwave.cases.partition.joints import direction_of
from jointwave.cases.partition.outline import SIDES, Outline, outline_of
from jointwave.cases.partition.regions import on_boundary, shapes, within
from jointwave.cases.schema.joint_set import JointSet
from jointwave.cases.schema.region import REST

if TYPE_CHECKING:
    from jointwave.cases.schema.rock_mass import RockMass

#: Blocks from a side to the nearest line, by the side's boundary condition.
AT_SIDE = {"quiet": 0.5, "periodic": 0.0, "free": 1.0, "fixed": 1.0}
#: Degrees between dips that are one.
ALIKE = 1e-9


def further_sets(scene: RockMass) -> list[JointSet]:
    """Return the sets of cuts between the joints of a scene; without numerics.dem.block only those
    along periodic sides.

    Raises SceneError, in one line, for joints whose lines have no lattice.
    """
    block = scene.numerics.dem.block
    if block is None and not scene.boundaries.sides("periodic"):
        return []
    for one in scene.joint_sets:
        if block is not None and (one.ends_at or one.scatter):
            key = "ends_at" if one.ends_at else "scatter"
            allowed = f"cannot cut the rock between joints with {key}, which '{one.name}' has"
            raise SceneError(scene.where, "numerics.dem.block", block, allowed)
    outline, found = outline_of(scene.domain), []
    names = [*(one.name for one in scene.regions), REST] if scene.regions else []
    shaped = shapes(scene.regions, outline) if names else [None]
    for k, (own, shape) in enumerate(zip(within(scene, scene.joint_sets), shaped, strict=True)):
        corners = outline.corners if shape is None else corners_of(shape.convex_hull)
        place = Place(outline, corners, scene)
        inside = {"regions": names[k : k + 1]}
        found += [lines.model_copy(update=inside) for lines in _cuts(own, place, block or inf)]
    names = [f"cut {k}" for k in range(len(found))]
    return [one.model_copy(update={"name": name}) for one, name in zip(found, names, strict=True)]


class Place(NamedTuple):
    """Where lines go: the domain, the corners of the part of it that they fill [n, 2], m, and the
    scene with what holds its sides and bounds that part."""

    outline: Outline
    corners: np.ndarray
    scene: RockMass


def _cuts(scene: RockMass, place: Place, block: float) -> list[JointSet]:
    """Return the sets of cuts of a scene of one rock."""
    found = []
    groups = by_direction(scene.joint_sets)
    for group in groups:
        first = next((one for one in group if one.spacing is not None), group[0])
        if first.spacing is None:
            if min(_reach(place, first.dip), _reach(place, first.dip, first.through)) > block:
                found.append(_lines(place, first.dip, block, first.through, True))
        elif (parts := max(1, round(first.spacing / block))) > 1:
            found.append(_set(first.dip, first.spacing / parts, first.through))
    if len(groups) < 2:
        anchor = next((one.through for one in scene.joint_sets if one.through), None)
        if not groups and _reach(place, 0.0) > block:
            found.append(_lines(place, 0.0, block, anchor, False))
        if not groups and not found:
            return found
        along = (found or groups[0])[0]
        if _reach(place, along.dip + 90.0) <= block:
            return [*found, *_seams(place, along.dip)]
        if squared(scene):
            dip = _folded(along.dip + 90.0)
            found.append(_lines(place, dip, block, anchor, False))
        else:
            dips = (_folded(along.dip + angle) for angle in (60.0, 120.0))
            found += [_set(dip, along.spacing or block, along.through) for dip in dips]
    return found


def _seams(place: Place, dip: float) -> list[JointSet]:
    """Return cuts along the periodic sides at an angle to rock that is cut at one dip only: there
    blocks touch their own images, and share the rock's compliance with the other cuts."""
    held, corners = place.scene.boundaries, place.outline.corners
    sides = (("left", 90.0, 0), ("bottom", 0.0, 1))
    return [
        _set(along, float(np.ptp(corners[:, axis])), corners.min(axis=0).tolist())
        for name, along, axis in sides
        if getattr(held, name) == "periodic" and abs(_folded(along - dip)) > ALIKE
    ]


def _reach(place: Place, dip: float, through: list[float] | None = None) -> float:
    """Return how far rock reaches from a line through a point, to the farther side, or from side to
    side along its normal, m."""
    normal = direction_of(dip)[::-1] * [-1, 1]
    s = place.corners @ normal
    return float(np.ptp(s) if through is None else np.abs(s - normal @ np.array(through)).max())


def squared(scene: RockMass) -> bool:
    """Return whether cuts across joints of one direction are at right angles to them.

    Triangles can have any Poisson's ratio (`material.rigid_fit`), rectangles none; but the lines of
    rectangles can run along periodic sides, which cut no block in two then.
    """
    fit = all(one.dip % 90.0 == 0 for one in scene.joint_sets)
    return scene.rock.intact_poisson == 0 or (fit and bool(scene.boundaries.sides("periodic")))


def by_direction(sets: list[JointSet]) -> list[list[JointSet]]:
    """Return joint sets in groups of one direction."""
    groups: list[list[JointSet]] = []
    for one in sets:
        for group in groups:
            if abs(_folded(one.dip - group[0].dip)) <= ALIKE:
                group.append(one)
                break
        else:
            groups.append([one])
    return groups


def _folded(dip: float) -> float:
    """Return a dip between -90 and 90 degrees."""
    return (dip + 90.0) % 180.0 - 90.0


def _set(dip: float, spacing: float, through: list[float] | None) -> JointSet:
    return JointSet(
        name="cut",
        dip=dip,
        spacing=spacing,
        through=through,
        contact_points=2,
        point_rule="gauss",
    )


def _lines(
    where: Place,
    dip: float,
    block: float,
    through: list[float] | None,
    fixed: bool,
) -> JointSet:
    """Return lines about `block` (m) apart, one of them through a point where that is `fixed`,
    that meet the sides along them as they should."""
    direction = direction_of(dip)
    normal = np.array([-direction[1], direction[0]])
    s = where.corners @ normal
    low, high = float(s.min()), float(s.max())
    rests = _rests(where, normal)
    centre = where.corners.mean(axis=0)
    anchor = np.array(through if through is not None else centre)
    off = where.outline.tolerance
    if fixed and not low - off <= anchor @ normal <= high + off:  # in another region
        anchor, fixed = centre, False
    place = float(anchor @ normal)
    if fixed:
        for rest, reach in zip(rests, (place - low, high - place), strict=True):
            if rest is not None and reach > 0:
                return _set(dip, _divided(reach, rest, block), anchor.tolist())
        return _set(dip, block, anchor.tolist())
    below, above = rests
    spacing = block
    if below is not None and above is not None:
        spacing = _divided(high - low, below + above, block)
    if below is not None:
        place = low + below * spacing
    elif above is not None:
        place = high - above * spacing
    return _set(dip, spacing, (anchor + (place - anchor @ normal) * normal).tolist())


def _divided(reach: float, rest: float, block: float) -> float:
    """Return the spacing, about `block`, of which a reach (m) is a whole number more than rest."""
    whole = max(round(reach / block - rest), 0)
    return reach / (whole + rest) if whole + rest else reach


def _rests(where: Place, normal: np.ndarray) -> tuple[float | None, float | None]:
    """Return the part of a block from the lowest and from the highest side along a normal to the
    line next to it; None where no side runs along the lines there."""
    start, end = where.corners, np.roll(where.corners, -1, axis=0)
    held = where.outline.along(start, end)
    found: list[float | None] = []
    inner = on_boundary(where.scene.regions, (start + end) / 2, where.outline.tolerance)
    s = np.stack([start, end]) @ normal
    for extreme in (s.min(), s.max()):
        along = np.flatnonzero((np.abs(s - extreme) <= where.outline.tolerance).all(axis=0))
        kinds = [getattr(where.scene.boundaries, SIDES[held[k]]) for k in along if not inner[k]]
        if inner[along].any():
            found.append(1.0)
        else:
            found.append(AT_SIDE[kinds[0]] if kinds else None)
    return found[0], found[1]
