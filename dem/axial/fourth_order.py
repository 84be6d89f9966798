"""Steps of fourth order of the undamped chain, each four of leapfrog's kicks and drifts.

`dem.axial.composition` has the weights. Displacement and velocity both live at whole steps. A stage
is a step of leapfrog, `dem.axial.step`, whose kick and drift have lengths of their own.

The load acts with its value at the time of each kick; a mean over the step, as leapfrog takes it,
would leave second order. The order is four while the load is smooth within steps: a kink within a
step leaves order two, a jump order one, and neither costs anything at the end of a step. Where
joints carry no tension the force has a kink wherever one opens or closes, which leaves order two.

The ledger closes to the fourth order, not to round-off: the map conserves an energy that differs
from the true one by O(dt^4), and this difference stays bounded over any number of steps.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from cases.loads import load_history
from cases.material.calibrate import Properties, calibrate
from cases.sampling import Clock, clock
from cases.schema.scene import Scene
from dem.axial.composition import DRIFTS, EDGES, KICKS, stability_limit
from dem.axial.model import Chain, Model, build_chain, receivers
from dem.axial.motion import steady_at
from dem.axial.record import Samples, sample_after, sample_before
from dem.axial.stability import critical_chain_step
from dem.axial.state import State, state_at_rest
from dem.axial.step import step
from dem.size import refuse_large
from numerics.borrowed import borrowed
from numerics.denormals import flush_tiny, restore_tiny
from numerics.divergence import Guard, is_lost, next_look
from numerics.jit import inlined, jitted


class Composition(NamedTuple):
    """The constants of one step.

    lead : of its first drift, before any kick. stages : of each kick and the drift after it.
    loads : float array [n, 4], N, at the kicks of every step, cut after the last that acts.
    impulses : float array [n, 5], N s, of the load during each drift, likewise.
    stored : what the springs of fixed ends hold before the run, J.
    """

    lead: Chain
    stages: tuple[Chain, ...]
    loads: np.ndarray
    impulses: np.ndarray
    stored: float


def build(scene: Scene) -> tuple[Model, State, Clock, float]:
    """Return the model at an instant, the unloaded state, the clock and the critical step (s).

    The model at an instant is leapfrog's with a step of no length and the load at whole steps.
    """
    p, ends, numerics = calibrate(scene), scene.ends, scene.numerics.dem
    critical = stability_limit() / 2 * critical_chain_step(p, ends.start, ends.end)
    time = clock(scene, critical, numerics.step_fraction, numerics.allow_unstable, "dem")
    refuse_large(scene, time, stages=1 + len(EDGES))
    at_steps = time.dt * np.arange(time.steps + time.stride)
    load = np.trim_zeros(_force(scene, p) * load_history(scene).value(at_steps), "b")
    model = Model(_stage(scene, p, 0.0, 0.0), load, None, receivers(scene, p))
    return model, state_at_rest(model.chain, p.block_count, scene.record.energy), time, critical


def compose(scene: Scene, time: Clock, stored: float = 0.0) -> Composition:
    """Return the constants of one step of this clock; stored in J."""
    p, load, dt = calibrate(scene), load_history(scene), time.dt
    edges = dt * (np.arange(time.steps + time.stride)[:, None] + EDGES)
    return Composition(
        lead=_stage(scene, p, 0.0, DRIFTS[0] * dt),
        stages=tuple(
            _stage(scene, p, kick * dt, drift * dt)
            for kick, drift in zip(KICKS, DRIFTS[1:], strict=True)
        ),
        loads=_acting(_force(scene, p) * load.value(edges[:, 1:-1])),
        impulses=_acting(_force(scene, p) * np.diff(load.impulse(edges), axis=1)),
        stored=stored,
    )


def marcher(
    scene: Scene, model: Model, state: State, samples: Samples, time: Clock, guard: Guard | None
) -> Callable[[int, int], None]:
    """Return a function of (first, last) that takes samples first .. last - 1."""
    composition = compose(scene, time, held(model.chain, state))

    def march(first: int, last: int) -> None:
        run(composition, model, state, samples, time.stride, first, last, guard)

    return march


def _stage(scene: Scene, p: Properties, kick: float, drift: float) -> Chain:
    chain = build_chain(scene, p, drift, (scene.ends.start, scene.ends.end))
    return chain._replace(impulse_to_speed=kick / p.block_mass)


def _force(scene: Scene, p: Properties) -> float:
    """Return the force of a unit of load, along y, m2."""
    return scene.load.direction[1] * p.area


def _acting(values: np.ndarray) -> np.ndarray:
    """Return rows up to the last that is not zero."""
    acting = np.flatnonzero(values.any(axis=1))
    return np.ascontiguousarray(values[: acting[-1] + 1 if acting.size else 0])


@jitted
def run(composition, model, state, samples, stride, first, last, guard=None):
    """Take samples first .. last - 1, `stride` steps apart, the steps after each included.

    guard : `numerics.divergence.Guard` that ends it where it runs out of bounds; None without.
    """
    tiny = flush_tiny()
    composition, model, state, samples = borrowed((composition, model, state, samples))
    s, n, end = first, first * stride, last * stride
    due = next_look(guard, n, end)
    while n < end:
        if n == s * stride:
            book_ends(state.ledger, held(model.chain, state) - composition.stored)
            sample_before(model, state, samples, s)
            sample_after(model, state, samples, s, n)
            s += 1
        stop = min(s * stride, due)
        march(composition, state, n, stop)
        n = stop
        if n == due:
            if is_lost(guard, state.v, n, None, s - 1, stride):
                break
            due = next_look(guard, n, end)
    restore_tiny(tiny)


@jitted
def march(composition, state, first, last):
    """Take steps first .. last - 1, each from u, v at its start to u, v at its end."""
    u, v, start, end, ledger = state.u, state.v, state.start, state.end, state.ledger
    lead, loads, impulses = composition.lead, composition.loads, composition.impulses
    for n in range(first, last):
        drift(lead, u, v, start, end)
        book_work(lead, ledger, v, at(impulses, n, 0))
        for k in range(loads.shape[1]):
            chain, load = composition.stages[k], at(loads, n, k)
            step(chain, u, v, None, None, None, start, end, None, n, load, None, None)
            book_work(chain, ledger, v, at(impulses, n, k + 1))


@inlined
def at(values, n, k):
    """Return what acts at stage k of step n; it is zero after the last that acts."""
    return values[n, k] if n < values.shape[0] else 0.0


@inlined
def drift(chain, u, v, start, end):
    """Move every block at its velocity, with the springs of fixed ends."""
    for j in range(u.size):
        u[j] += chain.dt * v[j]
    _close(chain.start, start, -v[0])
    _close(chain.end, end, v[-1])


@inlined
def _close(end, state, outward):
    if end is not None:
        state[0] += end.gain * outward


@inlined
def book_work(chain, ledger, v, impulse):
    """Add the work of the load and of a prestress over a drift, of which the velocity is constant.

    Booked so, it is one more displacement of the composition and has its order.
    """
    if ledger is not None:
        start = impulse + chain.dt * steady_at(chain.steady, 0)
        ledger.sums[1] += start * v[0] - chain.dt * steady_at(chain.steady, 1) * v[-1]


@jitted
def held(chain, state):
    """Return what the springs of fixed ends store (J), and leave their reactions in the ends."""
    return _held(chain.start, state.start) + _held(chain.end, state.end)


@inlined
def _held(end, state):
    if end is None:
        return 0.0
    state[1] = end.stiffness * state[0]
    return 0.5 * state[1] * state[0]


@inlined
def book_ends(ledger, work):
    """Set the work done on the ends since the start, J."""
    if ledger is not None:
        ledger.sums[0] = work
