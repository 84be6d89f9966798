"""Blocks and joints in the plane: thin ones, short contacts, contrasts, friction."""

from math import hypot, inf, radians, tan

import numpy as np
import pytest

from closed_forms.modes import modes, of_modes
from hard_runs import CUBES, EPS, ERROR, FIFTHS, REFEREE, ROUND_OFF, HardRun
from jointwave.cases.geometry.locate import blocks_at
from jointwave.cases.geometry.measure import frames_of
from jointwave.cases.loads import history_of, step_means
from jointwave.cases.material.rigid_blocks import rigid_joints
from jointwave.cases.material.rock import elastic_rock
from jointwave.cases.partition.scene import blocks_of_scene
from jointwave.compare.engines import solve
from jointwave.compare.exact.blocks.system import carried, contacts_of, relative
from jointwave.compare.exact.rock_mass.block_lattice import masses, reads
from jointwave.compare.misfit.metrics import relative_l2

BRICKS, GRAZING, SLIDING = "hard/struck-bricks", "hard/grazing-wave", "hard/sliding-bricks"
LAW = {"normal_stiffness": 2e10, "shear_stiffness": 8e9}
BEDS = {"name": "bed", "dip": 0.0, "spacing": 1.0} | LAW
#: Two blocks of a set that is far stiffer are one block, in bending too.
STIFF = {"name": "stiff", "dip": 90.0, "spacing": 2.0}
STIFF |= {"normal_stiffness": 2e18, "shear_stiffness": 8e17}
CONTRAST = {"domain.size": [4.0, 2.0], "joint_sets": [BEDS, STIFF], "rock.intact_modulus": 1e29}
CORNER = [[0.0, 0.0], [0.5, 0.0], [1.0, 0.999], [1.5, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]
HELD = {
    "domain": {"outline": CORNER, "least_width": 1e-4, "least_angle": 0.01},
    "joint_sets": [{"name": "cross", "dip": 90.0, "spacing": 1.0} | LAW],
}
VARIANTS = (
    "",
    "contacts a thousandth as long as their blocks",
    "blocks a thousandth as thin as their neighbours",
    "blocks that end in a point of one degree",
)
BODIES = {name or "bricks": ({}, name) for name in VARIANTS}
BODIES |= {"a block held by one corner": (HELD, ""), "a contrast of 1e8": (CONTRAST, "")}


@pytest.mark.parametrize(("changes", "variant"), BODIES.values(), ids=BODIES)
def test_free_blocks_move_as_leapfrog_in_closed_form(changes, variant):
    """The modes are singular vectors of the roots of all contacts' stiffnesses, from the partition
    and the joints' laws alone. Leapfrog errs by round-off, some eps a step."""
    run = HardRun("dem", "leapfrog", changes, BRICKS, variant)
    partition = blocks_of_scene(run.scene)
    steps = np.rint(run.result["time"].values / run.dt).astype(int)
    (load,) = run.scene.loads
    force = step_means(history_of(load, load.amplitude), run.dt, np.arange(int(steps[-1]) + 1))
    own = modes(masses(run.scene, partition)[0].ravel(), root_of(run.scene, partition))
    u = of_modes(own, unit_force(run.scene, partition), force, steps, run.dt)
    exact = (reads(run.scene, partition) @ u).reshape(-1, 2, len(steps)).swapaxes(1, 2)
    assert relative_l2(run.result["displacement"].values, exact) <= ROUND_OFF * run.steps


def root_of(scene, partition):
    """Return R [3 c, 3 N] of K = R^T R: sqrt(k) times what each contact opens, slips and turns."""
    contacts, joints = partition.contacts, rigid_joints(scene, [])
    springs = np.stack([joints.normal, joints.shear], axis=1)[contacts.joint_set]
    met = contacts_of(partition, contacts, springs, 0 * springs)
    moved = relative(met, partition.count, 3).toarray().reshape(len(contacts), 3, -1)
    moved[:, :2] = frames_of(contacts.normal) @ moved[:, :2]
    bends = springs[:, 0] * np.trace(contacts.second_moment, axis1=1, axis2=2)
    stiffness = np.column_stack([springs * contacts.area[:, None], bends])
    return (np.sqrt(stiffness)[:, :, None] * moved).reshape(-1, 3 * partition.count)


def unit_force(scene, partition):
    """Return the forces on all degrees of freedom [3 N] per unit of the load."""
    (load,) = scene.loads
    at = np.array([load.at])
    ((block, *_),) = blocks_at(partition, at)
    found = np.zeros((partition.count, 3))
    found[block] = load.direction @ carried(at - partition.centroid[block], 3)[0, :2]
    return found.ravel()


def test_waves_through_blocks_at_grazing_incidence_are_those_of_the_lattice():
    """Exactly in time, to the phase error of the steps."""
    run = HardRun("dem", "leapfrog", {}, GRAZING, "blocks, at 88 degrees")
    exact = solve("block-lattice", run.scene)
    found = relative_l2(run.result["velocity"].values, exact["velocity"].values)
    assert found <= run.phase_error() + REFEREE


@pytest.mark.parametrize("name", ["", "at 88 degrees", "two joints a hundredth of a metre apart"])
def test_plane_waves_at_parallel_joints_are_the_exact_ones(name):
    """The exact field enters at all sides, so a wave is wrong by the phase that it loses on its way
    through the domain: t = diagonal / b with S waves' speed b, in steps C (omega dt)^2 omega t, in
    elements of size h (omega h / b)^4 omega t / 2880 (`element_error`). Between nodes a quadratic
    is off by |u'''| h^3 / (72 sqrt 3), 1 / 125 of (omega h / b)^3 u."""
    run = HardRun("continuum-jointed", "explicit", {}, GRAZING, name)
    solver = "oblique-joint" if len(run.scene.joint_sets) == 1 else "parallel-joints"
    exact, b = solve(solver, run.scene), float(elastic_rock(run.scene.rock).s_speed)
    way = run.peak * hypot(*np.ptp(run.scene.domain.corners, axis=0)) / b
    in_element = run.peak * run.scene.numerics.continuum.size / b
    bound = ERROR["explicit"] * (run.peak * run.dt) ** 2 * CUBES * way + REFEREE
    bound += in_element**4 / 2880 * FIFTHS * way + in_element**3 / 125 * CUBES
    for quantity in ("velocity", "displacement", "traction"):
        found = relative_l2(run.result[quantity].values, exact[quantity].values)
        assert found <= bound, quantity


@pytest.mark.parametrize("engine, scheme", [("dem", "leapfrog"), ("continuum-jointed", "explicit")])
def test_no_joint_carries_more_shear_than_friction(engine, scheme):
    """No more than c + sigma_n tan(phi) where it is closed, to round-off. What is recorded is a
    mean over points of a joint, and the bound is linear in the stress, so it holds of the mean.
    Joints must slide, and stay closed, for the test to say anything."""
    run = HardRun(engine, scheme, {}, SLIDING)
    law = run.scene.joint_sets[0]
    normal, shear = np.moveaxis(run.result["traction"].values, -1, 0)
    last = run.result["energy"].isel(time=-1)
    assert float(last.sel(term="friction") / last.sel(term="work")) > 0.01
    assert normal.min() >= 0
    strength = (law.cohesion or 0.0) + normal * tan(radians(law.friction_angle))
    above = float((np.abs(shear) - strength).max() / np.abs(normal).max())
    assert -inf < above <= 10 * EPS
