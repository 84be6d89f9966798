"""From a scene to the constants of its run."""

from math import sqrt

import numpy as np
from scipy.sparse import diags

from cases.calibrate import Properties, calibrate
from cases.loads import load_history, step_means
from cases.sampling import Clock, clock
from cases.scene import Scene
from continuum.critical import critical_bar_step
from continuum.elasticity import Bar, discretise
from continuum.interface import Joints, jump_operator, resolved_joints
from continuum.mesh import elements_in_block, pillar_grid
from continuum.model import (
    Ends,
    Interfaces,
    Model,
    Quiet,
    Receivers,
    Rock,
    State,
    state_at_rest,
)
from continuum.receivers import points, sections
from continuum.sparse import rows


def build(scene: Scene, model: str) -> tuple[Model, State, Clock, float]:
    """Return the model, the state at rest, the clock and the critical step (s) of a scene.

    `model` is "jointed" or "equivalent"; raises SceneError for a step above the critical one.
    """
    p, numerics = calibrate(scene), scene.numerics.continuum
    joints = resolved_joints(p, model)
    speed = sqrt(rock_modulus(p, model) / p.density)
    elements = numerics.elements_per_block or elements_in_block(
        p.spacing, speed, resolved_period(scene), damped=bool(p.time_constant)
    )
    bar = discretise(pillar_grid(p, elements, joints.number), numerics.order)
    critical = critical_step_of(bar, joints, p, model, fixed_nodes(scene, bar))
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "continuum")
    built = build_model(scene, p, bar, joints, time, model)
    return built, state_at_rest(built, scene.record.energy), time, critical


def resolved_period(scene: Scene) -> float:
    """Return the period (s) that elements resolve: the load's, or a tenth of the scene."""
    return scene.load.period or scene.time.duration / 10


def build_model(
    scene: Scene, p: Properties, bar: Bar, joints: Joints, time: Clock, model: str
) -> Model:
    """Return the constants of a scene on a discretised bar, for a given clock."""
    modulus = rock_modulus(p, model)
    mass = p.density * p.area * bar.mass
    read = sections(bar, scene.record.stress)
    return Model(
        rock=Rock(
            stiffness=rows(modulus * p.area * bar.stiffness),
            time_constant=p.time_constant,
            mass=mass,
            step_over_mass=time.dt / mass,
        ),
        interfaces=build_interfaces(bar, joints, p.area),
        ends=Ends(0, quiet_ends(scene, p, mass, time.dt), fixed_nodes(scene, bar)),
        receivers=Receivers(
            rows(points(bar, scene.record.velocity)),
            rows(modulus * read.elastic),
            rows(p.density * read.inertia),
            rows(read.contact) if read.contact.nnz else None,
        ),
        load=p.area * step_means(load_history(scene), time.dt, time.steps + 1),
        dt=time.dt,
    )


def build_interfaces(bar: Bar, joints: Joints, area: float) -> Interfaces | None:
    """Return the interfaces with their law, or None where the bar is whole."""
    if not joints.number.size:
        return None
    jump = jump_operator(bar)
    weight = np.full(jump.shape[0], area)
    return Interfaces(rows(jump), rows(jump.T @ diags(weight)), weight, joints.law())


def quiet_ends(scene: Scene, p: Properties, mass: np.ndarray, dt: float) -> Quiet | None:
    """Return the dashpots of quiet and matched ends, which are one in a continuum, or None."""
    kinds = (scene.ends.start, scene.ends.end)
    node = np.array([0, mass.size - 1])[[kind in ("quiet", "matched") for kind in kinds]]
    if not node.size:
        return None
    impedance = np.full(node.size, p.impedance * p.area)
    return Quiet(node, impedance, impedance * dt / (2 * mass[node]))


def fixed_nodes(scene: Scene, bar: Bar) -> np.ndarray | None:
    """Return the nodes that do not move, or None."""
    return np.array([bar.y.size - 1]) if scene.ends.end == "fixed" else None


def rock_modulus(p: Properties, model: str) -> float:
    """Return the modulus between the interfaces, Pa: of intact rock or of the rock mass."""
    if model == "equivalent":
        return p.modulus
    assert p.intact_modulus is not None
    return p.intact_modulus


def critical_step_of(
    bar: Bar, joints: Joints, p: Properties, model: str, fixed: np.ndarray | None
) -> float:
    """Return the critical step (s) of a bar with its joints all closed, the stiffest state."""
    jump = jump_operator(bar)
    rock = rock_modulus(p, model) * p.area * bar.stiffness
    springs = p.area * jump.T @ diags(joints.stiffness) @ jump
    viscosity = None
    if p.time_constant is not None or joints.time_constant is not None:
        eta = np.zeros(joints.number.size) if joints.time_constant is None else joints.time_constant
        dashpots = p.area * jump.T @ diags(joints.stiffness * eta) @ jump
        viscosity = (p.time_constant or 0.0) * rock + dashpots
    return critical_bar_step(p.density * p.area * bar.mass, rock + springs, viscosity, fixed)
