"""Receivers of a pillar: stress at sections, motion at points, fragments between broken joints."""

import json
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from jointwave.cases.loads import with_load_itself, with_walls
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import Interpolation, interpolation
from jointwave.cases.schema.scene import Scene
from jointwave.dem.blocks.rigid import RigidBlocks
from jointwave.dem.contacts.chunks import LANES
from jointwave.dem.kernel.model import Samples, State
from jointwave.dem.readings.samples import acting, rotation_vectors
from jointwave.dem.system import BlockSystem
from jointwave.results.dataset import TERMS, dataset
from jointwave.results.labels import label


class Sections(NamedTuple):
    """Receivers of a pillar: sections between contacts 0 .. N (0 and N are the ends) and points
    between block centres; places, watched : blocks and contacts recorded for them, ascending."""

    sections: Interpolation
    points: Interpolation
    places: np.ndarray
    watched: np.ndarray

    def of_all(self, blocks: RigidBlocks) -> "Sections":
        """Return receivers at all contacts and blocks."""
        nodes = np.arange(blocks.count + 1)
        everywhere = Interpolation(nodes, nodes, np.zeros(len(nodes)))
        return Sections(everywhere, everywhere, nodes[:-1], np.arange(len(blocks.contacts.area)))

    def shown(
        self, system: BlockSystem, samples: Samples, sample: int
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return axial stresses of blocks in a snapshot, means of faces [N], Pa, and no slip."""
        found = stress_at(self, system, samples, sample)
        along = found[:, system.blocks.dim // 2, 0]
        return (along[:-1] + along[1:]) / 2, np.zeros(0)

    def dataset(
        self, system: BlockSystem, state: State, samples: Samples, **attributes: Any
    ) -> xr.Dataset:
        """Return the result of the samples so far, with fragments once the run is complete."""
        time, scene, count = system.time, system.blocks.scene, samples.velocity.shape[-1]
        found = dataset(
            scene,
            "dem",
            time.times[:count],
            with_walls(waveforms(self, system, samples), scene, time.times[:count]),
            **ledger_of(system, samples),
            scheme=scene.numerics.dem.scheme,
            force_evaluations=max(1, system.model.form.stages - 1) * time.steps,
            **attributes,
        )
        return with_breaks(found, system, state) if count == time.samples else found


def sections_of(scene: Scene, walls: int) -> Sections:
    """Return the receivers of a pillar; walls : number of fixed or shaken ends."""
    p, record = calibrate(scene), scene.record
    count = p.block_count
    sections = interpolation(p.contact_y, record.stress)
    points = interpolation(p.centre_y, record.velocity)
    crossed = np.unique(np.concatenate([sections.left, sections.right]))
    inner = crossed[(crossed > 0) & (crossed < count)] - 1
    at = np.concatenate([points.left, points.right, [0, count - 1]])
    return Sections(sections, points, np.unique(at), np.append(inner, count - 1 + np.arange(walls)))


def waveforms(reads: Sections, system: BlockSystem, samples: Samples) -> dict[str, Any]:
    """Return waveforms at the receivers, by the names of `results.dataset.dataset`."""
    stress = stress_at(reads, system, samples)
    at = reads.points._replace(
        left=np.searchsorted(reads.places, reads.points.left),
        right=np.searchsorted(reads.places, reads.points.right),
    )
    moved, moving = (between(x, at) for x in samples[:2])
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
    """Return values [node, component, sample] interpolated linearly to receivers."""
    weight = at.weight[:, None, None]
    return (1 - weight) * values[at.left] + weight * values[at.right]


def stress_at(reads: Sections, system: BlockSystem, samples: Samples, first: int = 0) -> np.ndarray:
    """Return the force on the far side over the area at sections [section, d, n], Pa; the load has
    its value at the sample, not its mean over a step. first : number of the first sample."""
    blocks, sections, time = system.blocks, reads.sections, system.time
    crossed = np.unique(np.concatenate([sections.left, sections.right]))
    dim, count, end = blocks.dim, samples.velocity.shape[-1], blocks.count
    inner = (crossed > 0) & (crossed < end)
    own = np.searchsorted(reads.watched, crossed[inner] - 1)
    force = np.zeros((len(crossed), dim, count))
    force[inner] = in_axes(blocks, crossed[inner] - 1, samples.contact[own])
    if not inner.all():
        ends = on_ends(reads, system, samples, first)
        force[crossed == 0], force[crossed == end] = ends[0], -ends[1]
    at = sections._replace(
        left=np.searchsorted(crossed, sections.left), right=np.searchsorted(crossed, sections.right)
    )
    found = between(force / blocks.scene.pillar.area, at)
    if blocks.composed:
        return found
    times = time.times[first : first + count]
    if dim > 1:
        return with_load_itself(found, blocks.scene, sections, times, time.dt)
    return with_load_itself(found[:, 0], blocks.scene, sections, times, time.dt)[:, None]


def in_axes(blocks: RigidBlocks, watched: np.ndarray, contact: np.ndarray) -> np.ndarray:
    """Return forces of contacts [w] on j in global axes [w, d, n], N, from samples [w, rows, n]."""
    if blocks.dim == 1:  # there forces are along the axis, without a frame
        return contact[:, :1]
    return blocks.contacts.frame[watched].swapaxes(1, 2) @ contact[:, : blocks.dim]


def on_ends(reads: Sections, system: BlockSystem, samples: Samples, first: int) -> np.ndarray:
    """Return the forces of both ends, loads included, on the end blocks [2, d, n], N."""
    dim, met, blocks = system.blocks.dim, system.blocks.contacts, [0, system.blocks.count - 1]
    moved, moving = (x[np.searchsorted(reads.places, blocks)] for x in samples[:2])
    own = samples._replace(displacement=moved, velocity=moving)
    found = acting(system, np.array(blocks), own, first)[:, :dim]
    for wall in np.flatnonzero(met.blocks[:, 1] >= system.blocks.count):
        watched = np.searchsorted(reads.watched, [wall])
        force = in_axes(system.blocks, np.array([wall]), samples.contact[watched])
        found[np.equal(blocks, met.blocks[wall, 0])] -= force
    return found


def ledger_of(system: BlockSystem, samples: Samples) -> dict[str, Any]:
    """Return the energies of the scene's effects and their terms, as arguments of `dataset`."""
    if samples.energy is None:
        return {}
    parts, gravity = system.model.form.parts, system.model.form.gravity
    has = {"friction": parts.limited, "fracture": parts.softening, "gravity": gravity}
    rows = [row for row, term in enumerate(TERMS) if has.get(term, True)]
    return {"energy": samples.energy[rows], "terms": tuple(TERMS[row] for row in rows)}


def with_breaks(result: xr.Dataset, system: BlockSystem, state: State) -> xr.Dataset:
    """Return a result; where joints soften, with `fragments` as a JSON attribute and `break_time`
    of each joint, s, nan where it holds."""
    if not system.model.form.parts.softening:
        return result
    blocks, times = system.blocks, break_times(system, state)
    p = calibrate(blocks.scene)
    found = fragments(blocks, ~np.isnan(times), state.v[: blocks.count, : blocks.dim])
    joints = ("joint_y", p.joint_y, label("joint_y"))
    result = result.assign_attrs(fragments=json.dumps(found)).assign_coords(joint_y=joints)
    return result.assign(break_time=("joint_y", times, label("break_time")))


def break_times(system: BlockSystem, state: State) -> np.ndarray:
    """Return when the joints of a row broke [N - 1], s, nan where they hold. A joint is broken once
    all its contact points are."""
    form, chunks, time = system.model.form, system.model.chunks, system.time
    rows, place = form.point, chunks.place[: system.blocks.count - 1]
    points = form.history.size + rows.size * np.arange(system.model.points) + place[:, None] % LANES
    own = state.history[place // LANES]
    opening, whole = (
        np.take_along_axis(own, points + row, axis=1) for row in (rows.opening, rows.whole)
    )
    limit = np.resize(system.blocks.columns.law.critical_opening, len(place))
    steps = np.where((opening >= limit[:, None]).all(axis=1), whole.max(axis=1), np.inf)
    return np.where(steps <= time.steps, time.dt * steps, np.nan)


def fragments(blocks: Any, broken: np.ndarray, velocity: np.ndarray) -> list[dict[str, Any]]:
    """Return the fragments of a row between its broken joints (bool array [N - 1]), from the start
    on; velocity : of every block [N, d], m/s.

    Each has `from_y` and `to_y` (m, in the unloaded pillar), `mass` (kg) and `velocity` of its
    centre of mass (m/s), along y or in three components.
    """
    first = np.concatenate([[0], np.flatnonzero(broken) + 1])
    edges = calibrate(blocks.scene).contact_y[np.append(first, blocks.count)]
    masses = blocks.inertia[:, :1]
    mass, momentum = (np.add.reduceat(x, first) for x in (masses, masses * velocity))
    mean = (momentum / mass).squeeze(axis=1) if blocks.dim == 1 else momentum / mass
    values = edges[:-1].tolist(), edges[1:].tolist(), mass[:, 0].tolist(), mean.tolist()
    names = "from_y", "to_y", "mass", "velocity"
    return [dict(zip(names, one, strict=True)) for one in zip(*values, strict=True)]
