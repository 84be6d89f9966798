"""The chain of rigid blocks whose joints bar tension, from event to event.

The equations of `chain`, exact between the openings and closings of its joints and these found as
roots (`events`); it shares no code with the engines' joint laws. What round-off does to the motion
is measured: a second solution is perturbed at every step by NOISE units of round-off, and the error
is taken as SAFETY times what the two differ by. Blocks that rattle do so chaotically, and from the
time on at which the two differ by PARTED of the motion nothing is known (`known_until`).

Holds for any load or shaken base, soft layers, dashpots, mass-proportional damping, ends, gravity
along the axis and prestress, if no joint that bars tension would be pulled at rest.

`contact` is the closed form for one such contact between two half-spaces: closed, it passes the
incident stress; open, the far side stands still, the near side moves at twice the incident
velocity v_I, and the gap grows at -2 v_I until it returns to zero. With the impulse I of the
incident stress this is gap = (2/Z)(max_{s <= t} I(s) - I(t)).
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import xarray as xr

from cases.loads import LoadHistory
from cases.material.calibrate import calibrate
from cases.sampling import sample_times
from cases.schema.scene import Scene
from compare.exact.answer import YES, Answer, Resolves, Rock, no
from compare.exact.blocks.chain import Chain, chain, contact_forces, receivers, split
from compare.exact.blocks.events import integrate
from compare.exact.blocks.lattice import HELD, at_rest
from compare.exact.conditions import bars_tension, beyond
from compare.exact.drive import drive
from results.dataset import dataset

NAME = "no-tension-chain"
RESOLVES = Resolves(Rock.RIGID_BLOCKS)
MOST_BLOCKS = 2000
NOISE = 1024.0
SAFETY = 4.0
PARTED = 1e-6
ROUNDING = 4 * float(np.finfo(float).eps)


def applies(scene: Scene) -> Answer:
    """Return whether a joint of the chain bars tension and the chain is not too long."""
    if reason := beyond(scene, *HELD):
        return no(reason)
    if not bars_tension(calibrate(scene)):
        return no("every joint carries tension: see lattice")
    if scene.pillar.block_count > MOST_BLOCKS:
        return no(f"more than {MOST_BLOCKS:,} blocks: too many events")
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
    rest, driven, period = (
        at_rest(scene, model),
        signal.value(times) * model.gain,
        scene.load.period,
    )
    own, other = (integrate(model, signal, times, rest, period, noise) for noise in (0.0, NOISE))
    found, twin = (receivers(scene, model, rest + m.states, driven) for m in (own, other))
    known = _known(model, own.states, other.states)
    bounds = [_bound(a[:known], b[:known]) for a, b in zip(found, twin, strict=True)]
    until = {} if known == len(times) else {"known_until": float(times[known - 1])}
    return dataset(
        scene,
        NAME,
        times,
        *(field.T for field in found),
        errors=dict(zip(("stress", "velocity", "displacement"), bounds, strict=True)),
        events=own.events,
        **until,
    )


def _known(model: Chain, states: np.ndarray, other: np.ndarray) -> int:
    """Return how many samples there are before two solutions [n, size] have parted."""

    def motion(x: np.ndarray) -> np.ndarray:
        u, v, _ = split(model, x)
        return np.concatenate([model.rate * np.diff(u, axis=1), v], axis=1)

    apart = np.linalg.norm(motion(other - states), axis=1)
    lost = apart > PARTED * np.linalg.norm(motion(states), axis=1).max()
    return max(1, int(np.argmax(lost))) if lost.any() else len(states)


def _bound(field: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the bound of the error of waveforms [n, receivers] whose twin is `other`."""
    apart = np.sqrt(np.mean((other - field) ** 2, axis=0))
    return SAFETY * apart + ROUNDING * np.abs(field).max(axis=0)


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
