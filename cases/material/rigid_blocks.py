"""Stiffness of the joints between rigid blocks, which also carry the rock's compliance.

Every joint direction gets non-negative excess compliances Z0 (1/Pa, normal and shear) that together
come nearest to the intact rock (`effective_medium`). A contact between blocks has

    1 / K' = 1 / K + Z0 h,

h the spacing of planes in its direction: it is never stiffer than the joint itself. A cut through
intact rock has K = inf. For one set this is equation (6) with the modulus of confined rock. Each
region of rock has its own excess compliances; a joint between two regions takes half of each, and
so does a welded boundary without a joint, with the thickness of the neighbouring blocks as h.
"""

from typing import NamedTuple

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.loads import LEAST_BLOCKS, highest_frequency
from jointwave.cases.material import effective_medium
from jointwave.cases.material.rock import elastic_rock, wave_moduli
from jointwave.cases.partition.joints import rocks_of, within
from jointwave.cases.partition.lattice import by_direction
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.schema.rock_mass import RockMass

#: Sine of the angle up to which a contact lies along joints.
PARALLEL = 1e-9
#: Least compliance of a direction with cuts, over that of confined rock, normal and in shear: the
#: best fit may be zero, and rigid contacts allow no time step.
LEAST = 0.05


class RigidJoints(NamedTuple):
    """Stiffness K'_n and K'_s, Pa/m, of each column (a joint set or set of cuts in one rock or
    between two), and the rock's part of the compliance, normal and shear [2, columns], m/Pa.

    kinds : set, and regions on both sides [columns, 3]. left_over : part of the intact rock's
    stiffness that rigid blocks cannot represent, relative; the largest of all regions.
    """

    normal: np.ndarray
    shear: np.ndarray
    excess: np.ndarray
    kinds: np.ndarray
    left_over: float


class RockShare(NamedTuple):
    """Compliance that intact rock adds to the joints of one region: normals of joint directions [n,
    d]; excess Z0, normal and shear [n, 2], 1/Pa; spacings of planes [n], m; direction of each set
    [sets], -1 for none; residual as in `RigidJoints`."""

    normals: np.ndarray
    compliance: np.ndarray
    apart: np.ndarray
    direction: np.ndarray
    left_over: float

    def parallel_to(self, normal: np.ndarray) -> int:
        """Return the index of the direction parallel to a unit normal [d], or -1."""
        across = self.normals - np.outer(self.normals @ normal, normal)
        sines = np.linalg.norm(across, axis=1)
        return int(sines.argmin()) if sines.min(initial=1.0) < PARALLEL else -1


def rigid_joints(
    scene: RockMass, further: list[JointSet], kinds: np.ndarray | None = None
) -> RigidJoints:
    """Return the stiffness between rigid blocks; further : the cuts of `partition.lattice`.

    kinds : see `RigidJoints`; absent: every set in the rock outside all regions. A single joint has
    its own compliance only. Raises SceneError if blocks cannot represent the scene.
    """
    sets = [*scene.joint_sets, *further]
    if kinds is None:
        kinds = np.stack([np.arange(len(sets)), *np.full((2, len(sets)), -1)], axis=1)
    shares = rock_shares(scene, further)
    excess = np.zeros((len(kinds), 2))
    for row, (k, *pair) in zip(excess, kinds, strict=True):
        for one in (shares[region] for region in pair):
            at = one.direction[k] if pair[0] == pair[1] else one.parallel_to(sets[k].normal)
            if at >= 0:
                row += one.compliance[at] * one.apart[at] / 2
    real = [(one.normal_stiffness, one.shear_stiffness) for one in scene.joint_sets]
    own = np.array([*real, *([(np.inf, np.inf)] * len(further))], dtype=float).reshape(-1, 2)
    with np.errstate(divide="ignore"):
        normal, shear = (1 / (1 / own[kinds[:, 0]] + excess)).T
    return RigidJoints(normal, shear, excess.T, kinds, max(one.left_over for one in shares))


def long_wave_stiffness(
    scene: RockMass, further: list[JointSet], own: list[effective_medium.JointSet]
) -> np.ndarray:
    """Return C (Pa) of long waves through rigid blocks outside all regions, in Voigt's form; very
    large for strains to which no joint yields. own : the compliance of joints."""
    share, dim = rock_shares(scene, further)[-1], scene.domain.dimension
    excess = zip(share.normals, share.compliance, strict=True)
    sets = [*own, *(effective_medium.JointSet(n, *map(float, z)) for n, z in excess)]
    return effective_medium.joints_alone(sets, dim)


def rock_shares(scene: RockMass, further: list[JointSet]) -> list[RockShare]:
    """Return the compliance that intact rock adds to joints in each region, the rest last."""
    if why := against(scene):
        raise SceneError(scene.where, "numerics.dem.block", None, why)
    sets = [*scene.joint_sets, *further]
    return [_share(one, sets, len(scene.joint_sets)) for one in within(scene, sets)]


def _share(scene: RockMass, sets: list[JointSet], real: int) -> RockShare:
    """Return the rock share of a scene of one rock, whose first `real` sets are joints."""
    dim = scene.domain.dimension
    groups = by_direction(scene.joint_sets)
    spaced = [group for group in groups if any(one.spacing for one in group)]
    normals = np.array([group[0].normal for group in spaced])
    if not spaced:  # rock between single joints stays rigid
        none = np.zeros((0, 2))
        return RockShare(none, none, np.zeros(0), np.full(len(sets), -1), 1.0)
    rock, held = elastic_rock(scene.rock), [one for _, one in scene.boundaries]
    # Between rollers rock has no motion along an axis that no plane crosses: strains in the plane.
    along = np.abs(normals).max(axis=0) < PARALLEL if dim == 3 else []
    still = [k for k in np.flatnonzero(along) if held[2 * k : 2 * k + 2] == ["roller"] * 2]
    flat = np.delete(normals, still[:1], axis=1)
    fit = effective_medium.nearest_stiffness(effective_medium.intact(rock, flat.shape[1]), flat)
    least = LEAST / np.array([rock.lame + 2 * rock.shear_modulus, rock.shear_modulus])
    index = {one.name: k for k, one in enumerate(sets)}
    direction, apart = np.full(len(sets), -1), np.ones(len(spaced))
    for k, group in enumerate(spaced):
        own = [index[member.name] for member in group]
        cuts, joints = (
            [m for m in own if m >= real],
            [m for m in own if m < real and sets[m].spacing],
        )
        # The planes of a lattice include the set or single joint it was made for; a single joint
        # without a lattice has no parallel planes.
        lines = [*cuts, *joints[1:]] if cuts else joints
        direction[own if cuts else joints] = k
        apart[k] = 1 / sum(1 / (sets[m].spacing or np.inf) for m in lines)
        fit.compliance[k] = np.maximum(fit.compliance[k], least if cuts else 0.0)
    return RockShare(normals, fit.compliance, apart, direction, fit.left_over)


def welds(
    scene: RockMass,
    cut: Blocks,
    further: list[JointSet],
    pairs: np.ndarray,
    start: np.ndarray,
    normal: np.ndarray,
    shift: np.ndarray,
) -> np.ndarray:
    """Return the stiffness, normal and shear [2, c], Pa/m, of contacts between pairs of blocks [c,
    2] that belong to no set of joints or cuts: the rock on both sides in series.

    start : a point of each contact [c, d], m. normal : [c, d]. shift : offset of blocks j across
    periodic sides [c, d], m. Next to another region, half a block has the compliance of its
    region's joints parallel to the contact, if there are any.
    """
    if not len(pairs):
        return np.zeros((2, 0))
    shares, found = rock_shares(scene, further), np.zeros((len(pairs), 2))
    moduli = [wave_moduli(one) for one in rocks_of(scene)]
    corners = cut.body.corners(cut.body.halves())
    first = np.searchsorted(corners[:, 0], np.arange(cut.count + 1))
    for c, (pair, n) in enumerate(zip(pairs, normal, strict=True)):
        regions = cut.body.region[pair]
        for side, (block, region) in enumerate(zip(pair, regions, strict=True)):
            share = shares[region]
            at = share.parallel_to(n) if regions[0] != regions[1] else -1
            if at >= 0:
                own = corners[first[block] : first[block + 1], 1]
                thickness = np.ptp(cut.body.vertices[own] @ n)
                found[c] += share.compliance[at] * thickness / 2
            else:
                reach = abs((start[c] - side * shift[c] - cut.centroid[block]) @ n)
                found[c] += reach / moduli[region]
    return (1 / found).T


def against(scene: RockMass) -> str | None:
    """Return why rigid blocks cannot represent a scene; None if they can. Blocks between single
    joints can only if no wave has to be resolved."""
    if scene.domain.mesh is not None:
        return "cannot make rigid blocks from the cells of domain.mesh"
    if (rock := scene.domain.given) is not None:
        if scene.numerics.dem.block is not None:
            return "has no effect on domain.blocks, which are rigid as they are"
        if scene.boundaries.sides("periodic"):
            return "cannot be cut along periodic sides where domain.blocks are given"
        if (rock.joint_set[rock.inner] == NO_SET).any():
            return "cannot join domain.blocks at their contacts that belong to no joint set"
    frequency, size = highest_frequency(scene), scene.domain.extent.max()
    slowest = min(float(elastic_rock(one).s_speed) for one in rocks_of(scene))
    drives_waves = frequency is not None and slowest < LEAST_BLOCKS * size * frequency
    if scene.numerics.dem.block is not None or (scene.joint_sets and not drives_waves):
        return None
    names = [*(f"region {one.name!r}" for one in scene.regions), "this domain"]
    for name, one in zip(names, within(scene, scene.joint_sets), strict=True):
        if not any(joints.spacing for joints in one.joint_sets):
            if scene.domain.given is not None:
                return (
                    "cannot divide domain.blocks, and waves pass these only where joint_sets have "
                    "a spacing (m), by which the joints have the compliance of the rock between"
                )
            has = "has only single joints" if one.joint_sets else "has no joints"
            return (
                "is required (m): waves pass rigid blocks only by the joints between them, and "
                f"{name} {has}"
            )
    return None
