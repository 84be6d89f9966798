"""Cuts through intact rock that complete the joints to a lattice of rigid blocks.

`numerics.dem.block` sets the size of blocks. Every joint direction gets parallel planes: at a whole
part of the spacing, or at about this size next to single joints. Planes are added across directions
in which no joints cut: at right angles, or those of ISOTROPIC in rock with a Poisson effect whose
joints have one direction or none. A quiet side parallel to planes lies at the middle of a block,
which moves like the lattice there; other sides lie at a plane. Each region of rock has its own
lattice and a plane along its boundary. Rock no wider than the size is not cut, except in layers of
a fifth of a block or more, which are one row of triangles or tetrahedra.
"""

from collections.abc import Iterator
from math import ceil, inf
from typing import NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import blocks_of
from jointwave.cases.partition.joints import ROCK, dips_of, within
from jointwave.cases.partition.scene import rock_of
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import REST, RockMass

#: Blocks from a side to the nearest plane, by the side's boundary condition.
AT_SIDE = {"quiet": 0.5, "periodic": 0.0, "free": 1.0, "fixed": 1.0, "roller": 1.0}
ALIKE = 1e-11  #: sine of the angle below which directions are equal
ACROSS = 3**0.5 / 2
LAYER = 0.2  #: least thickness of a layer within wider rock that is cut as this is, in blocks
#: For 2 or 3 directions in which rock is cut: the planes besides those across the first one, as
#: normals and spacings over the first spacing. They give long waves one speed in all directions and
#: any Poisson's ratio: equilateral triangles, or cubes of five tetrahedra each.
ISOTROPIC: dict[int, list[tuple[tuple[float, ...], float]]] = {
    2: [((0.5, -ACROSS), 1.0), ((-0.5, -ACROSS), 1.0)],
    3: [
        *(((0.0, 1.0, 0.0), 1.0), ((0.0, 0.0, 1.0), 1.0)),
        *(((3**-0.5, y * 3**-0.5, z * 3**-0.5), 1 / ACROSS) for y in (1, -1) for z in (1, -1)),
    ],
}


class Place(NamedTuple):
    """Rock of one region: corners [n, d], m; centres of its boundary facets [f, d], m, those inside
    the domain first; and the distance from each facet to the next plane in blocks [f]."""

    corners: np.ndarray
    facets: np.ndarray
    rests: np.ndarray
    tolerance: float

    def extent(self, normal: np.ndarray) -> float:
        """Return the extent of the rock along a normal, m."""
        return float(np.ptp(self.corners @ normal))

    def holds(self, group: list[JointSet]) -> bool:
        """Return whether a joint of parallel sets lies within the rock."""
        for one in group:
            heights = (self.corners - one.origin) @ one.normal
            low, high = heights.min() + self.tolerance, heights.max() - self.tolerance
            if low <= ((one.spacing and ceil(low / one.spacing) * one.spacing) or 0.0) <= high:
                return True
        return False

    def rest(self, normal: np.ndarray) -> float | None:
        """Return the distance from the rock's end along a normal to the next plane, in blocks; None
        if no side there is parallel to the planes."""
        end = (self.corners @ normal).max()
        found = self.rests[self.facets @ normal >= end - self.tolerance]
        return float(found[0]) if len(found) else None


def further_sets(scene: RockMass) -> list[JointSet]:
    """Return the sets of cuts between the joints of a scene; without numerics.dem.block only those
    along periodic sides. Raises SceneError, in one line, for joints that no lattice can contain."""
    block = scene.numerics.dem.block
    if block is None and not scene.boundaries.sides("periodic"):
        return []
    for one in scene.joint_sets:
        if block is not None and (one.ends_at or one.scatter):
            key = "ends_at" if one.ends_at else "scatter"
            allowed = f"cannot cut the rock between joints with {key}, which '{one.name}' has"
            raise SceneError(scene.where, "numerics.dem.block", block, allowed)
    found = []
    for own, place, regions in _places(scene):
        sets = _cuts(own, place, block or inf)
        found += [one.model_copy(update={"regions": regions}) for one in sets]
    return [one.model_copy(update={"name": f"cut {k}"}) for k, one in enumerate(found)]


def thin_layers(scene: RockMass) -> Iterator[tuple[str, float]]:
    """Yield regions too thin to be cut in triangles or tetrahedra, and their thickness, m: their
    blocks have no Poisson effect."""
    if (block := scene.numerics.dem.block) is None:
        return
    dim, corners = scene.domain.dimension, np.array(scene.domain.corners)
    for own, place, regions in _places(scene):
        least, groups = LAYER * block, by_direction(own.joint_sets)
        axes = [*_across(groups, dim), *(x[0].normal for x in groups if not place.holds(x))]
        for axis in axes if len(groups) < 2 and not squared(own) else ():
            if (thickness := place.extent(axis)) <= least < np.ptp(corners @ axis):
                yield regions[0], thickness


def _places(scene: RockMass) -> Iterator[tuple[RockMass, Place, list[str]]]:
    """Yield each region as a scene with one rock, its place, and its name if there are regions."""
    from scipy.spatial import ConvexHull

    shape = shape_of(scene.domain)
    rock = blocks_of(rock_of(shape, scene.regions), shape.tolerance)
    body, edge, names = rock.body, rock.boundary, [*(one.name for one in scene.regions), REST]
    held, side = scene.boundaries.model_dump(), shape.sides_of(edge.outlines, edge.side)
    rests = np.array([AT_SIDE[held.get(name, "free")] for name in shape.sides])
    for k, own in enumerate(within(scene, scene.joint_sets)):
        cells = body.region == (k if k < len(scene.regions) else ROCK)
        inside, outer = cells[rock.contacts.blocks].sum(axis=1) == 1, cells[edge.blocks[:, 0]]
        corners = body.vertices[np.unique(body.corners(body.beside(cells))[:, 1])]
        place = Place(
            corners[ConvexHull(corners).vertices],
            np.concatenate([rock.contacts.centroid[inside], edge.centroid[outer]]),
            np.append(np.ones(inside.sum()), rests[side[outer]]),
            shape.tolerance,
        )
        yield own, place, names[k : k + 1] if scene.regions else []


def _cuts(scene: RockMass, place: Place, block: float) -> list[JointSet]:
    """Return the sets of cuts of a scene with one rock."""
    dim, found, corners = scene.domain.dimension, [], np.array(scene.domain.corners)

    def least(axis: np.ndarray) -> float:
        return block * (LAYER if np.ptp(corners @ axis) > block else 1.0)

    groups = by_direction(scene.joint_sets)
    normals = [group[0].normal for group in groups]
    for normal, group in zip(normals, groups, strict=True):
        first = next((one for one in group if one.spacing is not None), group[0])
        if least(normal) < place.extent(normal) <= block and not place.holds(group):
            found.append(_planes(place, normal, block))
        elif first.spacing is None:
            away = np.abs((place.corners - first.through) @ normal).max()
            if min(place.extent(normal), away) > block:
                found.append(_planes(place, normal, block, first.through, True))
        elif (parts := max(1, round(first.spacing / block))) > 1:
            found.append(_set(normal, first.spacing / parts, first.through))
    across = _across(groups, dim)
    wide = [axis for axis in across if place.extent(axis) > least(axis)]
    if not groups and wide:
        normals = [wide.pop(0)]
        found.append(_planes(place, normals[0], block))
    if wide and len(groups) < 2 and not squared(scene):
        along, frame = (found or groups[0])[0], np.array([normals[0], *wide])
        found += [
            _set(np.array(one) @ frame, ratio * (along.spacing or block), along.through)
            for one, ratio in ISOTROPIC[len(frame)]
        ]
    else:
        anchor = next((one.through for one in scene.joint_sets if one.through), None)
        found += [_planes(place, axis, block, anchor) for axis in wide]
    thin = [axis for axis in across if place.extent(axis) <= block]
    if normals and thin:
        # Cuts along periodic sides where rock is not cut otherwise: blocks touch their own images
        # there, and these contacts share the rock's compliance with the other cuts.
        sides = shape_of(scene.domain).sides
        for k in sorted({sides.index(side) // 2 for side in scene.boundaries.sides("periodic")}):
            if np.abs(np.array(thin)[:, k]).max() > ALIKE:
                extent, low = float(np.ptp(corners[:, k])), corners.min(axis=0).tolist()
                found.append(_set(np.eye(dim)[k], extent, low))
    return found


def _across(groups: list[list[JointSet]], dim: int) -> list[np.ndarray]:
    """Return unit vectors along directions that no joints cut; without joints vertical first."""
    normals = np.array([group[0].normal for group in groups]).reshape(-1, dim)
    rank = np.linalg.matrix_rank(normals, tol=ALIKE) if groups else 0
    if rank == 2 < dim:
        axis = np.cross(*normals[:2])
        return [axis / np.linalg.norm(axis)]
    return [*np.eye(dim)[::-1]] if rank == 0 else [*groups[0][0].frame[1:]] if rank == 1 else []


def squared(scene: RockMass) -> bool:
    """Return whether cuts across joints of one direction are at right angles to them.

    Triangles and tetrahedra can have any Poisson's ratio (`material.effective_medium`), boxes only
    0; but box faces can run along periodic sides, which then split no block.
    """
    fit = all(np.abs(one.normal).max() == 1 for one in scene.joint_sets)
    return scene.rock.intact_poisson == 0 or (fit and bool(scene.boundaries.sides("periodic")))


def by_direction(sets: list[JointSet]) -> list[list[JointSet]]:
    """Return joint sets grouped by direction."""
    groups: list[list[JointSet]] = []
    for one in sets:
        pairs = ([one.normal, group[0].normal] for group in groups)
        ranks = [int(np.linalg.matrix_rank(pair, tol=ALIKE)) for pair in pairs]
        if 1 not in ranks:
            groups.append([])
        groups[ranks.index(1) if 1 in ranks else -1].append(one)
    return groups


def _set(normal: np.ndarray, spacing: float, through: list[float] | None) -> JointSet:
    keys = {"name": "cut", "spacing": spacing, "through": through, **dips_of(normal)}
    return JointSet.model_validate(keys, context={"dimension": len(normal)})


def _planes(
    place: Place,
    normal: np.ndarray,
    block: float,
    through: list[float] | None = None,
    fixed: bool = False,
) -> JointSet:
    """Return planes about `block` (m) apart that keep the required distance from parallel sides;
    `fixed` : one plane goes through the given point."""
    heights, anchor = place.corners @ normal, np.array(through or place.corners.mean(axis=0))
    low, high, at = float(heights.min()), float(heights.max()), float(anchor @ normal)
    below, above, spacing = place.rest(-normal), place.rest(normal), block
    if fixed and low - place.tolerance <= at <= high + place.tolerance:
        for rest, reach in ((below, at - low), (above, high - at)):
            if rest is not None and reach > 0:
                return _set(normal, _divided(reach, rest, block), through)
        return _set(normal, block, through)
    if fixed:  # the point is in another region
        return _planes(place, normal, block)
    if below is not None and above is not None:
        spacing = _divided(high - low, below + above, block)
    if below is not None:
        at = low + below * spacing
    elif above is not None:
        at = high - above * spacing
    return _set(normal, spacing, (anchor + (at - anchor @ normal) * normal).tolist())


def _divided(reach: float, rest: float, block: float) -> float:
    """Return the spacing, at most 1.5 `block`, that divides a reach into blocks and `rest`."""
    whole = max(round(reach / block - rest), ceil(reach / (1.5 * block) - rest - 1e-9), 0)
    row = reach <= block and rest > 1.5  # a layer of one row
    return reach / (whole + rest) if whole + rest and not row else reach
