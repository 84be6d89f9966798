"""The chain of rigid blocks by scipy's adaptive integrator, a straightforward implementation.

The equations are those of `compare.exact.blocks.chain`; steps are chosen by the integrator's own
estimate of its error, regardless of the load's kinks.
"""

from time import perf_counter

import xarray as xr

from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.blocks.chain import chain, rates, receivers
from jointwave.compare.exact.blocks.lattice import HELD, at_rest
from jointwave.compare.exact.conditions import drive, holds
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.solvers.record import Answer
from jointwave.results.dataset import dataset

NAME = "solve-ivp"
ENGINE = DEM.name
ARGUMENTS = ("rtol",)


def applies(scene: Scene) -> Answer:
    """Return whether the scene is a chain of rigid blocks that moves along the axis."""
    return holds(scene, (*HELD, "no tension"))


def solve(scene: Scene, rtol: float = 1e-6, method: str = "DOP853") -> xr.Dataset:
    """Return the solution of a scene's chain of rigid blocks by `scipy.integrate.solve_ivp`.

    rtol : relative tolerance; the absolute one is that of the speed that the load can cause. The
    attribute `steps` counts the evaluations of all forces.
    """
    from scipy.integrate import solve_ivp

    began = perf_counter()
    model, signal, times = chain(scene), drive(scene), sample_times(scene)
    rest, push = at_rest(scene, model), scene.load.amplitude / scene.load.scale * model.gain
    # A typical speed (m/s).
    speed = abs(push) / (1.0 if model.shaken else model.end.dashpot) or 1.0
    ready = perf_counter()
    solution = solve_ivp(
        lambda t, x: rates(model, x, float(signal.value(t)) * model.gain),
        (times[0], times[-1]),
        rest,
        method=method,
        t_eval=times,
        rtol=rtol,
        atol=rtol * speed,
    )
    driven = signal.value(times) * model.gain
    waves = (wave.T for wave in receivers(scene, model, solution.y.T, driven))
    return dataset(
        scene,
        NAME,
        times,
        *waves,
        rtol=rtol,
        steps=int(solution.nfev),
        degrees_of_freedom=model.block_count,
        seconds_setup=ready - began,
        seconds_stepping=perf_counter() - ready,
    )
