"""The partition of a rock-mass scene, and its memory, estimated in advance."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import Facets, blocks_of
from jointwave.cases.geometry.cell_complex import Complex, GeometryError, Sliver, polygon
from jointwave.cases.geometry.sets import cut_by_sets
from jointwave.cases.geometry.slivers import Limits, without_slivers
from jointwave.cases.geometry.solids import (
    check_convex,
    cut_into_regions,
    polygon_solid,
    taken_out,
)
from jointwave.cases.partition.blocks import Partition, plane_partition
from jointwave.cases.partition.given import complex_of
from jointwave.cases.partition.joints import direction_of, plane_sets
from jointwave.cases.partition.outline import SIDES, Outline, outline_of
from jointwave.cases.partition.periodic import across_periodic
from jointwave.cases.partition.regions import bounded
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint_set import JointSet
from jointwave.cases.schema.region import Region
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.size import LIMIT, memory, spoken

#: Default least width of a block over the smallest spacing, or the size of the domain without one.
THIN = 1e-2
#: The same where cuts through intact rock make a lattice, in the order in which they are tried. The
#: thinnest block decides the step, but what is joined has no strain: with a third of the spacing a
#: wave's error does not fall with the blocks, with 0.03 it does and steps are three times as many.
LATTICE = (0.03, THIN)
#: Bytes of memory for each block while a domain is cut.
OF_BLOCK = 2500


def cut(
    domain: Domain,
    sets: Sequence[JointSet],
    further: Sequence[JointSet] = (),
    regions: Sequence[Region] = (),
) -> Partition:
    """Return a domain in convex blocks; of a mesh, its cells.

    further : sets of cuts, of which some or all may be where joints are.

    Raises GeometryError, with place and cause, where a joint set cuts nothing, a block is not
    convex or a sliver is left.
    """
    outline = outline_of(domain)
    body = _body(domain, outline, sets, further, regions)
    found = blocks_of(body, outline.tolerance)
    found = replace(found, boundary=_named(found.boundary, outline))
    sides = (*SIDES, *(f"opening {k}" for k in range(len(domain.holes))))
    return plane_partition(found, sides, tuple(one.name for one in sets))


def _body(
    domain: Domain,
    outline: Outline,
    sets: Sequence[JointSet],
    further: Sequence[JointSet],
    regions: Sequence[Region],
) -> Complex:
    """Return a domain in cells."""
    if domain.given is not None:
        return complex_of(domain.given, [one.name for one in sets])
    body = cut_into_regions(polygon(outline.hull), bounded(regions), outline.tolerance)
    planes = plane_sets([*sets, *further], regions)
    body = cut_by_sets(body, planes, outline.tolerance, len(sets))
    solids = [(polygon_solid(corners), side) for corners, side in outline.taken]
    body = taken_out(body, solids, outline.tolerance)
    if domain.non_convex == "refuse":
        check_convex(body, solids)
    kept = len(sets) if further else None
    return _without_slivers(body, domain, [*sets, *further], kept, outline.tolerance)


def least_width(domain: Domain, sets: Sequence[JointSet], thin: float = THIN) -> float:
    """Return the width below which a block is a sliver, m; thin : the default over a spacing."""
    if domain.least_width is not None:
        return domain.least_width
    corners = np.array(domain.corners)
    spacings = [one.spacing for one in sets if one.spacing is not None]
    return thin * min([*spacings, float(np.ptp(corners, axis=0).min())])


def _without_slivers(
    body: Complex, domain: Domain, sets: Sequence[JointSet], kept: int | None, tolerance: float
) -> Complex:
    """Return a complex without slivers; of a lattice without thin blocks at its sides, as far as
    they can be joined to others: they would decide the step.

    kept : how many of the sets, the first ones, are the joints of a lattice; None without one.
    """
    for thin in LATTICE if kept is not None and domain.least_width is None else (THIN,):
        limits = Limits(least_width(domain, sets, thin), domain.least_angle)
        try:
            return without_slivers(body, limits, domain.slivers == "merge", tolerance, kept or 0)
        except Sliver:
            if thin == THIN:
                raise
    raise AssertionError


def _named(facets: Facets, outline: Outline) -> Facets:
    """Return boundary edges with the outer ones told apart: those along the left, right, bottom and
    top of the domain, and others."""
    ends = facets.outlines.corners.reshape(-1, 2, 2)
    outer = outline.sides_of(ends[:, 0], ends[:, 1])
    return replace(facets, side=np.where(facets.side == 0, outer, len(SIDES) - 1 + facets.side))


def partition_of(scene: RockMass, further: Sequence[JointSet] = ()) -> Partition:
    """Return the blocks of a rock mass.

    further : sets of cuts through intact rock, beyond the scene's own sets; their contacts have
    indices beyond those of the partition's `joint_sets`.

    Raises SceneError, in one line with place and cause, where it cannot be cut into convex blocks,
    periodic sides do not fit each other, or the blocks would take more memory than a run may.
    """
    refuse_too_many(scene, further)
    try:
        found = cut(scene.domain, scene.joint_sets, further, scene.regions)
        across_periodic(scene, found)  # whether its sides fit each other
        return found
    except GeometryError as error:
        raise SceneError(scene.where, error.key, None, str(error)) from None


def block_count(domain: Domain, sets: list[JointSet]) -> float:
    """Return about how many blocks a domain is cut into: one more than there are joints, and
    crossings of joints, openings left out."""
    if domain.given is not None:
        return float(domain.given.number)
    corners = np.array(domain.corners)
    size = float(np.hypot(*np.ptp(corners, axis=0)))
    x, y = corners.T
    area = abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2
    count = 1.0
    for one in sets:
        normal = direction_of(one.dip)[::-1] * [-1, 1]
        count += float(np.ptp(corners @ normal)) / one.spacing if one.spacing else 1.0
    for one, other in combinations(sets, 2):
        (a, b), (c, d) = direction_of(one.dip), direction_of(other.dip)
        sine = abs(float(a * d - b * c))
        if one.spacing and other.spacing:
            count += area * sine / (one.spacing * other.spacing)
        else:
            count += size * sine / (one.spacing or other.spacing or size)
    return count


def partition_bytes(scene: RockMass, further: Sequence[JointSet] = ()) -> float:
    """Return the memory for the partition of a rock mass, bytes."""
    return OF_BLOCK * block_count(scene.domain, [*scene.joint_sets, *further])


def refuse_too_many(scene: RockMass, further: Sequence[JointSet] = ()) -> None:
    """Raise SceneError where the blocks would take more memory than a run may."""
    size, limit = partition_bytes(scene, further), memory()
    if size <= limit:
        return
    spaced = [(one.spacing, i) for i, one in enumerate(scene.joint_sets) if one.spacing]
    spacing, index = min(spaced, default=(None, 0))
    key = f"joint_sets[{index}].spacing"
    if further:
        key, spacing = "numerics.dem.block", scene.numerics.dem.block
    blocks = block_count(scene.domain, [*scene.joint_sets, *further])
    raise SceneError(
        scene.where,
        key,
        spacing,
        f"gives about {blocks:,.0f} blocks, which would need about {spoken(size)} of memory;  "
        f"{spoken(limit)} available (set {LIMIT} to change it, in GB)",
    )
