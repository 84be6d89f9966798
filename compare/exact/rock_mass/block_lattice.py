"""Scenes of rigid blocks between the joints of a rock mass, exactly in time (`blocks.system`).

The model of the rigid-block engine without its time steps: joints with the stiffness of those
between rigid blocks (`cases.material.rigid_blocks`), dashpots and the incident field on quiet
sides, a cubic between IN_A_PERIOD samples per period. Taylor series (`blocks.events`) err by
round-off; a perturbed twin with half as many samples bounds the error.

Valid for linear joints without dashpots that cut all of the rock into blocks, waves only, sides
that are quiet, free or periodic, and up to MOST_BLOCKS blocks.
"""

import numpy as np
import xarray as xr
from scipy.sparse import bsr_array, csr_array

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.geometry.locate import sides_at
from jointwave.cases.incident import tractions
from jointwave.cases.material.contact_points import bending, points_of
from jointwave.cases.material.quiet_sides import impedances
from jointwave.cases.material.rigid_blocks import rigid_joints, welds
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.periodic import across_periodic
from jointwave.cases.partition.scene import block_count, blocks_of_scene
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.exact.blocks.events import NOISE, Loads, integrate
from jointwave.compare.exact.blocks.system import Contacts, carried, contacts_of, first_order
from jointwave.compare.exact.linear import bound
from jointwave.compare.exact.rock_mass.conditions import beyond_linear_rock
from jointwave.compare.exact.rock_mass.field import field_of
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.rock_mass import rock_mass_dataset

MOST_BLOCKS = 1000
IN_A_PERIOD = 400  #: samples of the field per period per period


def applies(scene: RockMass) -> Answer:
    """Return whether only waves act, on blocks between linear joints."""
    held, sets = set(scene.boundaries.model_dump().values()), scene.joint_sets
    stuck = sorted(held - {None, "quiet", "free", "periodic"})
    gravity = scene.gravity is not None and bool(scene.gravity.acceleration)
    many = f"more than {MOST_BLOCKS:,} blocks"
    reasons = [
        (not scene.waves, "no wave enters"),
        (bool(scene.loads), "a load acts"),
        (gravity, "gravity acts"),
        (scene.prestress is not None, "the rock is prestressed"),
        (bool(scene.regions), "regions differ in rock"),
        (bool(stuck), f"a side is {' and '.join(stuck)}"),
        (scene.numerics.dem.block is not None, "intact rock is subdivided into blocks"),
        (not any(one.spacing for one in sets), "no joint set has a spacing"),
        (any(one.damping_ratio for one in sets), "the joints are damped"),
        (any(one.time_scale is None for one in scene.waves), "a wave has no period"),
        (not scene.record.points, "no point is recorded"),
    ]
    reason = beyond_linear_rock(scene) or next((why for there, why in reasons if there), None)
    if reason is None and block_count(scene.domain, sets) > MOST_BLOCKS:
        reason = many
    return Answer(reason or "")


def solve(scene: RockMass) -> xr.Dataset:
    """Return velocity and displacement at the points of a scene."""
    from scipy.interpolate import CubicSpline

    blocks, times = blocks_of_scene(scene, further_sets(scene)), sample_times(scene)
    quiet = _quiet(scene, blocks)
    parts = zip(*_between_blocks(scene, blocks), quiet, strict=True)
    contacts = Contacts(*map(np.concatenate, parts))
    period = shortest_period(scene.waves)
    assert period is not None
    stride = 2 * int(np.ceil(scene.interval * IN_A_PERIOD / period / 2))
    fine = scene.interval / stride * np.arange(stride * (len(times) - 1) + 1)
    freedoms, forces = _incident(scene, blocks, quiet, fine)
    system = first_order(masses(scene, blocks), contacts)
    system = system._replace(load=system.driven[:, freedoms].T)
    points, found = reads(scene, blocks), []
    for step, noise in ((1, 0.0), (2, NOISE)):
        loads = Loads(CubicSpline(fine[::step], forces[::step]), fine[::step])
        states = integrate(system, loads, times, noise=noise).states.T
        both = np.stack([points @ (x @ states) for x in (system.displacement, system.velocity)])
        found.append(both.reshape(2, -1, 2, len(times)))
    names = ("displacement", "velocity")
    values = {name: x.swapaxes(1, 2) for name, x in zip(names, found[0], strict=True)}
    errors = {name: bound(*pair) for name, *pair in zip(names, *found, strict=True)}
    return rock_mass_dataset(scene, SOLVER.name, times, values, errors=errors)


def masses(scene: RockMass, blocks: Blocks) -> np.ndarray:
    """Return masses (kg) and moments of inertia (kg m2) of all blocks [N, 3], per m."""
    polar = np.trace(blocks.second_moment, axis1=1, axis2=2)
    return scene.rock.density * np.stack([blocks.volume, blocks.volume, polar], axis=1)


def _between_blocks(scene: RockMass, blocks: Blocks) -> list[Contacts]:
    """Return the contacts of blocks, and those across periodic sides."""
    further, parts = further_sets(scene), []
    joints, sets = rigid_joints(scene, further), [*scene.joint_sets, *further]
    springs = np.stack([joints.normal, joints.shear], axis=1)
    bends = np.array([bending(one.point_rule, one.contact_points) for one in sets])
    across = [(one.contacts, one.shift) for one in across_periodic(scene, blocks)]
    for facets, shift in [(blocks.contacts, np.zeros(2)), *across]:
        k, share = springs[facets.joint_set], bends[facets.joint_set]
        rock = facets.joint_set == NO_SET
        weld = facets.blocks[rock], facets.centroid[rock], facets.normal[rock]
        shifts = np.tile(shift, (len(weld[0]), 1))
        k[rock] = np.stack(welds(scene, blocks, further, *weld, shifts), axis=1)
        share[rock] = 1.0
        parts.append(contacts_of(blocks, facets, k, 0 * k, share, shift))
    return parts


def _quiet(scene: RockMass, blocks: Blocks) -> Contacts:
    """Return the dashpots of the facets of quiet sides."""
    outer, held = blocks.boundary, scene.boundaries.model_dump()
    own = np.array([held.get(name) == "quiet" for name in shape_of(scene.domain).sides])[outer.side]
    impedance = np.zeros((len(own), 2))
    regions = blocks.body.region[outer.blocks[own, 0]]
    impedance[own] = impedances(scene, outer.normal[own], regions)
    found = contacts_of(blocks, outer, 0 * impedance, impedance)
    return Contacts(*(x[own] for x in found))


def _incident(
    scene: RockMass, blocks: Blocks, quiet: Contacts, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the freedoms [k] of blocks on quiet sides, and the forces on them [n, k], N and N m
    per m, of the incident field at two Gauss points of each facet."""
    x, weight = points_of("gauss", 2)
    along = np.stack([-quiet.normal[:, 1], quiet.normal[:, 0]], axis=1) * quiet.area[:, None]
    arm = (quiet.arm[:, :1] + (x - 0.5)[:, None] * along[:, None]).reshape(-1, 2)
    block, impedance = np.repeat(quiet.blocks[:, 0], 2), np.repeat(quiet.dashpots, 2, axis=0)
    place, normal = blocks.centroid[block] + arm, np.repeat(quiet.normal, 2, axis=0)
    found = tractions(field_of(scene), place, normal, impedance, times)
    pushes = np.outer(quiet.area, weight).ravel()[:, None, None] * carried(arm, 3)[:, :2]
    own, which = np.unique(block, return_inverse=True)
    forces = np.zeros((len(own), len(times), 3))
    np.add.at(forces, which, np.einsum("npi,pij->pnj", found.values, pushes))
    freedoms = (3 * own[:, None] + np.arange(3)).ravel()
    return freedoms, forces.swapaxes(0, 1).reshape(len(times), -1)


def reads(scene: RockMass, blocks: Blocks) -> csr_array:
    """Return the matrix from the motion of all blocks to that of the points of a scene, sparse
    [2 points, 3 N]; on joints the mean of the blocks there."""
    points = np.array(scene.record.points)
    sides = sides_at(blocks, points, len(scene.joint_sets))
    count = np.array(list(map(len, sides)))
    which, block = np.repeat(np.arange(len(points)), count), np.concatenate(sides)
    parts = carried(points[which] - blocks.centroid[block], 3)[:, :2]
    parts = parts / count[which][:, None, None]
    first, shape = np.append(0, np.cumsum(count)), (2 * len(points), 3 * blocks.count)
    return csr_array(bsr_array((parts, block, first), shape=shape))


SOLVER = Solver(
    name="block-lattice",
    rock=Rock.RIGID_BLOCKS,
    kinds=("rock mass",),
    dimension=2,
    label="rigid blocks in the plane, exact",
    line=thin("#00349a", 9, (0, 9)),
    applies=applies,
    run=solve,
    distances={Kind.NUMERICAL: {"dem": "time stepping of the rigid blocks in the plane"}},
)
