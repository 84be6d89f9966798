"""Recorded waveforms in the form of a result."""

from typing import Any

import numpy as np

from jointwave.cases.schema.scene import Scene
from jointwave.continuum.build import Discrete
from jointwave.continuum.model import Model
from jointwave.continuum.parallel.serial import SERIAL, Serial
from jointwave.continuum.space.receivers import is_on_joint
from jointwave.continuum.state import TERMS, Samples
from jointwave.results.dataset import ALL_TERMS


def waveforms(scene: Scene, discrete: Discrete, samples: Samples) -> dict[str, Any]:
    """Return the recorded fields at the scene's receivers, as `results.dataset.dataset` takes them.

    Components absent in two dimensions are zero.
    """
    components = discrete.body.section.components
    force = samples.stress.reshape(components, -1, samples.waves.shape[1])
    stress = force[0] + _prestress(scene, discrete)[:, None]
    motion = {"velocity": samples.velocity, "displacement": samples.displacement}
    if components == 1:
        return {"stress": stress, **motion}
    found = {"stress": stress, "shear": vectors(force[1:], components - 1, 2)}
    found |= {name: vectors(wave, components, 3) for name, wave in motion.items()}
    if samples.turn.size:
        found["rotation"] = vectors(samples.turn, 3, 3)
    return found


def vectors(waves: np.ndarray, components: int, size: int | None = None) -> np.ndarray:
    """Return [place, sample, component] of rows that hold all places of one component together, up
    to `size` with zeros for components that are not there."""
    found = waves.reshape(components, -1, waves.shape[-1])
    beyond = (size or components) - components
    return np.moveaxis(np.pad(found, ((0, beyond), (0, 0), (0, 0))), 0, 2)


def _prestress(scene: Scene, discrete: Discrete) -> np.ndarray:
    """Return the prestress (Pa) of sections in the rock; that on a joint is in its traction."""
    places = np.array(scene.record.stress, dtype=float)
    if scene.prestress is None:
        return np.zeros(places.size)
    on_joint = np.array([is_on_joint(discrete.body, place) for place in places], dtype=bool)
    return np.where(on_joint, 0.0, scene.prestress.normal)


def energy_terms(
    model: Model, energy: np.ndarray | None, communicator: Serial = SERIAL
) -> tuple[tuple[str, ...], np.ndarray | None]:
    """Return the terms that the ledger of a model has, in the order of every result, and them."""
    law = None if model.interfaces is None else model.interfaces.law
    there = {
        "fracture": law is not None and law.tensile_strength is not None,
        "friction": model.interfaces is not None and model.interfaces.parts.limited,
        "gravity": model.weight is not None,
    }
    there = {term: communicator.any(is_there) for term, is_there in there.items()}
    terms = tuple(t for t in ALL_TERMS if t in TERMS and there.get(t, True))
    if energy is None:
        return terms, None
    return terms, energy[[TERMS.index(t) for t in terms]]
