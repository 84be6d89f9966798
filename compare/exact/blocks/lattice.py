"""The chain of rigid blocks, exact in time: the equations of the rigid-block engine.

x' = A x + b f(t) with the state matrix of `chain`, solved by matrix exponentials. Without
dashpots and with free ends its modes are omega_n = 2 sqrt(k/m) sin(n pi / 2N) of shape
cos(n pi (j - 1/2) / N), j = 1..N; Kelvin-Voigt dashpots are proportional and damp each mode at the
rate eta omega_n^2 / 2 (Brillouin, Wave Propagation in Periodic Structures, 1946).

Its only error is round-off, bounded by the difference from a perturbed twin solution (`linear`).

The solution is a sum: the response to the drive from rest, the static state under gravity (or the
response to suddenly applied gravity), and the prestress.

Valid for any load or shaken base, soft layers, segments, dashpots, mass-proportional damping, ends,
gravity along the axis and prestress; every joint carries tension.
"""

import numpy as np
import xarray as xr

from jointwave.cases.histories import Step
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.blocks.chain import Chain, chain, rates, receivers, standing
from jointwave.compare.exact.conditions import DAMPED, LAYERS, drive, holds
from jointwave.compare.exact.linear import errors, twins
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin
from jointwave.results.dataset import dataset

MOST_BLOCKS = 2000
HELD = (
    "reversed load",
    "segments",
    "scatter",
    "gravity",
    "prestress",
    "mass damping",
    "fixed start",
    *DAMPED,
    *LAYERS,
)


def applies(scene: Scene) -> Answer:
    """Return whether the scene's chain of rigid blocks is linear and not too long."""
    many = f"more than {MOST_BLOCKS:,} blocks: the matrix exponential is dense"
    return holds(scene, HELD, (scene.block_count > MOST_BLOCKS, many))


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement of the scene's rigid-block chain."""
    model, signal, times = chain(scene), drive(scene), sample_times(scene)
    matrix, vector = state_space(model)
    still, rest = np.zeros(model.size), at_rest(scene, model)
    alone = np.concatenate(receivers(scene, model, still))
    output = np.concatenate(receivers(scene, model, np.eye(model.size)), axis=1).T - alone[:, None]
    out = twins(matrix, vector, output, signal, times) + output @ rest + alone
    if model.gravity and not rest.any():
        out += twins(matrix, rates(model, still), output, Step(1.0), times)
    direct = receivers(scene, model, still, model.gain)[0] - alone[: len(scene.record.stress)]
    out[..., : len(direct)] += np.outer(signal.value(times), direct)
    cuts = np.cumsum([len(scene.record.stress), len(scene.record.velocity)])
    found, twin = (np.split(x.T, cuts) for x in out)
    return dataset(scene, SOLVER.name, times, *found, errors=errors(found, twin))


def state_space(model: Chain) -> tuple[np.ndarray, np.ndarray]:
    """Return A [size, size] (1/s) and b [size] of x' = A x + b f, f the scene's `drive` signal."""
    state = np.zeros(model.size)
    still = rates(model, state)
    matrix = (rates(model, np.eye(model.size)) - still).T
    return matrix, rates(model, state, model.gain) - still


def at_rest(scene: Scene, model: Chain) -> np.ndarray:
    """Return the chain's initial state [size]: at rest, under static gravity if any.

    The springs of matched ends are relaxed: what they bear acts beside them.
    """
    if scene.gravity is None or not scene.gravity.static:
        return np.zeros(model.size)
    _, state = standing(scene, model)
    if model.start.kind == "matched":
        state[-2] = state[0]
    if model.end.kind == "matched":
        state[-1] = state[model.block_count - 1]
    return state


SOLVER = Solver(
    name="lattice",
    rock=Rock.RIGID_BLOCKS,
    label="rigid blocks, exact",
    line=thin("#00349a", 9, (0, 4)),
    applies=applies,
    run=solve,
    distances={Kind.NUMERICAL: {"dem": "time stepping of the rigid blocks"}},
)
