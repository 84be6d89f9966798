"""From a scene to the model, the state at rest and the room of a spatial run."""

from typing import Any

import numpy as np

from cases.loads import base_steps, load_history, step_means
from cases.material.calibrate import Properties
from cases.sampling import Clock, Interpolation, interpolation
from cases.schema.scene import Scene
from dem.spatial import scratch
from dem.spatial.book import ACCOUNT_OF, ACCOUNTS, AFTER
from dem.spatial.contact import Contact
from dem.spatial.ends import End, Springs, build_end, end_springs, end_state
from dem.spatial.finite import SCALAR
from dem.spatial.layout import LANES, STRIDE, Layout, layout, packed, tile_count
from dem.spatial.model import Load, Model, Receivers, Room, Samples, State
from dem.spatial.motion import Motion
from dem.spatial.section import contact_points, face_of, section
from joints.laws import Law
from joints.uniform import law
from numerics.aligned import zeros
from numerics.divergence import Guard
from results.dataset import ALL_TERMS

DEPTH = 8  # steps a tile takes while it is in the cache


def build_model(scene: Scene, p: Properties, time: Clock) -> Model:
    """Return the constants of a scene for a given clock."""
    turns = scene.motion.rotation != "none"
    motion = build_motion(scene, p, time.dt, turns)
    contact = build_contact(scene, p, motion)
    start, end = build_ends(scene, p, contact, motion)
    weight = None
    if scene.gravity is not None:
        weight = p.block_mass * scene.gravity.acceleration * np.array(scene.gravity.direction)
    damps = contact.damped is not None or motion.keep is not None or motion.local is not None
    terms = energy_terms(scene, p)
    return Model(
        contact=contact,
        motion=motion,
        load=build_load(scene, p, time, 6 if turns else 3),
        start=start,
        end=end,
        last=p.block_count - LANES * (tile_count(p.block_count) - 1),
        receivers=build_receivers(*receivers(scene, p)),
        stride=time.stride,
        accounts=np.array([ACCOUNT_OF[term] for term in terms]) if terms else None,
        weight=weight,
        viscous=True if damps else None,
    )


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
    return tuple(term for term in ALL_TERMS if not absent.get(term, False))


def _is_nonlinear(p: Properties) -> bool:
    limits = (p.friction, p.cohesion, p.tensile_strength)
    return not p.tension.all() or any(limit is not None for limit in limits)


def points_looked_after(scene: Scene, p: Properties) -> int:
    """Return how many points of a joint are looked after one by one; 0 where their sum will do."""
    if _is_nonlinear(p) or scene.motion.rotation == "finite":
        return len(contact_points(scene).x)
    return 0


def build_motion(scene: Scene, p: Properties, dt: float, turns: bool) -> Motion:
    """Return the constants of a block's motion."""
    drag = 0.5 * dt * (p.mass_damping or 0.0)
    inertia = (p.inertia_across, p.inertia_along, p.inertia_across)
    fall = None
    if scene.gravity is not None:
        fall = tuple(
            dt / (1 + drag) * scene.gravity.acceleration * x for x in scene.gravity.direction
        )
    return Motion(
        dt=dt,
        arm=p.spacing / 2 if turns else None,
        mass=p.block_mass,
        inertia=inertia if turns else None,
        push=dt / p.block_mass / (1 + drag),
        twist=tuple(dt / i / (1 + drag) for i in inertia) if turns else None,
        fall=fall,
        keep=(1 - drag) / (1 + drag) if p.mass_damping else None,
        local=p.local_damping,
        finite=top(p) if scene.motion.rotation == "finite" else None,
    )


def top(p: Properties) -> tuple[float, float]:
    """Return 1 / I_t and 1 / I_a - 1 / I_t of a block as a symmetric top, 1/(kg m2)."""
    return 1 / p.inertia_across, 1 / p.inertia_along - 1 / p.inertia_across


def build_contact(scene: Scene, p: Properties, motion: Motion) -> Contact:
    """Return the constants of all joints: by points where they can open or slide, or turn far."""
    joints = law(
        p.stiffness,
        p.joint_time_constant,
        p.tension,
        shear_stiffness=p.shear_stiffness,
        cohesion=p.cohesion,
        friction=p.friction,
        residual_cohesion=p.residual_cohesion,
        tensile_strength=p.tensile_strength,
        critical_opening=p.critical_opening,
    )
    points, damped = contact_points(scene), p.joint_time_constant is not None
    by_points = points_looked_after(scene, p) > 0
    return Contact(
        law=_numbers(joints),
        table=_table(joints, p.block_count),
        points=points if by_points else None,
        section=None if by_points else section(points),
        rows=rows_of(points if by_points else None, joints, motion, damped),
        arm=motion.arm,
        dt=motion.dt,
        damped=True if damped else None,
        finite=motion.finite,
        half_side=p.side / 2,
    )


def rows_of(points: Any, joints: Law, motion: Motion, damped: bool) -> Layout:
    """Return which rows a tile has."""
    freedoms = 3 if motion.arm is None else 6
    n = 0 if points is None else len(points.area)
    return layout(
        motion=2 * freedoms + (motion.finite is not None),
        rates=freedoms if damped else 0,
        slides=2 * n,
        openings=n if joints.tensile_strength is not None else 0,
        cohesions=n if joints.residual_cohesion is not None else 0,
    )


def _differ(joints: Law) -> bool:
    return any(isinstance(part, np.ndarray) for part in joints)


def _numbers(joints: Law) -> Law:
    """Return a law of numbers: where joints differ only which parts there are matters."""
    if not _differ(joints):
        return joints
    numbers = Law(*(None if part is None else 0.0 for part in joints))
    return numbers._replace(carries_tension=None if joints.carries_tension is None else False)


def _table(joints: Law, blocks: int) -> np.ndarray | None:
    """Return every part of every joint in tiles, where joints differ."""
    if not _differ(joints):
        return None
    rows = np.zeros((len(joints), blocks))  # for as many tiles as the blocks have
    for row, part in zip(rows, joints, strict=True):
        row[:-1] = 0.0 if part is None else part
    return packed(rows, LANES)


def build_ends(
    scene: Scene, p: Properties, contact: Contact, motion: Motion
) -> tuple[End | None, End | None]:
    """Return both ends, with the prestress that they carry where they give way."""
    size = 3 if motion.arm is None else 6
    face = face_of(section(contact_points(scene)))
    springs, base = end_springs(p, face, size), np.zeros(size)
    base[:3] = scene.load.direction if scene.load.shakes_base else 0.0
    return (
        _build_end(scene, scene.ends.start, 1.0, springs, motion, base, p.area),
        _build_end(scene, scene.ends.end, -1.0, springs, motion, np.zeros(size), p.area),
    )


def _build_end(
    scene: Scene, kind: str, side: float, springs: Springs, motion: Motion, base: Any, area: float
) -> End | None:
    steady = np.zeros_like(base)
    if scene.prestress is not None and kind != "fixed":
        steady[1] = side * scene.prestress.normal * area
    return build_end(kind, side, springs, motion, steady, base)


def build_load(scene: Scene, p: Properties, time: Clock, size: int) -> Load:
    """Return what acts on the start face."""
    steps = time.steps + time.stride
    if scene.load.shakes_base:
        base = np.append(0.0, base_steps(scene, time.dt, steps + 1))
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


def build_receivers(sections: Interpolation, points: Interpolation) -> Receivers:
    """Return the contacts and blocks on either side of every recorded place, left ones first."""
    contacts = np.concatenate([sections.left, sections.right])
    blocks = np.concatenate([points.left, points.right])
    contact_tile = np.maximum(contacts - 1, 0) // LANES
    return Receivers(contact_tile, contacts - contact_tile * LANES, blocks // LANES, blocks % LANES)


def state_at_rest(model: Model, block_count: int) -> State:
    """Return the state at rest, with no array for anything that the model does not have."""
    rows, tiles = model.contact.rows, tile_count(block_count)
    kept = sum(len(kind) for kind in rows[1:] if kind is not None)
    history = zeros((tiles, kept * LANES)) if kept else None
    if history is not None and rows.cohesions is not None:
        fill_cohesion(model.contact, history)
    sums = None if model.accounts is None else zeros(AFTER * STRIDE)
    motion = zeros((tiles, len(rows.motion) * STRIDE))
    if model.motion.finite is not None:
        motion[:, SCALAR:] = 1.0  # no rotation
    slides = None if model.contact.points is None else np.zeros((tiles, 1), dtype=np.int64)
    return State(motion, history, slides, end_state(model.start), end_state(model.end), sums)


def fill_cohesion(contact: Contact, history: np.ndarray) -> None:
    """Give every contact point the cohesion of its joint."""
    whole = contact.law.cohesion
    if contact.table is not None:
        whole = contact.table[:, None, 5 * LANES : 6 * LANES]
    first, points = contact.rows.cohesions[0], len(contact.rows.cohesions)
    history.reshape(len(history), -1, LANES)[:, first : first + points] = whole


def room_for(model: Model, threads: int, guard: Guard | None = None) -> Room:
    """Return the room that so many threads work in, watched by a guard."""
    slots = threads * DEPTH
    books = None if model.accounts is None else zeros((slots, ACCOUNTS * STRIDE))
    work, carry = zeros((threads, scratch.ROWS * STRIDE)), np.zeros((slots, 12))
    return Room(work, carry, books, DEPTH, guard)


def samples_for(model: Model, samples: int) -> Samples:
    """Return empty samples."""
    freedoms = len(model.contact.rows.motion) // 2
    contacts, blocks = len(model.receivers.contact_tile), len(model.receivers.block_tile)
    energy = None if model.accounts is None else np.zeros((len(model.accounts), samples))
    return Samples(
        np.zeros((contacts, freedoms, samples)),
        np.zeros((blocks, freedoms, samples)),
        np.zeros((blocks, len(model.contact.rows.motion) - freedoms, samples)),
        energy,
    )
