"""A rock mass ready to run: its model, clock and sources."""

from __future__ import annotations

import numpy as np

from jointwave.cases.geometry.blocks import Blocks
from jointwave.cases.geometry.locate import blocks_at
from jointwave.cases.geometry.measure import Outlines
from jointwave.cases.incident import IncidentField, free_field
from jointwave.cases.loads import velocity_of
from jointwave.cases.material.quiet_sides import base_traction, borne, impedances
from jointwave.cases.material.rock_mass import refuse_beyond_strength
from jointwave.cases.partition.parts import covered
from jointwave.cases.run_memory import refuse_beyond_memory, snapshot_bytes, waveform_bytes
from jointwave.cases.sampling import Clock, clock
from jointwave.cases.schema.pulse import shortest_period
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.sources import PlaneLoad
from jointwave.dem.boundaries import dashpots, facets_on, points_on
from jointwave.dem.build import chunks, constants, form_of
from jointwave.dem.loads import Loads, Pattern, reactions
from jointwave.dem.model import Model, held_by
from jointwave.dem.parts import thread_count
from jointwave.dem.rock_mass.blocks import BlocksOfRockMass, blocks_of, relaxed
from jointwave.dem.rock_mass.receivers import receivers_of
from jointwave.dem.rock_mass.waves import incoming
from jointwave.dem.shaking import Base, shaking
from jointwave.dem.system import BlockSystem, Static
from jointwave.joints.law import table_of

#: Bytes a block, with its contacts and all that makes them, and for each of their points.
OF_BLOCK, OF_POINT = 2000, 60
CORNERS = {2: 4, 3: 24}  # of a block, in snapshots


def prepared(scene: RockMass, incident: IncidentField | None = None) -> BlockSystem:
    """Return a scene ready to run; raises SceneError if it cannot run.

    incident : the field of waves that quiet sides take in; absent: that of the scene's waves in
    rock without joints.
    """
    blocks = blocks_of(scene)
    time, critical = clock_of(blocks)
    if scene.gravity is None or not scene.gravity.static:
        refuse_beyond_strength(scene)
    field: IncidentField = free_field(scene) if incident is None else incident
    loads, resistance, bearing = held_blocks(blocks, time, field)
    receivers = receivers_of(scene, blocks.cut, blocks.faces, loads.onto)
    bases = [Base(one.side or "", one, np.array(one.direction)) for one in scene.bases]
    moving = shaking(bases, blocks.contacts.walls, blocks.dim, time.dt)
    holds = len(loads.rows) > 0 or scene.excavated
    form, own = (
        form_of(blocks, holds, moving is not None, relaxed(scene)),
        constants(blocks, time.dt, blocks.masses),
    )
    dashpot = loads.onto @ resistance @ loads.onto.T
    held = held_by(dashpot, loads.rows, blocks.masses, time.dt, own.keep)
    model = Model(
        form=form,
        blocks=own,
        chunks=chunks(blocks),
        laws=table_of(blocks.columns.law),
        held=held if form.held else None,
        places=receivers.places,
        watched=receivers.watched,
        walls=len(blocks.contacts.walls),
    )
    threads = thread_count(scene.numerics.dem.threads, blocks.count, blocks.dim)
    stress = 0.0 if blocks.prestress is None else np.abs(blocks.prestress).max()
    pressed = float(stress * blocks.cut.boundary.area.sum())
    static = Static(None, pressed, 40_000 + 40_000 * int(np.sqrt(blocks.count)))
    quiet = resistance, bearing
    return BlockSystem(
        blocks, time, critical, model, receivers, loads, *quiet, moving, threads, static
    )


def clock_of(blocks: BlocksOfRockMass) -> tuple[Clock, float]:
    """Return the clock of a run and its critical step (s); raises SceneError for an unstable step
    and for a run that does not fit in memory."""
    scene, critical, count = blocks.scene, blocks.critical, blocks.count
    numerics, points = scene.numerics.dem, form_of(blocks).points
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "dem")
    parts = {
        "numerics.dem.block": (OF_BLOCK + OF_POINT * points) * count,
        "record.interval": waveform_bytes(scene),
        "record.fields": snapshot_bytes(scene, CORNERS[blocks.dim] * count),
    }
    refuse_beyond_memory(scene, parts)
    return time, critical


def held_blocks(
    blocks: BlocksOfRockMass, time: Clock, field: IncidentField
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


def load_pattern(
    scene: RockMass, blocks: Blocks, sides: tuple[str, ...], load: PlaneLoad
) -> Pattern:
    """Return a pressure, a force or a compliant base of a scene; sides : the names of the blocks'
    sides, in order."""
    history = velocity_of(load, load.amplitude)
    if load.kind == "force":
        at = np.array(load.at)
        block = blocks_at(blocks, at[None])[0][:1]
        return Pattern(block, at - blocks.centroid[block], np.array([load.direction]), history)
    facets, parts = facets_on(blocks, sides, [load.side or f"opening {load.opening}"]), None
    if load.between is not None:
        facets, parts = _covered(scene, blocks, load, facets)
    points = points_on(blocks, facets, parts)
    if load.kind == "base":
        assert load.direction is not None
        impedance = impedances(scene, points.normal, blocks.body.region[points.block])
        traction = base_traction(points.normal, impedance, load.direction)
    else:
        traction = -points.normal
    return Pattern(points.block, points.arm, points.area[:, None] * traction, history)


def _covered(
    scene: RockMass, blocks: Blocks, load: PlaneLoad, facets: np.ndarray
) -> tuple[np.ndarray, Outlines]:
    """Return those of some edges that a load acts on in part, and these parts of them."""
    edges = blocks.boundary.ends[facets]
    part = covered(scene.domain, load, edges)
    acts = part[:, 1] > part[:, 0]
    start, end = edges[acts, :1], edges[acts, 1:]
    place = part[acts, :, None]
    ends = start * (1 - place) + end * place
    return facets[acts], Outlines(ends.reshape(-1, 2), 2 * np.arange(acts.sum() + 1))
