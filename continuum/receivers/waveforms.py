"""The waveforms of a run as a result of its kind of scene."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.scene_type import AnyScene
from jointwave.continuum.receivers.sections import extent_of
from jointwave.continuum.stepping.arrays import Samples
from jointwave.continuum.stepping.problem import Problem
from jointwave.results.dataset import dataset
from jointwave.results.rock_mass import TERMS, rock_mass_dataset


def recorded(
    scene: AnyScene,
    problem: Problem,
    samples: Samples,
    times: np.ndarray,
    about: Mapping[str, Any],
) -> xr.Dataset:
    """Return the samples at these times, the first ones, as a result with attributes."""
    count, name = len(times), f"continuum-{about['model']}"
    terms, energy = ledger(scene, problem, samples, count)
    if scene.is_column:
        if energy is not None:
            energy = extent_of(scene, problem.body) * energy
        waves = waveforms(problem, samples, count)
        return dataset(scene, name, times, **waves, energy=energy, terms=terms, **about)
    found = quantities(problem, samples, count)
    return rock_mass_dataset(scene, name, times, found, energy, terms, **about)


def waveforms(problem: Problem, samples: Samples, count: int) -> dict[str, Any]:
    """Return what was recorded in the first samples of a pillar by name, as `dataset` takes it.

    Components absent in two dimensions are zero.
    """
    body, dim = problem.body, problem.body.components
    rows = samples.stress[:, :count] + samples.traction[:, :count]
    force = vectors(rows, dim, max(dim, 3 if dim > 1 else 1))
    turns = body.x.shape[1] > 1
    places = samples.velocity.shape[0] // (dim + 3 * turns)
    motion = {
        name: vectors(getattr(samples, name)[: places * dim, :count], dim, 3 if dim > 1 else 1)
        for name in ("velocity", "displacement")
    }
    if dim == 1:
        return {"stress": force[..., 0]} | {name: one[..., 0] for name, one in motion.items()}
    found = {"stress": force[..., 0], "shear": force[..., 1:], **motion}
    if turns:
        found["rotation"] = vectors(samples.displacement[places * dim :, :count], 3, 3)
    return found


def vectors(rows: np.ndarray, size: int, beyond: int | None = None) -> np.ndarray:
    """Return vectors [places, samples, size] of rows with all components of a place together, up to
    the size `beyond` with zeros."""
    found = rows.reshape(-1, size, rows.shape[1]).swapaxes(1, 2)
    return np.pad(found, ((0, 0), (0, 0), (0, (beyond or size) - size)))


def ledger(
    scene: AnyScene, problem: Problem, samples: Samples, count: int
) -> tuple[tuple[str, ...], np.ndarray | None]:
    """Return the terms that a ledger has, and the energies of the first samples; None where they
    are not recorded. What prestressed rock gives off where walls of openings give way counts with
    what it stores."""
    parts = problem.parts
    there = {
        "fracture": parts is not None and parts.softening,
        "friction": parts is not None and parts.limited,
        "gravity": scene.gravity is not None,
    }
    terms = tuple(one for one in TERMS if there.get(one, True))
    if not samples.energy.size:
        return terms, None
    found = samples.energy[:, :count].copy()
    if scene.excavated and scene.gravity is None:
        found[TERMS.index("elastic")] += found[TERMS.index("gravity")]
    return terms, found[[TERMS.index(one) for one in terms]]


def quantities(problem: Problem, samples: Samples, count: int) -> dict[str, np.ndarray]:
    """Return what was recorded in the first samples of a rock mass by name, as `rock_mass_dataset`
    takes it.

    Motion counts from the state at the start. Without joints nothing is known of them.
    """
    dim = problem.body.components

    def since(rows: np.ndarray) -> np.ndarray:
        return vectors((rows - rows[:, :1])[:, :count], dim)

    found = {
        "velocity": vectors(samples.velocity[:, :count], dim),
        "displacement": since(samples.displacement),
        "stress": vectors(samples.stress[:, :count], dim * (dim + 1) // 2),
    }
    if len(samples.jump):
        jump = since(samples.jump)
        slip = jump[..., 1] if dim == 2 else jump[..., 1:]
        traction = vectors(samples.traction[:, :count], dim)
        found |= {"traction": traction, "gap": jump[..., 0], "slip": slip}
    return found
