"""The chain of rigid blocks whose joints bar tension, by a tight ODE solver.

The equations of `chain` by DOP853 (Hairer, Norsett & Wanner, Solving ODEs I, 1993) at a relative
tolerance of 1e-9, from one break of the load to the next. Joints that open or close make the
right-hand side discontinuous; the step control finds those times by itself. It shares no code
with the engines' joint laws.

Holds for any load or shaken base, soft layers, dashpots, mass-proportional damping, ends, gravity
along the axis and prestress, if no joint that bars tension would be pulled at rest.

`contact` is the closed form for one such contact between two half-spaces: closed, it passes the
incident stress; open, the far side stands still, the near side moves at twice the incident
velocity v_I, and the gap grows at -2 v_I until it returns to zero. With the impulse I of the
incident stress this is gap = (2/Z)(max_{s <= t} I(s) - I(t)).
"""

from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import xarray as xr

from cases.calibrate import calibrate
from cases.loads import LoadHistory
from cases.result import dataset
from cases.sampling import sample_times
from cases.scene import Scene
from cases.size import require
from compare.exact.answer import YES, Answer, Resolves, Rock, no
from compare.exact.chain import Chain, chain, contact_forces, rates, receivers
from compare.exact.conditions import bars_tension, beyond
from compare.exact.drive import Signal, drive
from compare.exact.lattice import HELD, at_rest

NAME = "no-tension-chain"
RESOLVES = Resolves(Rock.RIGID_BLOCKS)
RELATIVE_TOLERANCE = 1e-9
MOST_BLOCKS = 2000


def applies(scene: Scene) -> Answer:
    """Return whether a joint of the chain bars tension and the chain is not too long."""
    if reason := beyond(scene, *HELD):
        return no(reason)
    if not bars_tension(calibrate(scene)):
        return no("every joint carries tension: see lattice")
    if scene.pillar.block_count > MOST_BLOCKS:
        return no(f"more than {MOST_BLOCKS:,} blocks: too many for a tight ODE solver")
    return no("a joint that bars tension is pulled at rest") if _pulled(scene) else YES


def _pulled(scene: Scene) -> bool:
    """Return whether the static state without a load opens a joint that bars tension."""
    model = chain(scene)
    elastic = replace(model, tension=np.ones_like(model.tension))
    forces, _ = contact_forces(elastic, at_rest(scene, model))
    return bool((forces[1:-1][~model.tension] < 0).any())


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement of the scene's rigid-block chain."""
    model, signal, times = chain(scene), drive(scene), sample_times(scene)
    states = integrate(model, signal, times, at_rest(scene, model))
    driven = signal.value(times) * model.gain
    fields = (field.T for field in receivers(scene, model, states, driven))
    return dataset(scene, NAME, times, *fields, rtol=RELATIVE_TOLERANCE)


def integrate(
    chain: Chain,
    load: Signal,
    times: np.ndarray,
    rest: np.ndarray | None = None,
    rtol: float = RELATIVE_TOLERANCE,
) -> np.ndarray:
    """Return the chain's states [n, size] at `times` (s).

    It starts from the state `rest` [size], absent: zero; the tolerances are on what it moves since.
    """
    require(3 * 8.0 * len(times) * chain.size, f"{len(times):,} states of {chain.size:,} numbers")
    rest = np.zeros(chain.size) if rest is None else rest
    scale = _speed(chain, load, times)
    breaks = [t for t in load.breaks if times[0] < t < times[-1]]
    state = np.zeros(chain.size)
    states = [state[None]]
    for start, end in pairwise([times[0], *breaks, times[-1]]):
        at = times[(times > start) & (times <= end)]
        at_end = np.append(at, end)
        part = _smooth_part(chain, load, rest, state, at_end, start, rtol, rtol * scale)
        states.append(part[: len(at)])
        state = part[-1]
    return rest + np.concatenate(states)


def _speed(chain: Chain, load: Signal, times: np.ndarray) -> float:
    """Return a speed (m/s) of the size of what happens, for the absolute tolerance."""
    driven = float(np.abs(load.value(times)).max() * abs(chain.gain))
    speed = driven / (1.0 if chain.shaken else chain.dashpot)
    return speed or abs(chain.gravity) / chain.rate or 1.0


def _smooth_part(chain, load, rest, state, at, start, rtol, atol) -> np.ndarray:
    """Return the states at times `at`, between whose first and last the load is smooth."""
    from scipy.integrate import solve_ivp

    within = 1e-12 * (at[-1] - start)  # a load's value at its break may belong to either side

    def slope(t, x):
        inside = min(max(t, start + within), at[-1] - within)
        return rates(chain, rest + x, float(load.value(inside)) * chain.gain)

    samples, index = np.unique(at, return_inverse=True)
    solution = solve_ivp(
        slope,
        (start, at[-1]),
        state,
        method="DOP853",
        t_eval=samples,
        rtol=rtol,
        atol=atol,
        max_step=2 / chain.rate,  # never over a whole pulse
    )
    return solution.y.T[index]


class Contact(NamedTuple):
    """Waves and gap at one no-tension contact: float arrays over time, Pa, Pa and m."""

    transmitted: np.ndarray
    reflected: np.ndarray
    gap: np.ndarray


def contact(load: LoadHistory, times: np.ndarray, impedance: float) -> Contact:
    """Return what a pulse does at a no-tension contact between half-spaces of equal impedance.

    `load` is the incident stress at the contact (Pa); the times (s) from before its start, at
    which the contact opens: exact where they hold the zeros of the load.
    """
    incident, impulse = load.value(times), load.impulse(times)
    gap = 2 / impedance * (np.maximum.accumulate(impulse) - impulse)
    transmitted = np.where(gap > 0, 0.0, incident)
    return Contact(transmitted, transmitted - incident, gap)
