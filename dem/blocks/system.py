"""A rock mass ready to run: its model, clock and sources."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from jointwave.cases.incident import IncidentField, free_field
from jointwave.cases.material.quiet_sides import borne, impedances
from jointwave.cases.run_memory import refuse_beyond_memory, snapshot_bytes, waveform_bytes
from jointwave.cases.sampling import Clock, clock
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.dem.blocks.build import (
    RigidBlocks,
    constants,
    contacts,
    faces_of,
    form_of,
    rigid_blocks,
)
from jointwave.dem.blocks.edges import dashpots, on_freedoms, points_on
from jointwave.dem.blocks.model import PlaneModel, held_by
from jointwave.dem.blocks.shaking import Shaking, shaking
from jointwave.dem.blocks.sources import Sources, load_pattern, on_sides, reactions
from jointwave.dem.blocks.waves import incoming
from jointwave.dem.receivers import Receivers, receivers_of
from jointwave.dem.time_loop import thread_count
from jointwave.joints.law import table_of

#: Bytes a block, with its contacts and all that makes them, and for each of their points.
OF_BLOCK, OF_POINT = 2000, 60
CORNERS = 4  # of a block, in snapshots


class PlaneSystem(NamedTuple):
    """A rock mass ready to run.

    receivers : what is recorded. sources : what acts on held blocks. resistance : what the velocity
    of each of them gives of forces and sums at quiet edges, with the sign of a resistance
    [h, 6, 3]. bearing : the same of unit dashpots where those edges bear the weight. shaking : the
    motion of walls; None where none moves. threads : that share each step.
    """

    blocks: RigidBlocks
    time: Clock
    critical: float
    model: PlaneModel
    receivers: Receivers
    sources: Sources
    resistance: np.ndarray
    bearing: np.ndarray
    shaking: Shaking | None
    threads: int


def prepared(scene: RockMass, incident: IncidentField | None = None) -> PlaneSystem:
    """Return a scene ready to run; raises SceneError if it cannot run.

    incident : the field of waves that quiet sides take in; absent: that of the scene's waves in
    rock without joints.
    """
    blocks = rigid_blocks(scene)
    time, critical = clock_of(blocks)
    field: IncidentField = free_field(scene) if incident is None else incident
    receivers = receivers_of(scene, blocks.partition.blocks, faces_of(blocks), 3)
    sources, resistance, bearing = held_blocks(blocks, time, field)
    moving = shaking(scene, blocks.links.walls, time.dt)
    form = form_of(blocks, len(sources.rows) > 0 or scene.excavated, moving is not None)
    held = held_by(on_freedoms(resistance), sources.rows, blocks.masses, time.dt)
    model = PlaneModel(
        form=form,
        blocks=constants(scene, blocks, time.dt),
        contacts=contacts(blocks),
        laws=table_of(blocks.columns.law),
        rules=blocks.columns.rules,
        held=held if form.held else None,
        places=receivers.places,
        watched=receivers.watched,
        walls=len(blocks.links.walls),
    )
    threads = thread_count(scene.numerics.dem.threads, blocks.partition.count)
    quiet = resistance, bearing
    return PlaneSystem(blocks, time, critical, model, receivers, sources, *quiet, moving, threads)


def clock_of(blocks: RigidBlocks) -> tuple[Clock, float]:
    """Return the clock of a run and its critical step (s); raises SceneError for an unstable step
    and for a run that does not fit in memory."""
    scene, critical, count = blocks.scene, blocks.critical, blocks.partition.count
    numerics = scene.numerics.dem
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "dem")
    parts = {
        "numerics.dem.block": (OF_BLOCK + OF_POINT * blocks.columns.points) * count,
        "record.interval": waveform_bytes(scene),
        "record.fields": snapshot_bytes(scene, CORNERS * count),
    }
    refuse_beyond_memory(scene, parts)
    return time, critical


def held_blocks(
    blocks: RigidBlocks, time: Clock, field: IncidentField
) -> tuple[Sources, np.ndarray, np.ndarray]:
    """Return the external forces on blocks, and the resistance of quiet edges [h, 6, 3], then that
    of unit dashpots where they bear the weight."""
    scene, partition = blocks.scene, blocks.partition
    on_quiet = on_sides(partition, scene.boundaries.sides("quiet"))
    quiet = points_on(partition, partition.boundary, on_quiet)
    impedance = impedances(scene, quiet.normal, partition.region[quiet.block])
    patterns = [load_pattern(scene, partition, x) for x in scene.pushes]
    if scene.prestress is not None:
        # Openings have been excavated: nothing holds their walls.
        open_sides = scene.boundaries.sides("free", "quiet")
        patterns.append(reactions(partition, open_sides, scene.prestress))
    rows = np.unique(np.concatenate([quiet.block, *(one.block for one in patterns)]))
    waves = incoming(scene, field, quiet, impedance, rows, time)
    sources = Sources(rows, patterns, waves, time)
    row, bears = np.searchsorted(rows, quiet.block), borne(scene, quiet.normal)
    resistance, bearing = (dashpots(quiet, one, row, len(rows)) for one in (impedance, bears))
    return sources, resistance, bearing
