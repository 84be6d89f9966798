"""Criteria for blocks and joints in the plane: thin ones, short contacts, contrasts, friction."""

from math import hypot, inf, radians, tan
from typing import Any

import numpy as np

from cases.loads import history_of, step_means
from cases.material.contact_points import contact_points
from cases.material.rigid_blocks import rigid_joints
from cases.material.rigid_step import jump
from cases.material.rock import elastic_rock
from cases.partition.blocks import Partition
from cases.partition.locate import block_at
from cases.partition.scene import partition_of
from cases.schema.rock_mass import RockMass
from compare.engines import solve
from compare.exact.rock_mass.block_lattice import at_points, masses
from compare.exact.schemes.leapfrog import modes, of_modes
from compare.experiments.robustness.case import EPS, STEP, CaseTrial, Judgement, criterion
from compare.experiments.robustness.criteria.accuracy import (
    CUBES,
    ERROR,
    FIFTHS,
    REFEREE,
    SECOND_ORDER,
    peak,
    phase_error,
)
from compare.experiments.robustness.criteria.layers import ROUND_OFF
from compare.misfit.metrics import relative_l2
from results.dataset import energy_residual

QUANTITIES = ("velocity", "displacement", "traction")


@criterion("misfit of displacements from leapfrog on these blocks in closed form, round-off")
def as_leapfrog(trial: CaseTrial) -> Judgement:
    """Free blocks under a force move as leapfrog on their modes does in closed form.

    The modes are singular vectors of the roots of all contacts' stiffnesses, from the partition and
    the joints' laws alone. Leapfrog errs by round-off, some eps a step.
    """
    scene, result = trial.rock_mass, trial.result
    partition, dt = partition_of(scene), float(result.attrs["dt"])
    steps = np.rint(result["time"].values / dt).astype(int)
    (load,) = scene.loads
    force = step_means(history_of(load, load.amplitude), dt, int(steps[-1]) + 1)
    own = modes(masses(scene, partition), _root(scene, partition))
    u = of_modes(own, _unit(scene, partition), force, steps, dt)
    exact = at_points(scene, partition, u.T).swapaxes(1, 2)
    bound = ROUND_OFF * float(result.attrs["steps"])
    found = relative_l2(result["displacement"].values, exact)
    return Judgement(found, bound, f"misfit; {partition.count} blocks, {steps[-1]:,} steps")


def _root(scene: RockMass, partition: Partition) -> np.ndarray:
    """Return R [2 p, 3 N] of K = R^T R: sqrt(k) times the opening and the slip of every point."""
    contacts, joints = partition.contacts, rigid_joints(scene, [])
    points = contact_points(partition, contacts, scene.joint_sets)
    normal, own = contacts.normal[points.contact], contacts.joint_set[points.contact]
    along = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    found = np.zeros((2, len(own), partition.count, 3))
    each = np.arange(len(own))
    for row, axis, k in zip(found, (normal, along), (joints.normal, joints.shear), strict=True):
        weight = np.sqrt(k[own] * points.length)[:, None]
        for side, sign in ((0, -1), (1, 1)):
            block = contacts.blocks[points.contact, side]
            row[each, block] = sign * weight * jump(axis, points.arm[:, side])
    return found.reshape(2 * len(own), -1)


def _unit(scene: RockMass, partition: Partition) -> np.ndarray:
    """Return the forces on all degrees of freedom [3 N] per unit of the load."""
    (load,) = scene.loads
    at = np.array([load.at])
    (block,) = block_at(partition, at)
    found = np.zeros((partition.count, 3))
    found[block] = jump(np.array([load.direction]), at - partition.centroid[block])[0]
    return found.ravel()


@criterion("imbalance over the work, round-off")
def balanced(trial: CaseTrial) -> Judgement:
    """The ledger of explicit steps closes to round-off, whatever the blocks.

    Joints are linear, or slide under compression: what friction takes is then what the work of the
    shear force has not stored. Where they open a step's trapezoid is off (`contact.KINKS`).
    """
    steps = float(trial.result.attrs["steps"])
    found = energy_residual(trial.result)
    return Judgement(found, ROUND_OFF * steps, f"of the work, after {steps:,.0f} steps")


@criterion(SECOND_ORDER)
def near_lattice(trial: CaseTrial) -> Judgement:
    """Waves through rigid blocks are those of the blocks exactly in time, to the phase error."""
    exact = solve("block-lattice", trial.rock_mass)
    found = relative_l2(trial.result["velocity"].values, exact["velocity"].values)
    return Judgement(found, phase_error(trial, trial.result) + REFEREE, "misfit of velocities")


@criterion("misfit from the exact joints, at most the error of steps and quadratic elements")
def near_joints(trial: CaseTrial) -> Judgement:
    """Plane waves at parallel joints are the exact ones, at any angle.

    The exact field enters at all sides, so a wave is wrong by the phase that it loses on its way
    through the domain: t = diagonal / b with S waves' speed b, in steps C (omega dt)^2 omega t, in
    elements of size h (omega h / b)^4 omega t / 2880 (`accuracy.element_error`). Between nodes a
    quadratic is off by |u'''| h^3 / (72 sqrt 3), 1 / 125 of (omega h / b)^3 u. The worst of
    velocity, displacement and traction.
    """
    scene, result = trial.rock_mass, trial.result
    name = "oblique-joint" if len(scene.joint_sets) == 1 else "parallel-joints"
    exact, omega = solve(name, scene), peak(trial)
    found = max(relative_l2(result[q].values, exact[q].values) for q in QUANTITIES)
    size, b = scene.numerics.continuum.size, float(elastic_rock(scene.rock).s_speed)
    assert size is not None
    way = omega * hypot(*np.ptp(scene.domain.corners, axis=0)) / b
    in_element = omega * size / b
    bound = ERROR[trial.scheme] * (omega * float(result.attrs["dt"])) ** 2 * CUBES * way
    bound += in_element**4 / 2880 * FIFTHS * way + in_element**3 / 125 * CUBES
    return Judgement(found, bound + REFEREE, f"misfit from {name}")


@criterion("misfit from the scene without the stiff set, at most its compliance")
def without_stiff_set(trial: CaseTrial) -> Judgement:
    """Blocks on the far stiffer set are one block: the scene without that set, at the same step.

    A set of compliance delta over that of what lies between (joints of rigid blocks, confined rock
    over its spacing) lowers a frequency by at most delta / 2 of it in the mean over stresses, here
    taken four times for their concentration: 2 delta omega t of phase, and delta at once. Solving
    with a stiffness 1 / delta as large as the rock's, implicit steps add eps / delta; others an eps
    a step.
    """
    result, scene = trial.result, trial.rock_mass
    soft, stiff = scene.joint_sets
    alone: dict[str, Any] = {"joint_sets": [soft.model_dump(exclude_unset=True)]}
    if not trial.is_implicit:
        plain = trial.engine.prepare(trial.read(**alone))
        alone[STEP] = float(result.attrs["dt"]) / plain.critical * (1 + 1e-12)
    other = trial.run(**alone)
    if not np.isclose(result.attrs["dt"], other.attrs["dt"], rtol=1e-9):
        return Judgement(inf, 0.0, "the steps differ")
    own = (soft.normal_stiffness or 0.0) / (stiff.normal_stiffness or inf)
    if not trial.engine.has_rigid_blocks:
        rock = elastic_rock(scene.rock)
        own = (
            float(rock.p_impedance * rock.p_speed)
            / (stiff.spacing or inf)
            / (stiff.normal_stiffness or inf)
        )
    bound = own * (1 + 2 * peak(trial) * trial.duration)
    bound += EPS / own if trial.is_implicit else ROUND_OFF * float(result.attrs["steps"])
    found = relative_l2(result["displacement"].values, other["displacement"].values)
    return Judgement(found, bound, f"misfit of displacements; {result.attrs['steps']:,} steps")


@criterion("shear stress above friction on the normal stress, over the largest")
def within_friction(trial: CaseTrial) -> Judgement:
    """No joint carries more shear than c + sigma_n tan(phi) where it is closed, to round-off.

    What is recorded is a mean over points of a joint, and the bound is linear in the stress, so it
    holds of the mean. Joints must slide, and stay closed, for the row to say anything.
    """
    scene, result = trial.rock_mass, trial.result
    law = scene.joint_sets[0]
    normal, shear = np.moveaxis(result["traction"].values, -1, 0)
    last = result["energy"].isel(time=-1)
    share = float(last.sel(term="friction") / last.sel(term="work"))
    if not (share > EPS and normal.min() >= 0):
        said = f"friction takes {share:.2g} of the work, least {normal.min():.3g} Pa"
        return Judgement(inf, 0.0, said)
    strength = (law.cohesion or 0.0) + normal * tan(radians(law.friction_angle or 0.0))
    above = float((np.abs(shear) - strength).max() / np.abs(normal).max())
    said = f"of the stress; friction takes {share:.2g} of the work"
    return Judgement(max(above, 0.0), 10 * EPS, said)
