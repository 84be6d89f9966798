"""Receivers of a pillar: stress at sections, motion at points, fragments."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.loads import with_load_itself
from jointwave.cases.material.calibrate import Properties
from jointwave.cases.sampling import Interpolation, interpolation
from jointwave.cases.schema.tables import Record
from jointwave.dem.build import RigidBlocks
from jointwave.dem.chunks import LANES
from jointwave.dem.fragments import with_fragments
from jointwave.dem.model import Samples, State
from jointwave.dem.outside import acting
from jointwave.dem.spin import rotation_vectors
from jointwave.dem.system import BlockSystem
from jointwave.results.dataset import dataset
from jointwave.results.rock_mass import TERMS


class Sections(NamedTuple):
    """Receivers of a pillar: sections between contacts 0 .. N, 0 and N those of the ends, and
    points between block centres; with the blocks and contacts that are read for them, ascending."""

    sections: Interpolation
    points: Interpolation
    places: np.ndarray
    watched: np.ndarray

    def of_all(self, blocks: RigidBlocks) -> Sections:
        """Return receivers at all contacts and blocks."""
        nodes = np.arange(blocks.count + 1)
        everywhere = Interpolation(nodes, nodes, np.zeros(len(nodes)))
        return Sections(everywhere, everywhere, nodes[:-1], np.arange(len(blocks.contacts.area)))

    def shown(
        self, system: BlockSystem, samples: Samples, sample: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the stress along the pillar of each block in a snapshot, the mean of its faces, Pa
        [N], and no slip."""
        found = stress_at(self, system, samples, 1, sample)
        along = found[:, system.blocks.dim // 2, 0]
        return (along[:-1] + along[1:]) / 2, np.zeros(0)

    def dataset(
        self, system: BlockSystem, state: State, samples: Samples, count: int, **attributes: Any
    ) -> xr.Dataset:
        """Return the result of the first `count` samples of a run."""
        time, scene = system.time, system.blocks.scene
        found = dataset(
            scene,
            "dem",
            time.times[:count],
            **waveforms(self, system, samples, count),
            **ledger_of(system, samples, count),
            scheme=scene.numerics.dem.scheme,
            force_evaluations=max(1, system.model.form.stages - 1) * time.steps,
            **attributes,
        )
        return with_breaks(found, system, state) if count == time.samples else found


def sections_of(record: Record, p: Properties, walls: int) -> Sections:
    """Return the receivers of a pillar; walls : fixed ends."""
    count = p.block_count
    sections = interpolation(p.contact_y, record.stress)
    points = interpolation(p.centre_y, record.velocity)
    crossed = np.unique(np.concatenate([sections.left, sections.right]))
    inner = crossed[(crossed > 0) & (crossed < count)] - 1
    walls = count - 1 + np.arange(walls)
    at = np.concatenate([points.left, points.right, [0, count - 1]])
    return Sections(sections, points, np.unique(at), np.concatenate([inner, walls]))


def waveforms(reads: Sections, system: BlockSystem, samples: Samples, count: int) -> dict[str, Any]:
    """Return the first `count` samples at the receivers, as `results.dataset.dataset` takes
    them."""
    stress = stress_at(reads, system, samples, count)
    at = reads.points._replace(
        left=np.searchsorted(reads.places, reads.points.left),
        right=np.searchsorted(reads.places, reads.points.right),
    )
    moved, moving = (between(x[..., :count], at) for x in samples[:2])
    if system.blocks.dim == 1:
        return {"stress": stress[:, 0], "velocity": moving[:, 0], "displacement": moved[:, 0]}
    found = {
        "stress": stress[:, 1],
        "shear": np.moveaxis(stress[:, [0, 2]], 1, 2),
        "velocity": np.moveaxis(moving[:, :3], 1, 2),
        "displacement": np.moveaxis(moved[:, :3], 1, 2),
    }
    turned = np.moveaxis(moved[:, 3:], 1, 2)
    if turned.shape[2] == 4:
        turned = rotation_vectors(turned)
    return found | ({"rotation": turned} if turned.shape[2] else {})


def between(values: np.ndarray, at: Interpolation) -> np.ndarray:
    """Return values [node, component, sample] interpolated to places."""
    weight = at.weight[:, None, None]
    return (1 - weight) * values[at.left] + weight * values[at.right]


def stress_at(
    reads: Sections, system: BlockSystem, samples: Samples, count: int, first: int = 0
) -> np.ndarray:
    """Return force over area at sections between contacts, Pa [section, d, n]: that on the far
    side, with the load itself where steps took its mean.

    reads : what the samples are of. first : number of the first sample.
    """
    blocks, sections, time = system.blocks, reads.sections, system.time
    crossed = np.unique(np.concatenate([sections.left, sections.right]))
    dim, inner = blocks.dim, crossed[(crossed > 0) & (crossed < blocks.count)]
    force = np.zeros((len(crossed), dim, count))
    own = np.searchsorted(reads.watched, inner - 1)
    axes = [0] if dim == 1 else [2, 0, 1]  # of the frame y, z, x
    force[np.isin(crossed, inner)] = samples.contact[own][:, axes, :count]
    for block, contact, sign in ((0, 0, 1.0), (blocks.count - 1, blocks.count, -1.0)):
        if contact in crossed:
            pushed = on_end(reads, system, samples, count, block, first)
            force[np.searchsorted(crossed, contact)] = sign * pushed
    at = sections._replace(
        left=np.searchsorted(crossed, sections.left), right=np.searchsorted(crossed, sections.right)
    )
    found = between(force / blocks.properties.area, at)
    if blocks.composed:
        return found
    times = time.times[first : first + count]
    if dim > 1:
        return with_load_itself(found, blocks.scene, sections, times, time.dt)
    return with_load_itself(found[:, 0], blocks.scene, sections, times, time.dt)[:, None]


def on_end(
    reads: Sections, system: BlockSystem, samples: Samples, count: int, block: int, first: int
) -> np.ndarray:
    """Return the force of an end, and the load there, on its block [d, n], N."""
    dim, met = system.blocks.dim, system.blocks.contacts
    place = np.searchsorted(reads.places, [block])
    found = acting(system, reads.places, samples, count, first, place)[0, :dim]
    beside, beyond = met.blocks[:, 0] == block, met.blocks[:, 1] >= system.blocks.count
    for wall in np.flatnonzero(beside & beyond):
        own = samples.contact[np.searchsorted(reads.watched, wall), :dim, :count]
        found -= own if dim == 1 else met.frame[wall].T @ own
    return found


def ledger_of(system: BlockSystem, samples: Samples, count: int) -> dict[str, Any]:
    """Return the energies that the scene has, and which they are, as `dataset` takes them."""
    parts, gravity = system.model.form.parts, system.model.form.gravity
    absent = {
        "friction": not parts.limited,
        "fracture": not parts.softening,
        "gravity": not gravity,
    }
    terms = tuple(term for term in TERMS if not absent.get(term, False))
    if samples.energy is None:
        return {}
    rows = [TERMS.index(term) for term in terms]
    return {"energy": samples.energy[rows, :count], "terms": terms}


def with_breaks(result: xr.Dataset, system: BlockSystem, state: State) -> xr.Dataset:
    """Return a result with its fragments and times of breaking, where joints soften.

    A joint is broken when all its contact points are.
    """
    form, p, chunks = system.model.form, system.blocks.properties, system.model.chunks
    if not form.parts.softening:
        return result
    rows, place = form.history, chunks.place[: p.block_count - 1]
    points = rows.point + rows.point_rows * np.arange(form.points) + place[:, None] % LANES
    own = state.history[place // LANES]
    opening, whole = (
        np.take_along_axis(own, points + row, axis=1) for row in (rows.opening, rows.whole)
    )
    limit = np.broadcast_to(p.critical_opening, place.shape)
    steps = np.where((opening >= limit[:, None]).all(axis=1), whole.max(axis=1), np.inf)
    times = np.where(steps <= system.time.steps, system.time.dt * steps, np.nan)
    dim, count = system.blocks.dim, system.blocks.count
    velocity = state.v[:count, 0] if dim == 1 else state.v[:count, :3]
    return with_fragments(result, p, ~np.isnan(times), velocity, times)
