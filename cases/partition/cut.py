"""A domain cut by joint sets: the steps from the scene's tables to the partition."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from cases.partition import assemble
from cases.partition.blocks import BoundaryEdges, Partition
from cases.partition.faults import Sliver
from cases.partition.given import subdivision_of
from cases.partition.joints import cut_by_sets
from cases.partition.openings import check_convex, taken_out
from cases.partition.outline import SIDES, Outline, outline_of
from cases.partition.polygons import moments
from cases.partition.regions import cut_into_regions
from cases.partition.slivers import without_slivers
from cases.partition.subdivision import Subdivision

if TYPE_CHECKING:
    from collections.abc import Sequence

    from cases.schema.domain import Domain
    from cases.schema.joint_set import JointSet
    from cases.schema.region import Region

#: Default least width of a block over the smallest spacing, or the size of the domain without one.
THIN = 1e-2
#: The same where cuts through intact rock make a lattice, in the order in which they are tried. The
#: thinnest block decides the step, but what is joined has no strain: with a third of the spacing a
#: wave's error does not fall with the blocks, with 0.03 it does and steps are three times as many.
LATTICE = (0.03, THIN)


def cut(
    domain: Domain,
    sets: Sequence[JointSet],
    further: Sequence[JointSet] = (),
    regions: Sequence[Region] = (),
) -> Partition:
    """Return a domain in convex blocks; of a mesh, its cells.

    further : sets of cuts, of which some or all may be where joints are.

    Raises PartitionError, with place and cause, where a joint set cuts nothing, a block is not
    convex or a sliver is left.
    """
    outline = outline_of(domain)
    if domain.given is not None:
        sub = subdivision_of(domain.given, [one.name for one in sets])
        found = assemble.ordered(sub, assemble.rings(sub))
        return _partition(*found, outline, sets, len(domain.holes))
    whole = Subdivision.of_polygon(outline.hull)
    whole = cut_into_regions(whole, regions, outline.tolerance)
    sub = cut_by_sets(whole, [*sets, *further], outline.tolerance, len(sets), regions)
    sub = taken_out(sub, outline.taken, outline.tolerance)
    if domain.non_convex == "refuse":
        check_convex(sub, outline.taken)
    kept = len(sets) if further else None
    sub, rings = _without_slivers(sub, domain, [*sets, *further], kept, outline.tolerance)
    return _partition(*assemble.ordered(sub, rings), outline, sets, len(domain.holes))


def least_width(domain: Domain, sets: Sequence[JointSet], thin: float = THIN) -> float:
    """Return the width below which a block is a sliver, m; thin : the default over a spacing."""
    if domain.least_width is not None:
        return domain.least_width
    corners = np.array(domain.corners)
    spacings = [one.spacing for one in sets if one.spacing is not None]
    return thin * min([*spacings, float(np.ptp(corners, axis=0).min())])


def _without_slivers(
    sub: Subdivision, domain: Domain, sets: Sequence[JointSet], kept: int | None, tolerance: float
) -> tuple[Subdivision, assemble.Rings]:
    """Return a subdivision without slivers, and its outlines; of a lattice without thin blocks at
    its sides, as far as they can be joined to others: they would decide the step.

    kept : how many of the sets, the first ones, are the joints of a lattice; None without one.
    """
    for thin in LATTICE if kept is not None and domain.least_width is None else (THIN,):
        limits = (least_width(domain, sets, thin), domain.least_angle)
        try:
            return without_slivers(sub, limits, domain.slivers == "merge", tolerance, kept or 0)
        except Sliver:
            if thin == THIN:
                raise
    raise AssertionError


def _partition(
    sub: Subdivision,
    rings: assemble.Rings,
    outline: Outline,
    sets: Sequence[JointSet],
    openings: int,
) -> Partition:
    m = moments(rings.corners, rings.first)
    return Partition(
        corners=rings.corners,
        first=rings.first,
        area=m.area,
        centroid=m.centroid,
        second_moment=m.second,
        region=sub.region,
        contacts=assemble.contacts(sub),
        boundary=_named(assemble.boundary(sub), outline),
        sides=(*SIDES, *(f"opening {k}" for k in range(openings))),
        joint_sets=tuple(one.name for one in sets),
    )


def _named(edges: BoundaryEdges, outline: Outline) -> BoundaryEdges:
    """Return boundary edges with the outer ones told apart: those along the left, right, bottom and
    top of the domain, and others."""
    outer = outline.sides_of(edges.start, edges.end)
    side = np.where(edges.side == 0, outer, len(SIDES) - 1 + edges.side)
    return replace(edges, side=side)
