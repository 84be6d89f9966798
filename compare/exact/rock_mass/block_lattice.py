"""Rigid blocks between the joints of a rock mass, exact in time (`blocks.system`).

The rigid-block engine's model without time steps: joints with the stiffness of those between rigid
blocks (`cases.material.rigid_blocks`), dashpots and the incident field on quiet sides, with cubic
interpolation between IN_A_PERIOD samples per period. Taylor series (`blocks.events`) are accurate
to round-off; a perturbed twin with half as many samples bounds the error.

Valid for linear joints without dashpots that cut all of the rock into blocks, waves only, quiet,
free or periodic sides, and up to MOST_BLOCKS blocks.
"""

from itertools import product

import numpy as np
import xarray as xr
from scipy.sparse import bsr_array, csr_array

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.cell_complex import NO_SET
from jointwave.cases.geometry.locate import sides_at
from jointwave.cases.incident import tractions
from jointwave.cases.material.contact_points import bending
from jointwave.cases.material.quiet_sides import impedances
from jointwave.cases.material.rigid_blocks import rigid_joints, welds
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.partition.scene import across_periodic, block_count, blocks_of_scene
from jointwave.cases.partition.shape import shape_of
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.compare.exact.blocks.events import NOISE, Loads, integrate
from jointwave.compare.exact.blocks.system import Contacts, carried, contacts_of, first_order
from jointwave.compare.exact.linear import bound
from jointwave.compare.exact.rock_mass.conditions import holds
from jointwave.compare.exact.rock_mass.field import field_of
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

MOST_BLOCKS = {2: 1000, 3: 500}  #: by the number of dimensions
FREEDOMS = {2: 3, 3: 6}  #: of a block, by the number of dimensions
IN_A_PERIOD = 400  #: samples of the field per period


def applies(scene: RockMass) -> Answer:
    """Return whether only waves act, on blocks between linear joints."""
    held, sets = set(scene.boundaries.model_dump().values()), scene.joint_sets
    stuck = sorted(held - {None, "quiet", "free", "periodic"})
    most = MOST_BLOCKS[scene.domain.dimension]
    return holds(
        scene,
        ("waves", "openings"),
        (bool(stuck), f"a side is {' and '.join(stuck)}"),
        (scene.numerics.dem.block is not None, "intact rock is subdivided into blocks"),
        (not any(one.spacing for one in sets), "no joint set has a spacing"),
        (any(one.time_scale is None for one in scene.waves), "a wave has no period"),
        (not scene.record.points, "no point is recorded"),
    ) and Answer.unless((block_count(scene.domain, sets) > most, f"more than {most:,} blocks"))


def solve(scene: RockMass) -> xr.Dataset:
    """Return velocity and displacement at the points of a scene."""
    from scipy.interpolate import CubicSpline

    blocks, times = blocks_of_scene(scene, further_sets(scene)), sample_times(scene)
    quiet, edges = _quiet(scene, blocks)
    parts = zip(*_between_blocks(scene, blocks), quiet, strict=True)
    contacts = Contacts(*map(np.concatenate, parts))
    period = shortest_period(scene.waves)
    assert period is not None
    stride = 2 * int(np.ceil(scene.interval * IN_A_PERIOD / period / 2))
    fine = scene.interval / stride * np.arange(stride * (len(times) - 1) + 1)
    freedoms, forces = _incident(scene, blocks, quiet, edges, fine)
    (mass, axes), dim = masses(scene, blocks), scene.domain.dimension
    system = first_order(mass, contacts, axes=axes)
    system = system._replace(load=(system.driven @ axes.T)[:, freedoms].T)
    points, found = reads(scene, blocks) @ axes, []
    for step, noise in ((1, 0.0), (2, NOISE)):
        loads = Loads(CubicSpline(fine[::step], forces[::step]), fine[::step])
        states = integrate(system, loads, times, noise=noise).states.T
        both = np.stack([points @ (x @ states) for x in (system.displacement, system.velocity)])
        found.append(both.reshape(2, -1, dim, len(times)))
    names = ("displacement", "velocity")
    values = {name: x.swapaxes(1, 2) for name, x in zip(names, found[0], strict=True)}
    errors = {name: bound(*pair) for name, *pair in zip(names, *found, strict=True)}
    return dataset(scene, SOLVER.name, times, values, errors=errors)


def masses(scene: RockMass, blocks: Blocks) -> tuple[np.ndarray, csr_array]:
    """Return masses (kg) and principal moments of inertia (kg m2) of all blocks [N, f], in the
    plane per m; and the sparse matrix [N f, N f] from motion with rotations about principal axes to
    motion with rotations about the scene's axes."""
    count, dim = blocks.centroid.shape
    inertia = np.trace(blocks.second_moment, axis1=1, axis2=2)[:, None, None] * np.eye(1)
    if dim == 3:
        inertia = inertia * np.eye(3) - blocks.second_moment
    moments, turn = np.linalg.eigh(inertia)
    each = np.tile(np.eye(dim + len(turn[0])), (count, 1, 1))
    each[:, dim:, dim:] = turn
    axes = csr_array(bsr_array((each, np.arange(count), np.arange(count + 1))))
    return scene.rock.density * np.hstack([np.tile(blocks.volume, (dim, 1)).T, moments]), axes


def _between_blocks(scene: RockMass, blocks: Blocks) -> list[Contacts]:
    """Return the contacts between blocks, including those across periodic sides."""
    further, parts = further_sets(scene), []
    joints, sets = rigid_joints(scene, further), [*scene.joint_sets, *further]
    springs = np.stack([joints.normal, joints.shear], axis=1)
    bends = np.array([bending(one.point_rule, one.contact_points) for one in sets])
    across = [(one.contacts, one.shift) for one in across_periodic(scene, blocks)]
    for facets, shift in [(blocks.contacts, np.zeros(blocks.body.dim)), *across]:
        k, share = springs[facets.joint_set], bends[facets.joint_set]
        rock = facets.joint_set == NO_SET
        weld = facets.blocks[rock], facets.centroid[rock], facets.normal[rock]
        shifts = np.tile(shift, (len(weld[0]), 1))
        k[rock] = welds(scene, blocks, further, *weld, shifts).T
        share[rock] = 1.0
        none = np.zeros((len(k), *2 * facets.normal.shape[1:]))
        parts.append(contacts_of(blocks, facets, k, none, share, shift))
    return parts


def _quiet(scene: RockMass, blocks: Blocks) -> tuple[Contacts, np.ndarray]:
    """Return the dashpots on facets of quiet sides, and orthogonal unit vectors in each facet [c, d
    - 1, d], the first along its first edge."""
    outer, held = blocks.boundary, scene.boundaries.model_dump()
    own = np.array([held.get(name) == "quiet" for name in shape_of(scene.domain).sides])[outer.side]
    impedance = np.zeros((len(own), *2 * outer.normal.shape[1:]))
    regions = blocks.body.region[outer.blocks[own, 0]]
    impedance[own] = impedances(scene, outer.normal[own], outer.centroid[own], regions)
    found = contacts_of(blocks, outer, np.zeros((len(own), 2)), impedance)
    corners, first, normal = *outer.outlines, outer.normal[own]
    edge = (corners[first[:-1] + 1] - corners[first[:-1]])[own]
    edge = edge / np.linalg.norm(edge, axis=1)[:, None]
    edges = [edge] if normal.shape[1] == 2 else [edge, np.cross(normal, edge)]
    return Contacts(*(x[own] for x in found)), np.stack(edges, axis=1)


def _incident(
    scene: RockMass, blocks: Blocks, quiet: Contacts, edges: np.ndarray, times: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the degrees of freedom [k] of blocks on quiet sides, and the incident field's forces
    on them [n, k], N and N m, in the plane per m. Each facet has points one standard deviation of
    its area from the centroid, along its first edge and across: Gauss points of a rectangle."""
    dim, area = quiet.normal.shape[1], quiet.area[:, None, None]
    variance, axes = np.linalg.eigh(quiet.second / area)
    deviation = (axes * np.sqrt(np.maximum(variance, 0.0))[:, None]) @ axes.swapaxes(1, 2)
    signs = np.array(list(product((-1.0, 1.0), repeat=dim - 1)))
    arm = (quiet.arm[:, :1] + signs @ edges @ deviation).reshape(-1, dim)
    block, normal, impedance, share = (
        np.repeat(x, len(signs), axis=0)
        for x in (quiet.blocks[:, 0], quiet.normal, quiet.dashpots, area / len(signs))
    )
    found = tractions(field_of(scene), blocks.centroid[block] + arm, normal, impedance, times)
    pushes = share * carried(arm, f := FREEDOMS[dim])[:, :dim]
    own, which = np.unique(block, return_inverse=True)
    forces = np.zeros((len(own), len(times), f))
    np.add.at(forces, which, np.einsum("npi,pij->pnj", found.values, pushes))
    freedoms = (f * own[:, None] + np.arange(f)).ravel()
    return freedoms, forces.swapaxes(0, 1).reshape(len(times), -1)


def reads(scene: RockMass, blocks: Blocks) -> csr_array:
    """Return the sparse matrix [d points, f N] from the motion of all blocks to that of a scene's
    points; on joints the mean of the blocks there."""
    points, dim = scene.places["points"], scene.domain.dimension
    sides = sides_at(blocks, points, len(scene.joint_sets))
    count = np.array(list(map(len, sides)))
    which, block = np.repeat(np.arange(len(points)), count), np.concatenate(sides)
    parts = carried(points[which] - blocks.centroid[block], FREEDOMS[dim])[:, :dim]
    parts = parts / count[which][:, None, None]
    first, shape = np.append(0, np.cumsum(count)), (dim * len(points), FREEDOMS[dim] * blocks.count)
    return csr_array(bsr_array((parts, block, first), shape=shape))


SOLVER = Solver(
    name="block-lattice",
    rock=Rock.RIGID_BLOCKS,
    kinds=("rock mass",),
    dimension=3,
    in_space=True,
    label="rigid blocks, exact",
    line=thin("#00349a", 9, (0, 9)),
    applies=applies,
    run=solve,
    distances={Kind.NUMERICAL: {"dem": "time stepping of the rigid blocks"}},
)
