"""The chain of rigid blocks, exact in time: what the rigid-block engine discretises.

x' = A x + b f(t) with the state matrix of `chain`, solved by matrix exponentials. Without
dashpots and with free ends its modes are omega_n = 2 sqrt(k/m) sin(n pi / 2N) of shape
cos(n pi (j - 1/2) / N), j = 1..N; Kelvin-Voigt dashpots are proportional and damp each mode at the
rate eta omega_n^2 / 2 (Brillouin, Wave Propagation in Periodic Structures, 1946).

Holds for any load, soft layers, dashpots and ends; every joint carries tension.
"""

import numpy as np
import xarray as xr

from cases.calibrate import calibrate
from cases.loads import load_history
from cases.result import dataset
from cases.sampling import sample_times
from cases.scene import Scene
from compare.exact.answer import YES, Answer, no
from compare.exact.chain import Chain, chain, rates, receivers
from compare.exact.conditions import bars_tension
from compare.exact.linear import response

NAME = "lattice"
MOST_BLOCKS = 2000


def applies(scene: Scene) -> Answer:
    """Return whether the scene's chain of rigid blocks is linear and not too long."""
    if bars_tension(calibrate(scene)):
        return no("a joint bars tension")
    if scene.pillar.block_count > MOST_BLOCKS:
        return no(f"more than {MOST_BLOCKS:,} blocks: the matrix exponential is dense")
    return YES


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement of the scene's rigid-block chain."""
    model, load, times = chain(scene), load_history(scene), sample_times(scene)
    matrix, vector = state_space(model)
    output = np.concatenate(receivers(scene, model, np.eye(model.size)), axis=1).T
    out = response(matrix, vector, output, load, times).T
    stress, velocity, displacement = np.split(
        out, np.cumsum([len(scene.record.stress), len(scene.record.velocity)])
    )
    direct, _, _ = receivers(scene, model, np.zeros(model.size), load=model.area)
    stress = stress + np.outer(direct, load.value(times))
    return dataset(scene, NAME, times, stress, velocity, displacement)


def state_space(model: Chain) -> tuple[np.ndarray, np.ndarray]:
    """Return A [size, size] (1/s) and b [size] of x' = A x + b f, f the end stress in Pa."""
    matrix = rates(model, np.eye(model.size)).T
    return matrix, rates(model, np.zeros(model.size), load=model.area)


def frequencies(stiffness: float, mass: float, block_count: int) -> np.ndarray:
    """Return the chain's N natural frequencies (rad/s), undamped, free ends; the first is rigid.

    stiffness in N/m, mass in kg.
    """
    n = np.arange(block_count)
    return 2 * np.sqrt(stiffness / mass) * np.sin(n * np.pi / (2 * block_count))
