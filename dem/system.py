"""A rock mass ready to run: its model, clock and sources."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jointwave.cases.incident import IncidentField, free_field
from jointwave.cases.material.quiet_sides import borne, impedances
from jointwave.cases.run_memory import refuse_beyond_memory, snapshot_bytes, waveform_bytes
from jointwave.cases.sampling import Clock, clock
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.boundaries import dashpots, facets_on, points_on
from jointwave.dem.build import (
    RigidBlocks,
    chunks,
    constants,
    faces_of,
    form_of,
    rigid_blocks,
)
from jointwave.dem.loads import Loads, load_pattern, reactions
from jointwave.dem.model import Model, held_by
from jointwave.dem.receivers import Receivers, receivers_of
from jointwave.dem.shaking import Shaking, shaking
from jointwave.dem.time_loop import thread_count
from jointwave.dem.waves import incoming
from jointwave.joints.law import table_of

#: Bytes a block, with its contacts and all that makes them, and for each of their points.
OF_BLOCK, OF_POINT = 2000, 60
CORNERS = {2: 4, 3: 24}  # of a block, in snapshots


class BlockSystem(NamedTuple):
    """A rock mass ready to run.

    receivers : what is recorded. loads : what acts on held blocks. resistance : of their quiet
    sides, as `boundaries.dashpots` has it [h, d + d^2, d + d^2]. bearing : the same of unit
    dashpots where those sides bear the weight. shaking : the motion of walls; None where none
    moves. threads : that share each step.
    """

    blocks: RigidBlocks
    time: Clock
    critical: float
    model: Model
    receivers: Receivers
    loads: Loads
    resistance: np.ndarray
    bearing: np.ndarray
    shaking: Shaking | None
    threads: int


def prepared(scene: RockMass, incident: IncidentField | None = None) -> BlockSystem:
    """Return a scene ready to run; raises SceneError if it cannot run.

    incident : the field of waves that quiet sides take in; absent: that of the scene's waves in
    rock without joints.
    """
    blocks = rigid_blocks(scene)
    time, critical = clock_of(blocks)
    field: IncidentField = free_field(scene) if incident is None else incident
    loads, resistance, bearing = held_blocks(blocks, time, field)
    receivers = receivers_of(scene, blocks.cut, faces_of(blocks), loads.onto)
    moving = shaking(scene.bases, blocks.contacts.walls, blocks.dim, time.dt)
    form = form_of(blocks, len(loads.rows) > 0 or scene.excavated, moving is not None)
    held = held_by(loads.onto @ resistance @ loads.onto.T, loads.rows, blocks.masses, time.dt)
    model = Model(
        form=form,
        blocks=constants(blocks, time.dt),
        chunks=chunks(blocks),
        laws=table_of(blocks.columns.law),
        held=held if form.held else None,
        places=receivers.places,
        watched=receivers.watched,
        walls=len(blocks.contacts.walls),
    )
    threads = thread_count(scene.numerics.dem.threads, blocks.cut.count)
    quiet = resistance, bearing
    return BlockSystem(blocks, time, critical, model, receivers, loads, *quiet, moving, threads)


def clock_of(blocks: RigidBlocks) -> tuple[Clock, float]:
    """Return the clock of a run and its critical step (s); raises SceneError for an unstable step
    and for a run that does not fit in memory."""
    scene, critical, count = blocks.scene, blocks.critical, blocks.cut.count
    numerics, points = scene.numerics.dem, form_of(blocks, False, False).points
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "dem")
    parts = {
        "numerics.dem.block": (OF_BLOCK + OF_POINT * points) * count,
        "record.interval": waveform_bytes(scene),
        "record.fields": snapshot_bytes(scene, CORNERS[blocks.dim] * count),
    }
    refuse_beyond_memory(scene, parts)
    return time, critical


def held_blocks(
    blocks: RigidBlocks, time: Clock, field: IncidentField
) -> tuple[Loads, np.ndarray, np.ndarray]:
    """Return the external forces on blocks, and the resistance of quiet sides, as
    `boundaries.dashpots` has it, then that of unit dashpots where they bear the weight."""
    scene, sides, cut = blocks.scene, blocks.sides, blocks.cut
    quiet = points_on(cut, facets_on(cut, sides, scene.boundaries.sides("quiet")))
    impedance = impedances(scene, quiet.normal, cut.body.region[quiet.block])
    patterns = [load_pattern(scene, cut, sides, one) for one in scene.pushes]
    if scene.prestress is not None:
        # Openings have been excavated: nothing holds their walls.
        bear, slide = (
            facets_on(cut, sides, scene.boundaries.sides(*kinds))
            for kinds in (("free", "quiet"), ("roller",))
        )
        patterns.append(reactions(cut, bear, scene.prestress.tensor))
        patterns.append(reactions(cut, slide, scene.prestress.tensor, along=True))
    rows = np.unique(np.concatenate([quiet.block, *(one.block for one in patterns)]))
    period, waves = shortest_period(scene.waves), []
    if scene.waves and len(quiet.block):
        waves = incoming(field, period, quiet, impedance, rows, time)
    loads = Loads(rows, patterns, waves, time, blocks.onto)
    row, bears = np.searchsorted(rows, quiet.block), borne(scene, quiet.normal)
    resistance, bearing = (dashpots(quiet, one, row, len(rows)) for one in (impedance, bears))
    return loads, resistance, bearing
