"""The blocks of a rock-mass scene, and an estimate of the memory that cutting them needs."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import combinations
from math import inf, prod

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import Blocks, blocks_of
from jointwave.cases.geometry.cell_complex import Complex, GeometryError, Sliver
from jointwave.cases.geometry.measure import cell_moments
from jointwave.cases.geometry.periodic import Across, contacts_across
from jointwave.cases.geometry.pieces import without_slivers
from jointwave.cases.geometry.sets import cut_by_sets
from jointwave.cases.geometry.solids import check_convex, cut_into_regions, taken_out
from jointwave.cases.partition.joints import ROCK, bounded, plane_sets
from jointwave.cases.partition.shape import SIDES, Shape, shape_of
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import REST, Region, RockMass
from jointwave.cases.size import excess

#: Default least width of a block over the least spacing, or over the domain's size without one.
THIN = 1e-2
#: The same where cuts through intact rock make a lattice, if possible. The thinnest block sets the
#: time step, but merged rock has no strain: with a third of the spacing a wave's error does not
#: fall with the block size; with 0.03 it does, at three times as many steps.
LATTICE = 0.03
#: Bytes of memory for each block while a domain of two or three dimensions is cut.
OF_BLOCK = {2: 2500, 3: 16_000}


def rock_of(shape: Shape, regions: Sequence[Region]) -> Complex:
    """Return a domain as cells of one region of rock each."""
    return cut_into_regions(shape.hull, bounded(regions), shape.tolerance)


def blocks_of_domain(
    domain: Domain,
    sets: Sequence[JointSet],
    further: Sequence[JointSet] = (),
    regions: Sequence[Region] = (),
) -> Blocks:
    """Return a domain in convex blocks without slivers, or the cells of its mesh. `side` of a
    boundary facet is an index in the `sides` of the domain's shape.

    further : sets of cuts, which may lie where joints are. Their thin blocks at the sides, which
    would set the time step, are merged with others where possible. Raises GeometryError, with place
    and cause, where a joint set cuts nothing or is lost with slivers, a block is not convex or a
    sliver is left.
    """
    shape, every = shape_of(domain), [*sets, *further]
    tolerance = shape.tolerance
    if domain.given is not None:
        body = domain.cells([one.name for one in sets])
    else:
        planes = plane_sets(every, regions)
        body = cut_by_sets(rock_of(shape, regions), planes, tolerance, len(sets))
        body = taken_out(body, shape.solids, tolerance)
        if domain.non_convex == "refuse":
            check_convex(body, shape.solids)
        merge, kept = domain.slivers == "merge", len(sets) if further else inf
        limits = domain.least_angle, merge, tolerance, kept
        with suppress(Sliver):
            if further and domain.least_width is None:
                body = without_slivers(body, least_width(domain, every, LATTICE), *limits)
        width = least_width(domain, every)
        body = without_slivers(body, width, *limits)
        for i in sorted({*range(len(sets))} - {*body.joint_set[body.inner].tolist()}):
            cause = (
                "is lost: blocks beside it are joined across it, being thinner than "
                f"domain.least_width = {width:.3g} m or more pointed than domain.least_angle"
            )
            raise GeometryError(None, cause, f"joint_sets[{i}]")
    found = blocks_of(body, tolerance)
    side = shape.sides_of(found.boundary.outlines, found.boundary.side)
    return replace(found, boundary=replace(found.boundary, side=side))


def least_width(domain: Domain, sets: Sequence[JointSet], thin: float = THIN) -> float:
    """Return the width below which a block is a sliver, m; thin : default width over a spacing."""
    if domain.least_width is not None:
        return domain.least_width
    spacings = [one.spacing for one in sets if one.spacing is not None]
    return thin * min([*spacings, float(np.ptp(domain.corners, axis=0).min())])


def blocks_of_scene(scene: RockMass, further: Sequence[JointSet] = ()) -> Blocks:
    """Return the blocks of a rock mass, in the plane or in space.

    further : sets of cuts through intact rock, with indices after those of the scene's own sets.

    Raises SceneError, in one line with place and cause, where the rock cannot be cut into convex
    blocks, periodic sides do not match, or the blocks need more memory than a run may use.
    """
    size = partition_bytes(scene, further)
    if why := excess(size):
        spaced = [(one.spacing, i) for i, one in enumerate(scene.joint_sets) if one.spacing]
        spacing, index = min(spaced, default=(None, 0))
        key = f"joint_sets[{index}].spacing"
        if further:
            key, spacing = "numerics.dem.block", scene.numerics.dem.block
        gives = f"gives about {size / OF_BLOCK[scene.domain.dimension]:,.0f} blocks"
        if scene.regions:
            every, names = [*scene.joint_sets, *further], [*(x.name for x in scene.regions), REST]
            name = names[int(np.argmax(block_counts(scene.domain, every, scene.regions)))]
            least = min(x.spacing or inf for x in every if not x.regions or name in x.regions)
            gives += f", most of them in region '{name}', cut {least:.3g} m apart"
        raise SceneError(scene.where, key, spacing, f"{gives}, which {why}")
    try:
        found = blocks_of_domain(scene.domain, scene.joint_sets, further, scene.regions)
        across_periodic(scene, found)  # checks that periodic sides match
    except GeometryError as error:
        raise SceneError(scene.where, error.key, None, str(error)) from None
    return found


def across_periodic(scene: RockMass, blocks: Blocks) -> list[Across]:
    """Return the contacts across periodic sides. Raises GeometryError if these do not match."""
    x, dim, names = blocks.body.vertices, blocks.body.dim, [one.name for one in scene.joint_sets]
    return [
        Across(
            contacts_across(blocks, axis, pair, names), np.ptp(x, axis=0) * np.eye(dim)[axis], pair
        )
        for axis, pair in enumerate(zip(SIDES[dim][:-1:2], SIDES[dim][1::2], strict=True))
        if getattr(scene.boundaries, pair[0]) == "periodic"
    ]


def block_count(domain: Domain, sets: Sequence[JointSet], regions: Sequence[Region] = ()) -> float:
    """Return the approximate number of blocks of a domain."""
    return float(block_counts(domain, sets, regions).sum())


def block_counts(
    domain: Domain, sets: Sequence[JointSet], regions: Sequence[Region] = ()
) -> np.ndarray:
    """Return the approximate number of blocks in each region, then in the rest: one plus the joints
    and the crossings of two or three of them, ignoring openings and ends of joints."""
    if domain.given is not None:
        return np.array([float(domain.given.count)])
    rock = rock_of(shape_of(domain), regions)
    volumes, counts = cell_moments(rock).size, np.zeros(len(regions) + 1)
    for k, name in enumerate([*(one.name for one in regions), REST]):
        cells = rock.region == (k if k < len(regions) else ROCK)
        if cells.any():
            corners = rock.vertices[np.unique(rock.corners(rock.beside(cells))[:, 1])]
            own = [one for one in sets if not one.regions or name in one.regions]
            counts[k] = _count(corners, volumes[cells].sum(), own)
    return counts


def _count(corners: np.ndarray, volume: float, sets: Sequence[JointSet]) -> float:
    dim, count, normals = corners.shape[1], 1.0, [one.normal for one in sets]
    joints = [
        float(np.ptp(corners @ normal)) / one.spacing if one.spacing else 1.0
        for normal, one in zip(normals, sets, strict=True)
    ]
    for number in range(1, dim + 1):
        for some in combinations(range(len(sets)), number):
            n = np.array([normals[k] for k in some])
            sine = float(np.sqrt(max(np.linalg.det(n @ n.T), 0.0)))
            spacings = [sets[k].spacing or 0.0 for k in some]
            if number == dim and all(spacings):
                count += volume * sine / prod(spacings)
            else:
                count += prod(joints[k] for k in some) * sine
    return count


def partition_bytes(scene: RockMass, further: Sequence[JointSet] = ()) -> float:
    """Return the memory for cutting the blocks of a rock mass, bytes."""
    each = OF_BLOCK[scene.domain.dimension]
    return each * block_count(scene.domain, [*scene.joint_sets, *further], scene.regions)
