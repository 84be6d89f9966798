"""The waveforms of a run as a dataset, for pillars and rock masses."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from jointwave.cases.scene_type import AnyScene
from jointwave.continuum.stepping.arrays import Samples
from jointwave.continuum.stepping.problem import Problem
from jointwave.results.dataset import TERMS, dataset


def recorded(
    scene: AnyScene, problem: Problem, samples: Samples, times: np.ndarray, about: Mapping[str, Any]
) -> xr.Dataset:
    """Return the samples at these times, from the first on, as a result with attributes."""
    samples = Samples(*(one[:, : len(times)] for one in samples))
    if scene.is_column:
        waves = of_pillar(problem, samples)
    else:
        waves = of_rock_mass(problem.body.components, samples)
    ledger, engine = ledger_of(scene, problem, samples), f"continuum-{about['model']}"
    return dataset(scene, engine, times, waves, **ledger, **about)


def of_pillar(problem: Problem, samples: Samples) -> dict[str, Any]:
    """Return the waveforms of a pillar by the names of `dataset`; in 2D z components are zero."""
    dim, turns = problem.body.components, problem.body.x.shape[1] > 1
    whole, places = 3 if dim > 1 else 1, len(samples.velocity) // (dim + 3 * turns)
    force = vectors(samples.stress + samples.traction, dim, whole)
    velocity, displacement = (
        vectors(one[: places * dim], dim, whole) for one in (samples.velocity, samples.displacement)
    )
    found = {"stress": force, "velocity": velocity, "displacement": displacement}
    if dim == 1:
        return {name: one[..., 0] for name, one in found.items()}
    found |= {"stress": force[..., 0], "shear": force[..., 1:]}
    if turns:
        found["rotation"] = vectors(samples.displacement[places * dim :], 3)
    return found


def vectors(rows: np.ndarray, size: int, whole: int = 0) -> np.ndarray:
    """Return vectors [places, samples, size] from rows by place, then component; zeros fill up to
    `whole` components."""
    found = rows.reshape(-1, size, rows.shape[1]).swapaxes(1, 2)
    return np.pad(found, ((0, 0), (0, 0), (0, max(0, whole - size))))


def ledger_of(scene: AnyScene, problem: Problem, samples: Samples) -> dict[str, Any]:
    """Return the energies of the scene's effects and their terms, as arguments of `dataset`. The
    work of prestressed rock on walls of openings counts as elastic energy."""
    parts, found = problem.parts, samples.energy.copy()
    if not found.size:
        return {}
    has = {"friction": parts and parts.limited, "fracture": parts and parts.softening}
    has["gravity"] = scene.gravity is not None
    if scene.excavated and scene.gravity is None:
        found[TERMS.index("elastic")] += found[TERMS.index("gravity")]
    found *= scene.left_out(problem.body.x.shape[1])
    rows = [row for row, term in enumerate(TERMS) if has.get(term, True)]
    return {"energy": found[rows], "terms": tuple(TERMS[row] for row in rows)}


def of_rock_mass(dim: int, samples: Samples) -> dict[str, np.ndarray]:
    """Return the waveforms of a rock mass by the names of `dataset`, relative to the start."""
    displacement, jump = (
        vectors(rows - rows[:, :1], dim) for rows in (samples.displacement, samples.jump)
    )
    found = {
        "velocity": vectors(samples.velocity, dim),
        "displacement": displacement,
        "stress": vectors(samples.stress, dim * (dim + 1) // 2),
    }
    if len(jump):
        slip = jump[..., 1] if dim == 2 else jump[..., 1:]
        found |= {"traction": vectors(samples.traction, dim), "gap": jump[..., 0], "slip": slip}
    return found
