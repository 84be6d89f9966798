"""Warnings about the places of joints and receivers in a rock mass, one line each."""

from collections.abc import Iterator
from itertools import combinations, product

import numpy as np
from scipy.spatial import cKDTree

from jointwave.cases.errors import placed
from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.cell_complex import PARALLEL
from jointwave.cases.geometry.locate import sides_at
from jointwave.cases.partition.joints import region_at, within
from jointwave.cases.partition.lattice import by_direction, squared
from jointwave.cases.partition.scene import blocks_of_scene, least_width
from jointwave.cases.partition.shape import SAME, distance, shape_of
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import RockMass

NEAR = 0.05  # largest distance of a receiver from its joint, over the domain's size
UNLIKE = 10.0  # ratio of spacings of a file's blocks and of the scene
GAP = 1e-2  # largest gap of faces that were to touch, over the smallest block's size
ALIKE = 0.999  # cosine of the angle within which they are parallel
COINCIDENT = 1e-9  # distance below which joints coincide, over the domain's size


def _of_joints_given_twice(scene: RockMass) -> Iterator[str]:
    """Warn where joints of two sets coincide: only the law of the first set holds there."""
    for (i, one), (k, other) in combinations(_plain(scene), 2):
        normals = np.array([each.normal for each in (one, other)])
        if np.linalg.matrix_rank(normals, tol=PARALLEL) == 1:
            places = (_joint_places(scene, each, normals[1]) for each in (one, other))
            apart = np.abs(np.subtract.outer(*places))
            if count := int((apart < COINCIDENT * scene.reach).any(axis=0).sum()):
                yield (
                    f"joint_sets[{k}] and joint_sets[{i}] have {count} joints in common: there "
                    f"only the law of joint_sets[{i}] holds"
                )


def _of_joints_beside_sides(scene: RockMass) -> Iterator[str]:
    """Warn of joints that are lost since they are nearer than a block's least width to a side that
    holds the rock."""
    least, shape = least_width(scene.domain, scene.joint_sets), shape_of(scene.domain)
    held = scene.boundaries.sides("periodic", "fixed", "roller")
    for (i, one), side in product(_plain(scene), held):
        for corners, n in shape.faces_of(side):
            if np.linalg.matrix_rank([n, one.normal], tol=PARALLEL) == 1:
                apart = np.abs(_joint_places(scene, one, n) - corners[0] @ n)
                apart = apart[(apart > COINCIDENT * scene.reach) & (apart < least)]
                yield from (
                    f"joint_sets[{i}] has a joint {x:.3g} m from boundaries.{side}, less than "
                    f"domain.least_width = {least:.3g} m: it is left out"
                    for x in apart
                )


def _plain(scene: RockMass) -> list[tuple[int, JointSet]]:
    """Return the sets, with their indices, whose joints cut the whole domain at known places."""
    return [
        (i, one)
        for i, one in enumerate(scene.joint_sets)
        if not (one.scatter or one.ends_at or one.regions or scene.domain.file_key)
    ]


def _away(scene: RockMass, one: JointSet, points: np.ndarray) -> np.ndarray:
    """Return the distance of points [n, d] from the nearest joint of a set without scatter, m."""
    apart = np.subtract.outer(points @ one.normal, _joint_places(scene, one, one.normal))
    return np.abs(apart).min(axis=1, initial=np.inf)


def _joint_places(scene: RockMass, one: JointSet, normal: np.ndarray) -> np.ndarray:
    """Return the places of a set's joints along a normal, m, without scatter; joints along sides
    are left out unless the scene has periodic sides."""
    origin, across = normal @ one.origin, np.array(scene.domain.corners) @ normal
    if one.spacing is None:
        return np.array([origin])
    within = 0.0 if scene.boundaries.sides("periodic") else COINCIDENT * scene.reach
    ends = np.array([across.min() + within, across.max() - within])
    first, last = (ends - origin) / one.spacing
    return origin + one.spacing * np.arange(np.ceil(first), np.floor(last) + 1)


def _of_distances(scene: RockMass) -> Iterator[str]:
    """Warn of spacings larger than the domain, and of joint receivers far from any joint, or where
    several contacts meet."""
    corners, sets = np.array(scene.domain.corners), scene.joint_sets
    for i, one in enumerate(sets):
        extent = float(np.ptp(corners @ one.normal))
        if one.spacing is not None and one.spacing > extent and not scene.domain.file_key:
            yield (
                f"joint_sets[{i}].spacing = {one.spacing:g} m exceeds the domain, {extent:g} m "
                f"across its joints; {one.spacing:g} mm is {one.spacing / 1e3:g} m"
            )
    known = bool(sets) and not any(one.scatter or one.ends_at or one.regions for one in sets)
    if not known or scene.domain.file_key:
        return  # the places of joints are known only after cutting
    places = scene.places["joints"]
    each = np.array([_away(scene, one, places) for one in sets])
    away, on = each.min(axis=0), each <= COINCIDENT * scene.reach
    for k in np.flatnonzero(on.sum(axis=0) > 1):
        yield (
            f"record.joints[{k}] = {placed(places[k])} lies where joints cross: it records one of "
            f"the contacts there, of joint_sets[{on[:, k].argmax()}]; move it off the crossing"
        )
    for k in np.flatnonzero(away > NEAR * scene.domain.extent.max()):
        yield (
            f"record.joints[{k}] = {placed(places[k])} is {away[k]:.3g} m from the nearest joint, "
            "whose motion it records"
        )


def _of_spacings(scene: RockMass) -> Iterator[str]:
    """Warn of spacings, by which joints have the compliance of the rock between them, that are far
    from those of the blocks of a file: volume over area."""
    if not scene.domain.blocks:
        return
    cut = blocks_of_scene(scene)
    yield from _of_gaps(cut)
    for i, one in enumerate(scene.joint_sets):
        area = float(cut.contacts.area[cut.contacts.joint_set == i].sum())
        apart = float(cut.volume.sum()) / (area or np.inf)
        if one.spacing and area and not 1 / UNLIKE < apart / one.spacing < UNLIKE:
            longer = max(apart, one.spacing)
            yield (
                f"joint_sets[{i}].spacing = {one.spacing:g} m, but its joints in domain.blocks are "
                f"about {apart:.3g} m apart; {longer:.3g} mm is {longer / 1e3:.3g} m"
            )


def _of_gaps(cut: Blocks) -> Iterator[str]:
    """Warn of blocks of a file with faces so near each other that they were to touch."""
    most, faces = GAP * float(cut.volume.min()) ** (1 / cut.body.dim), cut.boundary
    x, n, half = faces.centroid, faces.normal, faces.area ** (1 / max(cut.body.dim - 1, 1)) / 2
    i, j = cKDTree(x).query_pairs(2 * float(half.max()) + most, output_type="ndarray").T
    gap = ((x[j] - x[i]) * n[i]).sum(axis=1)
    beside = np.linalg.norm(x[j] - x[i] - gap[:, None] * n[i], axis=1)
    least = SAME * float(np.ptp(cut.body.vertices, axis=0).max())  # else in one plane, side by side
    meant = (np.abs(gap) > least) & (np.abs(gap) < most) & (beside < half[i] + half[j])
    meant &= (n[i] * n[j]).sum(axis=1) < -ALIKE
    if meant.any():
        k = np.flatnonzero(meant)[np.abs(gap[meant]).argmax()]
        yield (
            f"domain.blocks has {meant.sum()} pairs of faces up to {gap[k]:.3g} m apart, the "
            f"widest near {placed(x[i[k]])}: contact takes at most {least:.3g} m"
        )


def _of_points_on_joints(scene: RockMass) -> Iterator[str]:
    """Warn of receivers on joints, where velocity and stress may jump, and of forces there."""
    read = "where velocity, displacement and the stress along it are the mean of both sides"
    named = [(f"record.points[{i}]", x, read) for i, x in enumerate(scene.record.points)]
    forces = [(f"{key}.at", one.at) for key, one in scene.entries("loads") if one.at]
    named += [(*one, "whose sides bear equal parts of the force") for one in forces]
    points = np.array([at for _, at, _ in named])
    for k, one in enumerate(scene.joint_sets):
        if one.scatter or scene.domain.file_key or not len(points):
            continue
        near = _away(scene, one, points)
        on = np.flatnonzero(near <= COINCIDENT * scene.reach)
        if len(on) and (one.ends_at or one.regions):
            sides = sides_at(blocks_of_scene(scene), points[on], len(scene.joint_sets))
            on = on[[len(blocks) > 1 for blocks in sides]]
        for key, at, what in (named[i] for i in on):
            yield f"{key} = {placed(at)} lies on a joint of joint_sets[{k}], {what}"


def _of_points_at_triangles(scene: RockMass) -> Iterator[str]:
    """Warn of points near welds and on roller sides, where triangles' stress does not converge."""
    every, block = within(scene, scene.joint_sets), scene.numerics.dem.block
    if block is None or all(squared(x) or len(by_direction(x.joint_sets)) > 1 for x in every):
        return
    shape, tiny, near = shape_of(scene.domain), COINCIDENT * scene.reach, block / 3
    rollers = [x for side in scene.boundaries.sides("roller") for x in shape.faces_of(side)]
    around = near * np.array([*product((-1, 0, 1), repeat=scene.domain.dimension)])
    for i, at in enumerate(scene.record.points):
        welded = len(set(region_at(scene.regions, np.array(at) + around))) > 1
        away = min((_away(scene, x, np.array([at]))[0] for x in scene.joint_sets), default=np.inf)
        welded &= away > near
        if welded or (rollers and distance(np.array(at), rollers) <= tiny):
            weld = f"within {near:.3g} m of a welded boundary of regions"
            most = 80 if welded and scene.in_space else 50
            yield (
                f"record.points[{i}] = {placed(at)} lies {weld if welded else 'on a roller side'},"
                f" where the stress of rigid blocks is off by up to {most} %, however small they "
                f"are: half a block away, {block / 2:.3g} m, it converges"
            )


RULES_OF_PLACES = (
    _of_joints_given_twice,
    _of_joints_beside_sides,
    _of_distances,
    _of_spacings,
    _of_points_on_joints,
    _of_points_at_triangles,
)
