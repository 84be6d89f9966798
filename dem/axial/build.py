"""The model of a chain from its scene."""

import numpy as np

from jointwave.cases.loads import base_steps, load_history, step_means, until_it_ends
from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.sampling import Clock, clock, interpolation
from jointwave.cases.schema.scene import Scene
from jointwave.dem.axial.ends import build_end
from jointwave.dem.axial.model import Chain, Effects, Model, Receivers
from jointwave.dem.axial.stability import critical_chain_step
from jointwave.dem.axial.state import State, state_at_rest
from jointwave.dem.size import refuse_large, refuse_too_many
from jointwave.dem.static import stiffest
from jointwave.joints.law import Law, law, parts_of, table_of


def build(scene: Scene) -> tuple[Model, State, Clock, float]:
    """Return the model, the unloaded state at rest, the clock and the critical step (s)."""
    refuse_too_many(scene)
    p = calibrate(scene)
    critical = critical_chain_step(stiffest(scene, p), scene.ends.start, scene.ends.end)
    numerics = scene.numerics.dem
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "dem")
    refuse_large(scene, time)
    model = build_model(scene, p, time)
    return model, state_at_rest(model.effects, p.block_count, scene.record.energy), time, critical


def build_model(scene: Scene, p: Properties, time: Clock) -> Model:
    """Return the constants of a scene for a given clock."""
    along, count = scene.load.direction[1], time.steps + time.stride
    load = base = np.zeros(0)
    if scene.shakes_base:
        base = np.append(0.0, -along * base_steps(scene.load, time.dt, count))
    else:
        load = along * p.area * step_means(load_history(scene), time.dt, count)
    model = unloaded(scene, p, time.dt, (scene.ends.start, scene.ends.end))
    return model._replace(
        effects=model.effects._replace(base=scene.shakes_base),
        load=until_it_ends(load),
        base=until_it_ends(base),
    )


def unloaded(scene: Scene, p: Properties, dt: float, ends: tuple[str, str]) -> Model:
    """Return the constants for steps dt (s) of blocks of these properties without a load, under
    gravity and prestress, with ends of these kinds."""
    alpha, gravity, joints = p.mass_damping, scene.gravity, law_of_joints(p)
    force = scene.prestress.normal * p.area if scene.prestress else 0.0
    start, end = ends
    masses = p.masses
    mass = p.block_mass if masses is None else float(masses.min())
    effects = Effects(
        joints=parts_of(joints),
        masses=masses is not None,
        start=start != "free",
        end=end != "free",
        local_damping=p.local_damping is not None,
        gravity=gravity is not None,
    )
    chain = Chain(
        dt=dt,
        mass=mass,
        area=p.area,
        impulse_to_speed=dt / mass,
        local=p.local_damping or 0.0,
        weight=mass * gravity.acceleration * gravity.direction[1] if gravity else 0.0,
        start_force=0.0 if start == "fixed" else force,
        end_force=0.0 if end == "fixed" else force,
        start=build_end(start, p.at_start, dt),
        end=build_end(end, p.at_end, dt),
    )
    none = np.zeros(0)
    blocks = None if masses is None else np.stack([masses, dt / masses], axis=1)
    places = receivers(scene, p)
    model = Model(effects, chain, table_of(joints), none, none, places, blocks)
    return model if alpha is None else with_mass_damping(model, alpha)


def law_of_joints(p: Properties) -> Law:
    """Return the law of the joints along the axis, per unit area."""
    strengths = p.strengths(shears=False)
    rock = p.rock_compliance
    return law(p.stiffness, p.joint_time_constant, p.tension, rock_compliance=rock, **strengths)


def with_mass_damping(model: Model, alpha: float) -> Model:
    """Return the model under a force -alpha m v (1/s) on every block, v the mean over the step.

    v+ = ((1 - a) v- + (dt / m) F) / (1 + a), a = alpha dt / 2.
    """
    dt, mass = model.chain.dt, model.chain.mass
    a = alpha * dt / 2
    chain = model.chain._replace(keep=(1 - a) / (1 + a), impulse_to_speed=dt / mass / (1 + a))
    blocks = None if model.blocks is None else model.blocks / [1, 1 + a]
    effects = model.effects._replace(mass_damping=True)
    return model._replace(chain=chain, blocks=blocks, effects=effects)


def receivers(scene: Scene, p: Properties) -> Receivers:
    """Return the receivers of the scene."""
    return Receivers(
        interpolation(p.contact_y, scene.record.stress),
        interpolation(p.centre_y, scene.record.velocity),
    )
