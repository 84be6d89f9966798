"""Records of a pillar: waveforms at sections and points, fragments, snapshots."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.loads import with_load_itself
from jointwave.cases.sampling import Interpolation
from jointwave.dem.bounds import motion_of_contacts
from jointwave.dem.chunks import LANES
from jointwave.dem.model import Samples, State
from jointwave.dem.pillar.fragments import with_fragments
from jointwave.dem.pillar.snapshots import BlockFrame, BlockRecorder, spin_of
from jointwave.dem.pillar.system import Sections
from jointwave.dem.system import BlockSystem
from jointwave.numerics.small_motion import Moved
from jointwave.results.dataset import dataset
from jointwave.results.rock_mass import TERMS

MOST_TURN = 0.045  # rad: small rotations then neglect 1 - cos = 1e-3 of a lever


def dataset_of(
    system: BlockSystem, state: State, samples: Samples, count: int, **attributes: Any
) -> xr.Dataset:
    """Return the result of the first `count` samples of a run."""
    time, scene = system.time, system.blocks.scene
    found = dataset(
        scene,
        "dem",
        time.times[:count],
        **waveforms(system, samples, count),
        **ledger_of(system, samples, count),
        scheme=scene.numerics.dem.scheme,
        force_evaluations=max(1, system.model.form.stages - 1) * time.steps,
        **attributes,
    )
    return with_breaks(found, system, state) if count == time.samples else found


def waveforms(system: BlockSystem, samples: Samples, count: int) -> dict[str, Any]:
    """Return the first `count` samples at the receivers, as `results.dataset.dataset` takes
    them."""
    scene, time, dim = system.blocks.scene, system.time, system.blocks.dim
    reads: Sections = system.receivers
    stress = sections_of(system, samples, count, reads.sections, reads)
    if not system.loads.composed:
        stress = with_load_itself(stress, scene, reads.sections, time.times[:count], time.dt)
    at = reads.points._replace(
        left=np.searchsorted(reads.places, reads.points.left),
        right=np.searchsorted(reads.places, reads.points.right),
    )
    moved, moving = (between(x[..., :count], at) for x in samples[:2])
    if dim == 1:
        return {"stress": stress, "velocity": moving[:, 0], "displacement": moved[:, 0]}
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


def rotation_vectors(quaternions: np.ndarray) -> np.ndarray:
    """Return the rotation vectors [..., 3] (rad, up to pi) of quaternions [..., 4], scalar last."""
    from scipy.spatial.transform import Rotation  # slow to import

    if not quaternions.size:
        return quaternions[..., :3]
    lengths = np.linalg.norm(quaternions, axis=-1, keepdims=True)
    turns = Rotation.from_quat((quaternions / lengths).reshape(-1, 4))
    return turns.as_rotvec().reshape(*quaternions.shape[:-1], 3)


def between(values: np.ndarray, at: Interpolation) -> np.ndarray:
    """Return values [node, component, sample] interpolated to places."""
    weight = at.weight[:, None, None]
    return (1 - weight) * values[at.left] + weight * values[at.right]


def sections_of(
    system: BlockSystem,
    samples: Samples,
    count: int,
    sections: Interpolation,
    reads: Sections,
    first: int = 0,
) -> np.ndarray:
    """Return force over area at sections between contacts, Pa, along y [section, n], or [section,
    3, n] along x, y, z: that on the far side.

    reads : the blocks and contacts that the samples are of. first : number of the first sample.
    """
    blocks, crossed = system.blocks, np.unique(np.concatenate([sections.left, sections.right]))
    dim, inner = blocks.dim, crossed[(crossed > 0) & (crossed < blocks.count)]
    force = np.zeros((len(crossed), dim, count))
    own = np.searchsorted(reads.watched, inner - 1)
    axes = [0] if dim == 1 else [2, 0, 1]  # of the frame y, z, x
    force[np.isin(crossed, inner)] = samples.contact[own][:, axes, :count]
    for block, contact, sign in ((0, 0, 1.0), (blocks.count - 1, blocks.count, -1.0)):
        if contact in crossed:
            pushed = on_end(system, samples, count, reads, block, first)
            force[np.searchsorted(crossed, contact)] = sign * pushed
    at = sections._replace(
        left=np.searchsorted(crossed, sections.left), right=np.searchsorted(crossed, sections.right)
    )
    found = between(force / blocks.properties.area, at)
    return found[:, 0] if dim == 1 else found


def on_end(
    system: BlockSystem, samples: Samples, count: int, reads: Sections, block: int, first: int
) -> np.ndarray:
    """Return the force of an end, and the load there, on its block [d, n], N. Samples of contacts
    are along the axis if that is all."""
    dim, met, held = system.blocks.dim, system.blocks.contacts, system.model.held
    row = int(np.searchsorted(held.block, block))
    steps = system.time.stride * (first + np.arange(count))
    place = np.searchsorted(reads.places, block)
    moving = samples.velocity[place, :, :count]
    if system.model.form.finite:
        turn = samples.displacement[place, dim:, :count].T[:, None]
        spin = spin_of(turn, moving.T, system.blocks.properties)
        moving = np.concatenate([moving[:dim], spin[:, 0].T])
    drive = system.loads.drive(steps)[:: system.model.form.stages]
    found = drive[:, row].T - held.matrices[row, 2] @ moving
    if samples.closure is not None:
        found -= held.springs[row, 2] @ samples.closure[row, :, :count]
    beside, beyond = met.blocks[:, 0] == block, met.blocks[:, 1] >= system.blocks.count
    for wall in np.flatnonzero(beside & beyond):
        own = samples.contact[np.searchsorted(reads.watched, wall), :dim, :count]
        found[:dim] -= own if dim == 1 else met.frame[wall].T @ own
    return found[:dim]


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


def recorder(system: BlockSystem, state: State) -> BlockRecorder | None:
    """Return the recorder of snapshots; None without."""
    blocks, time = system.blocks, system.time
    if blocks.scene.record.fields is None:
        return None
    nodes = np.arange(blocks.count + 1)
    everywhere = Interpolation(nodes, nodes, np.zeros(len(nodes)))
    whole = np.arange(len(blocks.contacts.area))
    reads = Sections(everywhere, everywhere, nodes[:-1], whole)

    def capture(sample: int) -> BlockFrame:
        """Return all blocks at a sample."""
        found = system.sampled(state, sample, reads.places, reads.watched)
        stress = sections_of(system, found, 1, everywhere, reads, sample)
        along = stress[:, 0] if blocks.dim == 1 else stress[:, 1, 0]
        return BlockFrame(along, found.displacement[..., 0], found.velocity[..., 0])

    mean_over = None if system.loads.composed else time.dt
    return BlockRecorder(blocks.scene, blocks.properties, capture, mean_over)


def moved_apart(system: BlockSystem, state: State) -> Moved | None:
    """Return the joint whose faces have slipped furthest at its centre; opening leaves faces as
    large. None where motion is along the axis."""
    if system.blocks.dim == 1:
        return None
    p, joints = system.blocks.properties, system.blocks.count - 1
    moved = motion_of_contacts(system, state)[:joints]
    by = np.linalg.norm(moved[:, 1 : system.blocks.dim], axis=1)
    k = int(by.argmax())
    return Moved(k, k + 1, float(by[k]), p.side, (float(p.centre_y[k]),))


def refuse_large_rotation(system: BlockSystem, state: State, t: float) -> None:
    """Raise SceneError if blocks have rotated too far for small rotations at t (s)."""
    scene, form = system.blocks.scene, system.model.form
    if not form.turns or form.finite:
        return
    turn = np.abs(state.u[: system.blocks.count, form.dim :])
    if turn.max() > MOST_TURN:
        block = int(turn.max(axis=1).argmax()) + 1
        raise SceneError(
            scene.where,
            "motion.rotation",
            scene.motion.rotation,
            f"block {block} has turned by {turn.max():.3g} rad at t = {t:.4g} s, beyond the "
            f"{MOST_TURN:g} rad of small rotations: set motion.rotation = 'finite'",
        )
