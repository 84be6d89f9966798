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
    HalfJoints,
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
from joints.ends import HalfSpring, half_spring


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
    critical = critical_step_of(bar, joints, scene, p, model)
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
        ends=Ends(0, quiet_ends(scene, p, mass, time.dt, model), fixed_nodes(scene, bar)),
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


def quiet_ends(
    scene: Scene, p: Properties, mass: np.ndarray, dt: float, model: str
) -> Quiet | None:
    """Return what absorbs at the ends, or None: the dashpot rho c A on the end face.

    In jointed rock a matched end has half a joint in front of it, as the rock beyond would have.
    """
    absorbing = absorbing_ends(scene, p, model, dt)
    if not absorbing:
        return None
    node = np.array([0 if place == "start" else mass.size - 1 for place in absorbing])
    z = p.impedance * p.area
    viscosity = np.array([z if end is None else end.viscosity for end in absorbing.values()])
    springs = None
    if any(absorbing.values()):
        none = (0.0, 0.0, 0.0)
        parts = [(e.stiffness, e.decay, e.gain) if e else none for e in absorbing.values()]
        springs = HalfJoints(*np.array(parts).T.copy())
    return Quiet(node, viscosity, viscosity * dt / (2 * mass[node]), springs)


def absorbing_ends(
    scene: Scene, p: Properties, model: str, dt: float = 0.0
) -> dict[str, HalfSpring | None]:
    """Return for each absorbing end, by "start" and "end", the half joint there or None."""
    found: dict[str, HalfSpring | None] = {}
    for place in ("start", "end"):
        kind = getattr(scene.ends, place)
        if kind == "matched" and model == "jointed":
            k = 2 * p.regular_own_stiffness * p.area
            found[place] = half_spring(k, p.time_constant or 0.0, p.impedance * p.area, dt)
        elif kind in ("quiet", "matched"):
            found[place] = None
    return found


def fixed_nodes(scene: Scene, bar: Bar) -> np.ndarray | None:
    """Return the nodes that do not move, or None."""
    return np.array([bar.y.size - 1]) if scene.ends.end == "fixed" else None


def rock_modulus(p: Properties, model: str) -> float:
    """Return the modulus between the interfaces, Pa: of intact rock or of the rock mass."""
    if model == "equivalent":
        return p.modulus
    assert p.intact_modulus is not None
    return p.intact_modulus


def critical_step_of(bar: Bar, joints: Joints, scene: Scene, p: Properties, model: str) -> float:
    """Return the critical step (s) of a bar with its joints all closed, the stiffest state."""
    jump = jump_operator(bar)
    rock = rock_modulus(p, model) * p.area * bar.stiffness
    springs = p.area * jump.T @ diags(joints.stiffness) @ jump
    viscosity = None
    if p.time_constant is not None or joints.time_constant is not None:
        eta = np.zeros(joints.number.size) if joints.time_constant is None else joints.time_constant
        dashpots = p.area * jump.T @ diags(joints.stiffness * eta) @ jump
        viscosity = (p.time_constant or 0.0) * rock + dashpots
    ends = np.zeros(bar.y.size)
    for place, end in absorbing_ends(scene, p, model).items():
        ends[0 if place == "start" else -1] = 0.0 if end is None else end.critical_stiffness
    stiffness = rock + springs + diags(ends)
    mass = p.density * p.area * bar.mass
    return critical_bar_step(mass, stiffness, viscosity, fixed_nodes(scene, bar))
