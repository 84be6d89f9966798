"""Place and time at which a pulse first breaks a bar with a free end, and the chain.

At the distance x from the free end a pulse f, which entered the start at t = 0, and its reflection
add up to the tension (Kolsky, Stress Waves in Solids, 1953)

    f(t - (L + x)/c) - f(t - (L - x)/c)

A saw tooth of length lam breaks at x = lam sigma_t / (2 p0). Holds until the reflection is back at
the start.
"""

from math import ceil
from typing import NamedTuple

import numpy as np

from cases.histories import LoadHistory
from cases.material.calibrate import calibrate
from cases.sampling import sample_times
from cases.schema.scene import Scene
from compare.exact.blocks.chain import chain, contact_forces
from compare.exact.blocks.lattice import at_rest, state_space
from compare.exact.drive import drive
from compare.exact.linear import _gauss, _load_on_nodes, twins

PLACES, TIMES = 2001, 6001  # at which the tension in a bar is looked at


class Spall(NamedTuple):
    """Where and when tension first reaches the strength.

    distance : from the free end, m. time : since the pulse entered at the start, s.
    """

    distance: float
    time: float


def spall(
    load: LoadHistory, strength: float, length: float, speed: float, duration: float
) -> Spall | None:
    """Return the first failure in tension of a homogenised bar, None where there is none.

    Parameters
    ----------
    load : the end stress, Pa, compression positive. strength : tensile strength, Pa.
    length, speed : of the bar, m and m/s. duration : s.
    """
    x = np.linspace(0.0, length, PLACES)
    for t in np.linspace(0.0, duration, TIMES):
        tension = load.value(t - (length + x) / speed) - load.value(t - (length - x) / speed)
        if tension.max() >= strength:
            return Spall(float(x[tension.argmax()]), float(t))
    return None


def advance(
    matrix: np.ndarray,
    vector: np.ndarray,
    state: np.ndarray,
    load: LoadHistory,
    start: float,
    h: float,
) -> np.ndarray:
    """Return the state [m] that `state` at `start` (s) becomes a time h (s) later."""
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import expm_multiply

    A = csr_array(matrix)
    nodes, weights = _gauss(h, 12 + ceil(h * np.abs(matrix).sum(axis=0).max()))
    share = _load_on_nodes(load, np.array([start]), h, nodes, weights)[0]
    G = np.stack([expm_multiply(A * (h - s), vector) for s in nodes], axis=1)
    return expm_multiply(A * h, state) + G @ share


def lattice_spall(scene: Scene) -> Spall | None:
    """Return the first failure of the scene's rigid-block chain, at one of its joints.

    The chain is linear until then, so its exact solution holds; gravity, if any, is static.
    """
    p, model, times = calibrate(scene), chain(scene), sample_times(scene)
    strength = p.tensile_strength
    assert strength is not None
    signal, (matrix, vector), rest = drive(scene), state_space(model), at_rest(scene, model)
    states = twins(matrix, vector, np.eye(model.size), signal, times)[0]

    def excess(moved: np.ndarray) -> np.ndarray:
        forces, _ = contact_forces(model, rest + moved)
        return -forces[..., 1:-1] / model.area - strength

    broken = (excess(states) >= 0).any(axis=1)
    if not broken.any():
        return None
    last = int(np.argmax(broken)) - 1
    if last < 0:
        return Spall(scene.pillar.length - p.joint_y[np.argmax(excess(states[0]))], 0.0)
    from scipy.optimize import brentq

    def later(h: float) -> np.ndarray:
        return excess(advance(matrix, vector, states[last], signal, times[last], h))

    h = brentq(lambda h: float(later(h).max()), 1e-9 * scene.interval, scene.interval)
    y = p.joint_y[np.argmax(later(h))]
    return Spall(float(scene.pillar.length - y), float(times[last] + h))
