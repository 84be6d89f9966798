"""Scenes of rigid blocks between the joints of a rock mass, exactly in time (`plane.rigid_motion`).

The model of the rigid-block engine without its time steps: joints with the stiffness of those
between rigid blocks (`cases.material.rigid_blocks`), dashpots and the incident field on quiet
sides, a cubic between IN_A_PERIOD samples per period; a twin with half as many bounds the error.

Valid for linear joints without dashpots that cut all of the rock into blocks, waves only, sides
that are quiet, free or periodic, and up to MOST_BLOCKS blocks.
"""

import numpy as np
import xarray as xr

from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.incident import tractions
from jointwave.cases.material.contact_points import contact_points
from jointwave.cases.material.quiet_sides import impedances
from jointwave.cases.material.rigid_blocks import rigid_joints, welds
from jointwave.cases.material.rock_mass import Stiffness, inertia
from jointwave.cases.partition.blocks import Partition
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.locate import sides_at
from jointwave.cases.partition.periodic import across_periodic
from jointwave.cases.partition.scene import block_count, partition_of
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.exact.linear import bound
from jointwave.compare.exact.plane.rigid_motion import (
    Points,
    RigidSystem,
    forces_of,
    motion,
    points_on,
    stiffness_of,
    viscosity_of,
)
from jointwave.compare.exact.rock_mass.conditions import beyond_linear_rock
from jointwave.compare.exact.rock_mass.field import field_of
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.rock_mass import rock_mass_dataset

MOST_BLOCKS = 1000
IN_A_PERIOD = 400  #: samples of the field per period per period


def applies(scene: RockMass) -> Answer:
    """Return whether only waves act, on blocks between linear joints."""
    held, sets = scene.boundaries.model_dump().values(), scene.joint_sets
    gravity = scene.gravity is not None and bool(scene.gravity.acceleration)
    many = f"more than {MOST_BLOCKS:,} blocks"
    reasons = [
        (not scene.waves, "no wave enters"),
        (bool(scene.loads), "a load acts"),
        (gravity, "gravity acts"),
        (scene.prestress is not None, "the rock is prestressed"),
        (bool(scene.regions), "regions differ in rock"),
        ("fixed" in held, "a side is fixed"),
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
    partition, times = partition_of(scene, further_sets(scene)), sample_times(scene)
    quiet = _quiet(scene, partition)
    impedance = impedances(scene, quiet.normal, partition.region[quiet.block])
    system = RigidSystem(
        masses(scene, partition),
        _stiffness(scene, partition),
        viscosity_of(quiet, impedance, partition.count),
    )
    period = shortest_period(scene.waves)
    assert period is not None
    stride = 2 * int(np.ceil(scene.interval * IN_A_PERIOD / period / 2))
    fine = scene.interval / stride * np.arange(stride * (len(times) - 1) + 1)
    field = field_of(scene)
    face = tractions(field, quiet.place, quiet.normal, impedance, fine)
    forces = forces_of(quiet, face.values, partition.count)
    found, twin = (
        [at_points(scene, partition, x) for x in motion(system, some, step, samples)]
        for some, step, samples in (
            (forces, fine[1], stride),
            (forces[::2], 2 * fine[1], stride // 2),
        )
    )
    names = ("displacement", "velocity")
    values = {name: x.swapaxes(1, 2) for name, x in zip(names, found, strict=True)}
    errors = {name: bound(*pair) for name, *pair in zip(names, found, twin, strict=True)}
    return rock_mass_dataset(scene, SOLVER.name, times, values, errors=errors)


def _quiet(scene: RockMass, partition: Partition) -> Points:
    """Return the points of the edges of quiet sides."""
    edges, held = partition.boundary, scene.boundaries.model_dump()
    names = np.array([held.get(name) == "quiet" for name in partition.sides])
    own = names[edges.side]
    chosen = (getattr(edges, key)[own] for key in ("block", "start", "end", "normal"))
    return points_on(partition.centroid, *chosen)


def masses(scene: RockMass, partition: Partition) -> np.ndarray:
    """Return masses (kg) and moments of inertia (kg m2) of all degrees of freedom [3 N], per m."""
    own = inertia(partition, scene.rock.density)
    return np.stack([own.mass, own.mass, own.moment], axis=1).ravel()


def _stiffness(scene: RockMass, partition: Partition):
    """Return the stiffness of all contacts, those across periodic sides included."""
    further, total = further_sets(scene), 0
    joints, sets = rigid_joints(scene, further), [*scene.joint_sets, *further]
    parts = [(partition.contacts, np.zeros(2))]
    parts += [(one.contacts, one.shift) for one in across_periodic(scene, partition)]
    for contacts, shift in parts:
        points = contact_points(partition, contacts, sets, shift)
        own, rock = contacts.joint_set, contacts.joint_set == NO_SET
        stiffness = Stiffness(joints.normal[own], joints.shear[own])
        pairs, start, normal = contacts.blocks[rock], contacts.start[rock], contacts.normal[rock]
        weld = welds(
            scene, partition, further, pairs, start, normal, np.tile(shift, (len(pairs), 1))
        )
        stiffness.normal[rock], stiffness.shear[rock] = weld
        total = total + stiffness_of(partition.count, contacts, points, stiffness)
    return total


def at_points(scene: RockMass, partition: Partition, values: np.ndarray) -> np.ndarray:
    """Return the motion of the points of a scene [points, (x, y), n] from that of all blocks'
    degrees of freedom [n, 3 N]; on joints the mean of the blocks there."""
    points = np.array(scene.record.points)
    sides = sides_at(partition, points)
    share = np.array([1 / len(blocks) for blocks in sides for _ in blocks])[:, None]
    which = np.repeat(np.arange(len(points)), [len(blocks) for blocks in sides])
    block = np.concatenate(sides)
    u, v, turn = values.reshape(len(values), -1, 3)[:, block].transpose(2, 1, 0)
    x, y = (points[which] - partition.centroid[block]).T[..., None]
    found = np.zeros((len(points), 2, len(values)))
    np.add.at(found, which, np.stack([u - turn * y, v + turn * x], axis=1) * share[..., None])
    return found


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
