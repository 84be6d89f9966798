"""Records of a row in space: waveforms, snapshots of all blocks, fragments."""

from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.loads import with_load_itself
from jointwave.cases.material.calibrate import Properties
from jointwave.cases.sampling import Clock, Interpolation
from jointwave.cases.schema.scene import Scene
from jointwave.dem.fragments import with_fragments
from jointwave.dem.pillar_snapshots import BlockFrame
from jointwave.dem.spatial.build import (
    buffers_for,
    build_receivers,
    energy_terms,
    receivers,
    samples_for,
)
from jointwave.dem.spatial.layout import LANES, STRIDE, TERMS, unpacked
from jointwave.dem.spatial.march import make_stepper
from jointwave.dem.spatial.model import RowModel, RowSamples, RowState
from jointwave.dem.static import since_prestress
from jointwave.numerics.divergence import guard
from jointwave.results.arrays import copied


def waveforms(scene: Scene, p: Properties, samples: RowSamples, time: Clock) -> dict[str, Any]:
    """Return the recorded fields at the scene's receivers, as `results.dataset.dataset` takes
    them."""
    sections, points = receivers(scene, p)
    force, velocity = between(samples.force, sections), between(samples.velocity, points)
    times = time.times[: force.shape[-1]]
    stress = with_load_itself(force[:, :3] / p.area, scene, sections, times, time.dt)
    moved = between(samples.displacement, points)
    moved[:, 1] = since_prestress(scene, p, moved[:, 1], points)
    found = {
        "stress": stress[:, 1],
        "shear": np.moveaxis(stress[:, [0, 2]], 1, 2),
        "velocity": np.moveaxis(velocity[:, :3], 1, 2),
        "displacement": np.moveaxis(moved[:, :3], 1, 2),
    }
    if moved.shape[1] == 6:
        found["rotation"] = np.moveaxis(moved[:, 3:], 1, 2)
    elif moved.shape[1] == 7:
        found["rotation"] = rotation_vectors(np.moveaxis(moved[:, 3:], 1, 2))
    return found


def ledger_of(scene: Scene, p: Properties, samples: RowSamples) -> dict[str, Any]:
    """Return the energies that the scene has, and which they are, as `fields` takes them."""
    terms = energy_terms(scene, p)
    rows = [list(TERMS).index(term) for term in terms]
    return {"energy": samples.energy[rows] if terms else None, "terms": terms}


def rotation_vectors(quaternions: np.ndarray) -> np.ndarray:
    """Return the rotation vectors [..., 3] (rad, up to pi) of quaternions [..., 4], scalar last."""
    from scipy.spatial.transform import Rotation

    if not quaternions.size:
        return quaternions[..., :3]
    lengths = np.linalg.norm(quaternions, axis=-1, keepdims=True)
    turns = Rotation.from_quat((quaternions / lengths).reshape(-1, 4))
    return turns.as_rotvec().reshape(*quaternions.shape[:-1], 3)


def between(values: np.ndarray, at: Interpolation) -> np.ndarray:
    """Return values [left and right of each place, freedom, sample] interpolated to the places."""
    left, right = np.split(values, 2)
    weight = at.weight[:, None, None]
    return (1 - weight) * left + weight * right


def capturing(
    p: Properties, model: RowModel, state: RowState, threads: int
) -> Callable[[int], Any]:
    """Return what takes a sample of all contacts and blocks, on a copy of the state.

    A velocity at a whole step needs the step, as it does at the receivers.
    """
    everything = build_receivers(_all(p.block_count + 1), _all(p.block_count))

    def capture(sample: int) -> BlockFrame:
        n = sample * model.stride
        # Samples are at multiples of the stride: step 0, and step n as sample 1.
        everywhere = model._replace(receivers=everything, stride=max(n, 1))
        twin, found = copied(state), samples_for(everywhere, 2)
        # A guard that finds nothing, as the run has one: the same kernel.
        buffers = buffers_for(everywhere, threads, guard([np.inf] * model.form.freedoms))
        make_stepper(everywhere, twin, buffers, found)(n, n + 1)
        force, velocity, displacement = (x[..., min(n, 1)] for x in found[:3])
        return BlockFrame(force[:, 1] / p.area, displacement, velocity)

    return capture


def _all(count: int) -> Interpolation:
    """Return receivers that read every contact and block."""
    return Interpolation(np.arange(count), np.arange(0), np.zeros(count))


def with_breaks(result: xr.Dataset, p: Properties, model: RowModel, state: RowState) -> xr.Dataset:
    """Return a result with its fragments, where joints soften.

    A joint is broken when all its contact points are. Break times are not recorded.
    """
    form = model.form
    if not form.parts.softening:
        return result
    opened = unpacked(state.history, LANES, p.block_count)[form.openings, :-1]
    broken = (opened >= p.critical_opening).all(axis=0)
    motion, first = unpacked(state.motion, STRIDE, p.block_count), form.freedoms
    return with_fragments(result, p, broken, motion[first : first + 3].T)
