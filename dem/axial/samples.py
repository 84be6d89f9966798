"""Samples of a running chain: waveforms at receivers and the energy ledger."""

from typing import Any, NamedTuple

import numpy as np

from jointwave.dem.axial.model import Effects, Model
from jointwave.dem.axial.state import State
from jointwave.numerics.cache_lines import zeros


class Samples(NamedTuple):
    """Buffers for what is recorded, [receiver, sample].

    energy : [term, sample], J, the terms those of `terms`; None where no ledger is kept.
    v_before : each block's velocity before the sampled step, and before that the energies of all
        joints; None likewise.
    """

    stress: np.ndarray
    velocity: np.ndarray
    displacement: np.ndarray
    energy: Any
    v_before: Any


def terms(effects: Effects) -> tuple[str, ...]:
    """Return the terms of the energy ledger, the rows of its samples."""
    fracture = ("fracture",) if effects.joints.softening else ()
    gravity = ("gravity",) if effects.gravity else ()
    return ("kinetic", "elastic", "viscous", *fracture, "boundary", *gravity, "work")


def buffers(model: Model, state: State, samples: int) -> Samples:
    """Return empty samples."""
    sections, points = len(model.receivers.sections.left), len(model.receivers.points.left)
    ledger = state.work is not None
    return Samples(
        stress=np.zeros((sections, samples)),
        velocity=np.zeros((points, samples)),
        displacement=np.zeros((points, samples)),
        energy=np.zeros((len(terms(model.effects)), samples)) if ledger else None,
        v_before=zeros(state.v.size) if ledger else None,
    )
