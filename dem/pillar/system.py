"""A pillar ready to run: its model, clock and sources."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np

from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import Properties
from jointwave.cases.run_memory import (
    load_bytes,
    refuse_beyond_memory,
    snapshot_bytes,
    waveform_bytes,
)
from jointwave.cases.sampling import Clock, Interpolation, clock, interpolation
from jointwave.cases.schema.scene import Scene
from jointwave.cases.schema.tables import LEAN
from jointwave.dem.boundaries import BoundaryPoints, dashpots
from jointwave.dem.build import chunks, constants, form_of
from jointwave.dem.composition import KICKS, stability_limit, table
from jointwave.dem.loads import Loads, Pattern, Source
from jointwave.dem.model import Model, held_by
from jointwave.dem.parts import thread_count
from jointwave.dem.pillar.blocks import BlocksOfPillar, blocks_of
from jointwave.dem.pillar.ends import End, arm_of, ends_of
from jointwave.dem.pillar.snapshots import CORNERS_OF_A_BLOCK
from jointwave.dem.shaking import Base, Shaking, shaking
from jointwave.dem.stability import critical_step_of_row
from jointwave.dem.system import BlockSystem, Static
from jointwave.joints.law import Law, parts_of, table_of
from jointwave.joints.normal import gap_under

#: Bytes a block, with its joint and all that makes them, in space and on an axis, and for each of
#: the points with a history.
OF_BLOCK, AXIAL, OF_POINT = 2000, 500, 60
ENOUGH_BLOCKS = 2000  # of a row of equal ones, for its critical step


class Sections(NamedTuple):
    """Receivers of a pillar: sections between contacts 0 .. N, 0 and N those of the ends, and
    points between block centres; with the blocks and contacts that are read for them, ascending."""

    sections: Interpolation
    points: Interpolation
    places: np.ndarray
    watched: np.ndarray


class DashpotsOfBase:
    """What the dashpots before a moving base push with: `dem.loads.Source`.

    row : of the block. push : resultants over the base's velocity [d + d^2, d], N s/m.
    """

    def __init__(self, row: int, push: np.ndarray, moving: Shaking) -> None:
        self.row, self.push, self.moving = row, push, moving

    def at(self, steps: np.ndarray, dt: float, rows: np.ndarray, onto: np.ndarray) -> np.ndarray:
        """See `loads.Source`: by the mean velocity of the base over both half steps."""
        found = np.zeros((len(steps), len(rows), len(onto)))
        begin = self.moving(np.maximum(steps - 1, 0))[:, 0] * (steps > 0)[:, None]
        mean = (begin + self.moving(steps)[:, 0]) / 2
        found[:, rows == self.row] = (mean @ (onto @ self.push).T)[:, None]
        return found


def prepared(scene: Scene, incident: None = None) -> BlockSystem:
    """Return a scene ready to run; raises SceneError if it cannot run. incident : none enters."""
    blocks = blocks_of(scene)
    time, critical = clock_of(blocks)
    moving = shaking(_base(blocks), blocks.contacts.walls, blocks.dim, time.dt)
    loads, dashpot, springs = held_blocks(blocks, ends_of(blocks, time.dt), moving, time)
    bears = bearing(blocks, loads.rows)
    own, reads = constants(blocks, time.dt, blocks.masses), sections_of(blocks)
    form = form_of(blocks, True, moving is not None, relaxed(scene))
    form = form._replace(in_row=True, matched=springs is not None)
    if loads.composed:
        own, form = own._replace(stages=table(time.dt)), form._replace(stages=len(KICKS))
    model = Model(
        form=form,
        blocks=own,
        chunks=chunks(blocks),
        laws=table_of(blocks.columns.law),
        held=held_by(dashpot, loads.rows, blocks.masses, time.dt, own.keep, springs),
        places=reads.places,
        watched=reads.watched,
        walls=len(blocks.contacts.walls),
    )
    threads = thread_count(scene.numerics.dem.threads, blocks.count, blocks.dim)
    return BlockSystem(
        blocks, time, critical, model, reads, loads, None, bears, moving, threads, static(blocks)
    )


def relaxed(scene: Scene) -> bool:
    """Return whether a scene asks for a static state, by dynamic relaxation."""
    weighed = scene.gravity is not None and (scene.gravity.static or any(scene.bears))
    return weighed or scene.prestress is not None


def _base(blocks: BlocksOfPillar) -> list[Base]:
    """Return the motion of the start, if it moves."""
    load = blocks.scene.load
    if not blocks.scene.shakes_base:
        return []
    return [Base("start", load, np.array(load.direction)[[1] if blocks.dim == 1 else [0, 1, 2]])]


def sections_of(blocks: BlocksOfPillar) -> Sections:
    """Return the receivers of a pillar."""
    record, p, count = blocks.scene.record, blocks.properties, blocks.count
    sections = interpolation(p.contact_y, record.stress)
    points = interpolation(p.centre_y, record.velocity)
    crossed = np.unique(np.concatenate([sections.left, sections.right]))
    inner = crossed[(crossed > 0) & (crossed < count)] - 1
    walls = count - 1 + np.arange(len(blocks.contacts.walls))
    at = np.concatenate([points.left, points.right, [0, count - 1]])
    return Sections(sections, points, np.unique(at), np.concatenate([inner, walls]))


def clock_of(blocks: BlocksOfPillar) -> tuple[Clock, float]:
    """Return the clock of a run and its critical step (s); raises SceneError for an unstable step
    and for a run that does not fit in memory."""
    scene, numerics = blocks.scene, blocks.scene.numerics.dem
    row = begin_of(blocks)
    ends = [(one.block, one.stiffness) for one in ends_of(row)]
    own = row.contacts, row.columns, row.masses, scene.damping.local or 0.0
    limit = stability_limit() / 2 if is_composed(scene) else 1.0
    critical = limit * critical_step_of_row(*own, ends)
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "dem")
    spatial, points = blocks.dim > 1, form_of(blocks).points
    parts = {
        "pillar.block": (OF_BLOCK + OF_POINT * points if spatial else AXIAL) * blocks.count,
        "record.interval": waveform_bytes(scene, spatial),
        "numerics.dem.step_fraction": load_bytes(scene, time.steps + time.stride),
        "record.fields": snapshot_bytes(scene, CORNERS_OF_A_BLOCK * blocks.count),
    }
    refuse_beyond_memory(scene, parts)
    return time, critical


def begin_of(blocks: BlocksOfPillar) -> BlocksOfPillar:
    """Return a row with the critical step of a pillar: of equal blocks and joints, the first; no
    longer one has an eigenvalue larger by 1e-6."""
    met, own, joints = blocks.contacts, blocks.columns, blocks.count - 1
    values = [*own.stiffest, *([] if own.time_constants is None else own.time_constants)]
    alike = all((one[:joints] == one[0]).all() for one in values)
    if not alike or (blocks.masses != blocks.masses[0]).any() or blocks.count <= ENOUGH_BLOCKS:
        return blocks
    last, few = ENOUGH_BLOCKS - 1, np.r_[: ENOUGH_BLOCKS - 1, joints : len(met.area)]
    pairs = np.minimum(met.blocks[few], [last, met.blocks.max()])
    pairs[last:, 1] -= blocks.count - ENOUGH_BLOCKS
    kept = {name: getattr(met, name)[few] for name in ("area", "frame", "arm", "spread", "column")}
    return replace(
        blocks,
        contacts=met._replace(blocks=pairs, **kept),
        masses=blocks.masses[:ENOUGH_BLOCKS],
        centroid=blocks.centroid[:ENOUGH_BLOCKS],
    )


def is_composed(scene: Scene) -> bool:
    """Return whether steps are those of `dem.composition`."""
    return scene.numerics.dem.scheme == "fourth-order"


def held_blocks(
    blocks: BlocksOfPillar, ends: list[End], moving: Shaking | None, time: Clock
) -> tuple[Loads, np.ndarray, np.ndarray | None]:
    """Return the external forces on the first and the last block, their dashpots [h, F, F], N s/m,
    and the springs before these, as in `model.Held`, None where there are none."""
    patterns = [*pushes(blocks, moving is not None), *reactions(blocks)]
    waves: list[Source] = []
    rows = np.unique([one.block for one in ends])
    dashpot = np.zeros((len(rows), *blocks.masses.shape[1:]))
    springs = np.zeros((len(rows), 3, *blocks.masses.shape[1:]))
    for one in ends:
        row = int(np.searchsorted(rows, one.block))
        dashpot[row] += one.dashpot
        if one.springs is not None:
            springs[row] = one.springs
    if moving is not None and dashpot[0].any():
        push = np.linalg.pinv(blocks.onto) @ dashpot[0][:, : blocks.dim]
        waves.append(DashpotsOfBase(0, push, moving))
    loads = Loads(rows, patterns, waves, time, blocks.onto, is_composed(blocks.scene))
    return loads, dashpot, springs if any(one.springs is not None for one in ends) else None


def pushes(blocks: BlocksOfPillar, shaken: bool) -> list[Pattern]:
    """Return the load on the start face as forces; none where the base moves instead."""
    load, area = blocks.scene.load, blocks.properties.area
    if shaken:
        return []
    history, arm = load_history(blocks.scene), arm_of(blocks, 0)
    direction = np.array(load.direction)
    if load.arm is not None:  # a pair of forces
        across = np.eye(3)[2 if abs(direction[2]) < LEAN else 0]
        across = across - (across @ direction) * direction
        across /= np.linalg.norm(across)
        force = area * load.arm * np.cross(direction, across) / 2
        pair = np.array([[1.0], [-1.0]])
        return [Pattern(np.zeros(2, int), pair * across, pair * force, history)]
    if blocks.dim == 1:
        return [Pattern(np.zeros(1, int), arm[None], area * direction[None, 1:2], history)]
    arm[0], arm[2] = load.at
    return [Pattern(np.zeros(1, int), arm[None], area * direction[None], history)]


def reactions(blocks: BlocksOfPillar) -> list[Pattern]:
    """Return what bears a prestress on ends that are not fixed."""
    if blocks.prestress is None:
        return []
    found, kinds = [], (blocks.scene.ends.start, blocks.scene.ends.end)
    for kind, block, sign in zip(kinds, (0, blocks.count - 1), (1.0, -1.0), strict=True):
        if kind != "fixed":
            force = sign * blocks.properties.area * blocks.prestress[blocks.along]
            found.append(Pattern(np.array([block]), arm_of(blocks, block)[None], force[None], None))
    return found


def bearing(blocks: BlocksOfPillar, rows: np.ndarray) -> np.ndarray:
    """Return the resultants of unit dashpots over ends that bear the weight, as
    `boundaries.dashpots` has it [h, d + d^2, d + d^2]."""
    p, dim = blocks.properties, blocks.dim
    found = np.zeros((len(rows), *[dim + dim**2] * 2))
    for bears, block in zip(blocks.scene.bears, (0, blocks.count - 1), strict=True):
        if bears:
            signs = np.array(list(product((-1.0, 1.0), repeat=dim - 1)))
            arm = np.repeat(arm_of(blocks, block)[None], len(signs), axis=0)
            normal = np.sign(arm)
            arm[:, [0, 2][: dim - 1]] = p.side / np.sqrt(12) * signs
            area = np.full(len(arm), p.area / len(arm))
            place = blocks.centroid[block] + arm
            at = BoundaryPoints(np.full(len(arm), block), place, arm, normal, area)
            row = np.full(len(arm), np.searchsorted(rows, block))
            found += dashpots(at, np.ones((len(arm), 2)), row, len(rows))
    return found


def static(blocks: BlocksOfPillar) -> Static:
    """Return how the static state of a pillar is found: from that of elastic joints under the
    weight along it."""
    pressed = 0.0
    if blocks.prestress is not None:
        pressed = blocks.properties.area * float(np.abs(blocks.prestress).max())
    return Static(_under_weight(blocks), pressed, 40_000 + 80_000 * blocks.count)


def _under_weight(blocks: BlocksOfPillar) -> np.ndarray | None:
    """Return the displacement [N, F] of blocks between elastic joints under the weight along the
    pillar, which the ends bear that are held; None where none is.

    The forces are those of equilibrium, between two held ends as the springs share them.
    """
    scene, p = blocks.scene, blocks.properties
    kinds = scene.ends.start, scene.ends.end
    held = [kind == "fixed" or bears for kind, bears in zip(kinds, scene.bears, strict=True)]
    weight = blocks.masses[:, 0, 0] * blocks.gravity[blocks.along]
    if not weight.any() or not any(held):
        return None
    walls = p.area * p.at_start.wall_stiffness, p.area * p.at_end.wall_stiffness
    force = np.append(0.0, np.cumsum(weight))
    if all(held):
        soft = 1 / np.concatenate([walls[:1], p.stiffness * p.area, walls[1:]])
        force -= (soft @ force) / soft.sum()
    elif held[0]:
        force -= force[-1]
    before = scene.prestress.normal if scene.prestress else 0.0
    gaps = gaps_under(p, before + force[1:-1] / p.area) - gaps_under(p, before)
    moved = np.append(0.0, np.cumsum(gaps))
    moved += -force[0] / walls[0] if held[0] else force[-1] / walls[1] - moved[-1]
    found = np.zeros(blocks.masses.shape[:2])
    found[:, blocks.along] = moved
    return found


def gaps_under(p: Properties, stress: float | np.ndarray) -> np.ndarray:
    """Return the gaps of joints whose springs carry a normal stress (Pa), or each its own, m."""
    law = Law(p.stiffness, rock_compliance=p.rock_compliance, **p.strengths(shears=False))
    return gap_under(law, parts_of(law), stress)
