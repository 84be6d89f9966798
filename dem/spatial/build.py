"""From a scene to the model, the state at rest and the buffers of a spatial run."""

import numpy as np

from jointwave.cases.loads import base_steps, load_history, step_means
from jointwave.cases.material.calibrate import Properties
from jointwave.cases.sampling import Clock, Interpolation, interpolation
from jointwave.cases.schema.scene import Scene
from jointwave.dem.spatial.ends import STEADY, contact_points, end_constants, end_springs, face_of
from jointwave.dem.spatial.layout import (
    AFTER,
    BUFFER,
    CARRY,
    LANES,
    LEDGER,
    STRIDE,
    TERMS,
    KernelFlags,
    packed,
    tile_count,
)
from jointwave.dem.spatial.model import (
    Block,
    Buffers,
    Load,
    RowModel,
    RowReceivers,
    RowSamples,
    RowState,
)
from jointwave.joints.law import Law, law, parts_of, table_of
from jointwave.numerics.cache_lines import zeros
from jointwave.numerics.divergence import Guard

DEPTH = 8  # steps a tile takes while it is in the cache


def build_model(scene: Scene, p: Properties, time: Clock) -> RowModel:
    """Return the constants of a scene for a given clock."""
    joints, points, load = build_law(p), contact_points(scene), build_load(scene, p, time)
    block, terms = build_block(scene, p, time.dt, points), energy_terms(scene, p)
    ends, kinds = build_ends(scene, p, block), (scene.ends.start, scene.ends.end)
    start, end = (k != "free" or e[STEADY].any() for k, e in zip(kinds, ends, strict=True))
    form = KernelFlags(
        parts=parts_of(joints),
        points=points_with_history(scene, p) > 0,
        turns=scene.motion.rotation != "none",
        finite=scene.motion.rotation == "finite",
        mass_damping=bool(p.mass_damping),
        local_damping=p.local_damping is not None,
        gravity=scene.gravity is not None,
        base=load.base is not None,
        start=bool(start),
        end=bool(end),
        ledger=bool(terms),
        relaxed=is_relaxed(scene),
    )
    return RowModel(
        form=form,
        block=block,
        block_count=p.block_count,
        table=packed(_columns(joints, p.block_count), LANES),
        points=points,
        load=load,
        ends=ends if start or end or terms else None,
        receivers=build_receivers(*receivers(scene, p)),
        stride=time.stride,
    )


def is_relaxed(scene: Scene) -> bool:
    """Return whether a scene asks for a static state, by dynamic relaxation."""
    static = scene.gravity is not None and scene.gravity.static
    return static or scene.prestress is not None or any(scene.bears)


def _columns(joints: Law, blocks: int) -> np.ndarray:
    """Return the table of the joint law, with a column for each block where joints vary."""
    table = table_of(joints)
    return table if table.shape[1] == 1 else np.pad(table, ((0, 0), (0, 1)))


def energy_terms(scene: Scene, p: Properties) -> tuple[str, ...]:
    """Return the terms of the scene's energy ledger; none where it keeps none."""
    if not scene.record.energy:
        return ()
    absent = {
        "rotation": scene.motion.rotation == "none",
        "friction": not _is_nonlinear(p),
        "fracture": p.tensile_strength is None,
        "gravity": scene.gravity is None,
    }
    return tuple(term for term in TERMS if not absent.get(term, False))


def _is_nonlinear(p: Properties) -> bool:
    return not p.tension.all() or bool(p.given)


def points_with_history(scene: Scene, p: Properties) -> int:
    """Return how many points of a joint are looked after one by one; 0 where their sum will do."""
    if _is_nonlinear(p) or scene.motion.rotation == "finite":
        return contact_points(scene).shape[1]
    return 0


def build_block(scene: Scene, p: Properties, dt: float, points: np.ndarray) -> Block:
    """Return the constants of a block's motion and of its faces."""
    drag, g, direction = 0.5 * dt * (p.mass_damping or 0.0), 0.0, np.zeros(6)
    if scene.gravity is not None:
        g, direction[:3] = scene.gravity.acceleration, scene.gravity.direction
    across, along, face = p.inertia_across, p.inertia_along, face_of(points)
    inertia = np.array([p.block_mass, p.block_mass, p.block_mass, across, along, across])
    # Corners leave the other face with a quarter of the side, as midpoints do.
    reach = 0.75 if scene.joints.point_rule == "vertices" else 0.5
    return Block(
        dt=dt,
        arm=p.spacing / 2,
        half_side=reach * p.side,
        keep=(1 - drag) / (1 + drag),
        local=p.local_damping or 0.0,
        mass=p.block_mass,
        inertia_across=across,
        inertia_along=along,
        freedoms=6 if scene.motion.rotation != "none" else 3,
        inertia=inertia,
        push=dt / inertia / (1 + drag),
        fall=dt / (1 + drag) * g * direction,
        weight=p.block_mass * g * direction,
        face=face.normal + face.shear,
    )


def build_law(p: Properties) -> Law:
    """Return the law of all joints."""
    return law(
        p.stiffness,
        p.joint_time_constant,
        p.tension,
        shear_stiffness=p.shear_stiffness,
        rock_compliance=p.rock_compliance,
        **p.strengths(),
    )


def build_ends(scene: Scene, p: Properties, block: Block) -> np.ndarray:
    """Return the constants of start and end, with the prestress that they carry where they give
    way."""
    size = 3 if scene.motion.rotation == "none" else 6
    face, base = face_of(contact_points(scene)), np.zeros(size)
    base[:3] = scene.load.direction if scene.shakes_base else 0.0
    kinds, found = (scene.ends.start, scene.ends.end), []
    for kind, side, moved in zip(kinds, (1.0, -1.0), (base, 0.0 * base), strict=True):
        steady = np.zeros(size)
        if scene.prestress is not None and kind != "fixed":
            steady[1] = side * scene.prestress.normal * p.area
        springs = end_springs(kind, p, face, size)
        found.append(end_constants(kind, side, springs, block, steady, moved))
    return np.array(found)


def build_load(scene: Scene, p: Properties, time: Clock) -> Load:
    """Return what acts on the start face."""
    steps, size = time.steps + time.stride, 3 if scene.motion.rotation == "none" else 6
    if scene.shakes_base:
        base = np.append(0.0, base_steps(scene.load, time.dt, steps + 1))
        return Load(np.zeros(0), np.zeros(size), base)
    means = step_means(load_history(scene), time.dt, steps)
    acting = np.flatnonzero(means)
    means = means[: acting[-1] + 1] if acting.size else np.zeros(0)
    return Load(means, p.area * load_components(scene)[:size], None)


def load_components(scene: Scene) -> np.ndarray:
    """Return force and moment over area (1, m) at the start's centre for a unit stress, [6]."""
    load = scene.load
    x, y, z = load.direction
    if load.arm is not None:
        return load.arm * np.array([0.0, 0.0, 0.0, x, y, z])
    at_x, at_z = load.at
    return np.array([x, y, z, -at_z * y, at_z * x - at_x * z, at_x * y])


def receivers(scene: Scene, p: Properties) -> tuple[Interpolation, Interpolation]:
    """Return how recorded places lie between contacts 0 .. N and between block centres."""
    contacts = p.spacing * np.arange(p.block_count + 1)
    return (
        interpolation(contacts, scene.record.stress),
        interpolation(contacts[1:] - p.spacing / 2, scene.record.velocity),
    )


def build_receivers(sections: Interpolation, points: Interpolation) -> RowReceivers:
    """Return the contacts and blocks on either side of every recorded place, left ones first."""
    contacts = np.concatenate([sections.left, sections.right])
    blocks = np.concatenate([points.left, points.right])
    tile = np.maximum(contacts - 1, 0) // LANES
    return RowReceivers(
        np.array([tile, contacts - tile * LANES]), np.array([blocks // LANES, blocks % LANES])
    )


def state_at_rest(model: RowModel) -> RowState:
    """Return the state at rest, without arrays for absent effects."""
    form, tiles, points = model.form, tile_count(model.block_count), model.points.shape[1]
    kept = form.rate_rows + points * form.point_rows
    history = zeros((tiles, kept * LANES)) if kept else None
    if history is not None and form.points and form.parts.residual:
        field = Law._fields.index("cohesion")
        cohesion = model.table.reshape(len(model.table), -1, LANES)[:, field]
        whole = cohesion if form.parts.varied else cohesion[:, :1]
        history.reshape(tiles, -1, LANES)[:, form.cohesions] = whole[:, None]
    motion = zeros((tiles, form.motion_rows * STRIDE))
    if form.finite:
        motion[:, 12 * STRIDE :] = 1.0  # no rotation
    return RowState(
        motion,
        history,
        None if model.ends is None else np.zeros((2, 4, form.freedoms)),
        zeros(AFTER) if form.ledger else None,
    )


def buffers_for(model: RowModel, threads: int, guard: Guard | None = None) -> Buffers:
    """Return the buffers that so many threads work in, a run ended by a guard."""
    ledgers = zeros((threads * DEPTH, LEDGER)) if model.form.ledger else None
    return Buffers(zeros((threads, BUFFER + CARRY * DEPTH)), ledgers, DEPTH, guard)


def samples_for(model: RowModel, samples: int) -> RowSamples:
    """Return empty samples."""
    contacts, centres = (places.shape[1] for places in model.receivers)
    freedoms, rows = model.form.freedoms, model.form.motion_rows
    return RowSamples(
        np.zeros((contacts, freedoms, samples)),
        np.zeros((centres, freedoms, samples)),
        np.zeros((centres, rows - freedoms, samples)),
        np.zeros((len(TERMS), samples)) if model.form.ledger else None,
    )
