"""What a run has recorded, in the form of a result."""

import numpy as np

from cases.result import ALL_TERMS
from cases.scene import Scene
from continuum.build import Discrete
from continuum.model import Model, Samples
from continuum.record import TERMS


def waveforms(scene: Scene, discrete: Discrete, samples: Samples) -> dict[str, np.ndarray]:
    """Return the recorded fields at the scene's receivers, as `cases.result.fields` takes them.

    Prestress is part of every stress. What a mesh in two dimensions has no room for is zero.
    """
    components = discrete.body.section.components
    force = _by_component(samples.stress, components)
    stress = force[0] + (scene.prestress.normal if scene.prestress else 0.0)
    motion = {"velocity": samples.velocity, "displacement": samples.displacement}
    if components == 1:
        return {"stress": stress, **motion}
    found = {
        "stress": stress,
        "shear": np.moveaxis(_padded(force[1:], 2), 0, 2),
        **{
            name: np.moveaxis(_padded(_by_component(wave, components), 3), 0, 2)
            for name, wave in motion.items()
        },
    }
    if samples.turn is not None:
        found["rotation"] = np.moveaxis(_by_component(samples.turn, 3), 0, 2)
    return found


def _by_component(waves: np.ndarray, components: int) -> np.ndarray:
    """Return [component, place, sample] of rows that hold all places of one component together."""
    return waves.reshape(components, -1, waves.shape[1])


def _padded(waves: np.ndarray, components: int) -> np.ndarray:
    """Return the same with zeros for components that are not there."""
    missing = np.zeros((components - len(waves), *waves.shape[1:]))
    return np.concatenate([waves, missing])


def energy_terms(
    model: Model, energy: np.ndarray | None
) -> tuple[tuple[str, ...], np.ndarray | None]:
    """Return the terms that the ledger of a model has, in the order of every result, and them."""
    joints = model.interfaces
    law = None if joints is None else joints.law
    shears = law is not None and law.shear_stiffness is not None
    there = {
        "fracture": law is not None and law.tensile_strength is not None,
        "friction": shears and not (law.cohesion is None and law.friction is None),
        "gravity": model.weight is not None,
    }
    terms = tuple(t for t in ALL_TERMS if t in TERMS and there.get(t, True))
    if energy is None:
        return terms, None
    return terms, energy[[TERMS.index(t) for t in terms]]
