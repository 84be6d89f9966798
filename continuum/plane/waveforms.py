"""Recorded waveforms of a rock mass in the form of a result."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from jointwave.continuum.run import Run
from jointwave.continuum.state import Samples
from jointwave.continuum.waveforms import energy_terms, vectors
from jointwave.results.rock_mass import rock_mass_dataset


def quantities(run: Run, samples: Samples) -> dict[str, np.ndarray]:
    """Return what was recorded by name, as `results.rock_mass.rock_mass_dataset` takes it.

    Motion counts from the state at the start. Without joints nothing is known of them.
    """
    points = len(run.scene.record.points)
    stress, tractions = np.split(samples.stress, [3 * points])
    found = {
        "velocity": vectors(samples.velocity, 2),
        "displacement": vectors(samples.displacement - samples.displacement[:, :1], 2),
        "stress": vectors(stress, 3),
    }
    if samples.turn.size:
        gap, slip = vectors(samples.turn - samples.turn[:, :1], 2).transpose(2, 0, 1)
        found |= {"traction": vectors(tractions, 2), "gap": gap, "slip": slip}
    return found


def recorded(run: Run, samples: Samples, times: np.ndarray, about: dict[str, Any]) -> xr.Dataset:
    """Return the result of a rock mass at these times, with attributes about its run."""
    terms, energy = energy_terms(run.model, samples.energy, run.communicator)
    if run.scene.excavated and run.scene.gravity is None:
        terms, energy = _given_off(terms, energy)
    name, found = f"continuum-{run.rock}", quantities(run, samples)
    return rock_mass_dataset(run.scene, name, times, found, energy, terms, **about)


def _given_off(
    terms: tuple[str, ...], energy: np.ndarray | None
) -> tuple[tuple[str, ...], np.ndarray | None]:
    """Return a ledger without a term of steady forces: what prestressed rock gives off where the
    walls of openings give way counts with what it stores."""
    steady, kept = terms.index("gravity"), [k for k, t in enumerate(terms) if t != "gravity"]
    if energy is not None:
        energy[terms.index("elastic")] += energy[steady]
        energy = energy[kept]
    return tuple(terms[k] for k in kept), energy
