"""Preparation of a run: from a scene to a `BlockSystem`."""

from typing import TYPE_CHECKING, Any

import numpy as np

from jointwave.cases import run_memory
from jointwave.cases.sampling import Clock, clock
from jointwave.cases.scene_type import AnyScene
from jointwave.dem.blocks.pillar import blocks_of as row_of
from jointwave.dem.blocks.rigid import RigidBlocks, chunks, constants, form_of
from jointwave.dem.kernel.composition import KICKS, table
from jointwave.dem.kernel.model import Held, Model, held_by
from jointwave.dem.kernel.parts import thread_count
from jointwave.dem.sides.boundaries import dashpots
from jointwave.dem.sides.loads import Loads
from jointwave.dem.sides.shaking import Shaking, shaking
from jointwave.dem.sides.surroundings import before_base
from jointwave.dem.system import BlockSystem
from jointwave.joints.law import table_of

if TYPE_CHECKING:
    from jointwave.cases.incident import IncidentField

#: Bytes a block with its contacts, preparation included, by dimension, and bytes a contact point.
OF_BLOCK, OF_POINT = {1: 500, 2: 2000, 3: 2000}, 60


def prepared(scene: AnyScene, incident: "IncidentField | None" = None) -> BlockSystem:
    """Return a scene ready to run; raises SceneError if it cannot run.

    incident : field that enters through quiet sides; absent: the scene's waves in unjointed rock.
    """
    blocks = blocks_of(scene)
    time, around = clock_of(blocks), blocks.around
    moving = shaking(around.bases, blocks.contacts.walls, blocks.dim, time.dt)
    loads, resistance, bearing = loads_of(blocks, time, moving, incident)
    form, own = form_of(blocks), constants(blocks, time.dt, blocks.masses)
    if loads.composed:
        own, form = own._replace(stages=table(time.dt)), form._replace(stages=len(KICKS))
    receivers = blocks.receivers
    model = Model(
        form=form,
        blocks=own,
        chunks=chunks(blocks),
        laws=table_of(blocks.columns.law),
        held=held(blocks, loads, resistance, time.dt, own.keep) if form.held else None,
        places=receivers.places,
        watched=receivers.watched,
        walls=len(blocks.contacts.walls),
    )
    threads = thread_count(scene.numerics.dem.threads, blocks.count, blocks.dim)
    return BlockSystem(blocks, time, model, loads, resistance, bearing, moving, threads)


def blocks_of(scene: AnyScene) -> Any:
    """Return the `RigidBlocks` of a scene; raises SceneError if it has none."""
    if scene.is_column:
        return row_of(scene)
    from jointwave.dem.blocks.rock_mass import (
        blocks_of as cut,  # imports shapely, which pillars do not need
    )

    return cut(scene)


def clock_of(blocks: RigidBlocks) -> Clock:
    """Return the clock of a run; raises SceneError for an unstable step or too little memory."""
    scene, numerics, dim = blocks.scene, blocks.scene.numerics.dem, blocks.dim
    time = clock(scene, blocks.critical, numerics.step_fraction, numerics.allow_unstable, "dem")
    of_block = OF_BLOCK[dim] + OF_POINT * blocks.points.shape[1] * (dim > 1 and blocks.has_points)
    parts = {
        blocks.counted_by: of_block * blocks.count,
        "record.interval": run_memory.waveform_bytes(scene, dim > 1),
        "numerics.dem.step_fraction": run_memory.load_bytes(scene, time.steps + time.stride),
        "record.fields": run_memory.snapshot_bytes(scene, blocks.corners[dim] * blocks.count),
    }
    run_memory.refuse_beyond_memory(scene, parts)
    return time


def loads_of(
    blocks: RigidBlocks, time: Clock, moving: Shaking | None, incident: "IncidentField | None"
) -> tuple[Loads, np.ndarray, np.ndarray]:
    """Return the external forces on blocks, and the resistance [h, d + d^2, d + d^2] of their
    dashpots, and the stiffness of the springs by which quiet sides bear the weight
    (`boundaries.dashpots`)."""
    around, rows = blocks.around, blocks.around.rows
    row = np.searchsorted(rows, around.points.block)
    resistance, bearing = (
        dashpots(around.points, one, row, len(rows)) for one in (around.impedance, around.borne)
    )
    waves = [] if around.waves is None else around.waves(incident, rows, time)
    if moving is not None and blocks.in_row and resistance[0].any():
        waves.append(before_base(resistance[0][:, : blocks.dim], moving))
    return (
        Loads(rows, around.patterns, waves, time, blocks.onto, blocks.composed),
        resistance,
        bearing,
    )


def held(blocks: RigidBlocks, loads: Loads, resistance: np.ndarray, dt: float, keep: float) -> Held:
    """Return the held blocks for steps of dt, s; keep : as in `model.held_by`."""
    dashpot, springs = loads.onto @ resistance @ loads.onto.T, None
    if blocks.around.springs or blocks.around.borne.any():
        springs = np.zeros((len(dashpot), 3, *dashpot.shape[1:]))
        for one in blocks.around.springs:
            springs[np.searchsorted(loads.rows, one.block)] = one.at(dt)
    return held_by(dashpot, loads.rows, blocks.masses, dt, keep, springs)
