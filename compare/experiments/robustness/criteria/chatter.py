"""Repeated impact: a loose block between two walls, ten thousand times.

The walls are the outer blocks on their stiff half-block springs; the joints to the loose one, a
millionth as stiff, bar tension. On one of them the block is a damped oscillator, omega = sqrt(k/m),
whose damping ratio is the joint's own, until the force of spring and dashpot together falls to
zero. That is at omega_d t = pi - 2 asin(zeta), and there the speed is, over that of the approach,

    e = exp(-zeta (pi - 2 asin(zeta)) / sqrt(1 - zeta^2))

(Schwager & Poeschel, Granular Matter 9, 2007, of the same contact).
"""

from __future__ import annotations

from collections.abc import Callable
from math import asin, isfinite, log, pi, sqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from cases.errors import UnstableError
from cases.material.calibrate import calibrate
from cases.sampling import Clock
from cases.schema.scene import Scene
from compare.experiments.robustness.case import STEP, Finding, Trial, criterion

if TYPE_CHECKING:
    from continuum.space.body import Body

IMPACTS = 10_000
SAMPLES = 16  # of the speed, from one impact to the next


class Loose(NamedTuple):
    """The loose block in motion: `advance` takes so many steps, `speed` tells its speed, m/s."""

    advance: Callable[[int], None]
    speed: Callable[[], float]


@criterion("logarithm of the last speed over the first, off that of ten thousand dashpots' impacts")
def restitution(trial: Trial) -> Finding:
    """After n impacts the speed is e^n of the first, and it never grows.

    An impact begins and ends within a step, where the trapezoid of the force is off by k (v dt)^2/8
    at most: a share (omega dt)^2 / 4 of m v^2 / 2, so half of that of the speed, at either end. The
    walls give way by the ratio r of the stiffnesses, which changes a half period by r / 2.
    """
    scene = trial.scene()
    p, (layer, _) = calibrate(scene), scene.soft_layers
    omega = sqrt(p.stiffness[p.soft[0]] * p.area / p.block_mass)
    dt = float(trial.case.changes[STEP]) * trial.critical
    solver = trial.solver
    loose = _blocks(scene, dt) if solver.is_rigid else _rock(scene, dt, solver.model)
    peaks = _peaks(loose, max(1, round(pi / omega / dt / SAMPLES)))
    zeta = layer.damping_ratio or 0.0
    e = -zeta * (pi - 2 * asin(zeta)) / sqrt(1 - zeta**2)
    kinks = (omega * dt) ** 2 / 4
    rise = float((peaks[1:] / np.minimum.accumulate(peaks)[:-1]).max()) - 1
    off = abs(log(peaks[-1] / peaks[0]) - (len(peaks) - 1) * e)
    softer = float(p.stiffness[p.soft[0]] / p.regular_stiffness)
    bound = (len(peaks) - 1) * (kinks + abs(e) * softer) + EDGE
    if rise > 2 * kinks + EDGE:
        return Finding(float("inf"), bound, f"the speed grows by {rise:.3g} at an impact")
    return Finding(
        off, bound, f"after {len(peaks) - 1:,} impacts; e^n = {peaks[-1] / peaks[0]:.4f}"
    )


#: Relative, of the largest of the speeds sampled between impacts.
EDGE = 1 - np.cos(pi / SAMPLES / 2)


def _peaks(loose: Loose, stride: int) -> np.ndarray:
    """Return the largest speed between one impact and the next, m/s, of all impacts."""
    peaks: list[float] = []
    largest, sign = abs(loose.speed()), 1.0
    while len(peaks) <= IMPACTS:
        loose.advance(stride)
        v = loose.speed()
        if not isfinite(v):
            raise UnstableError(
                f"the loose block's speed is no number after {len(peaks):,} impacts"
            )
        if v * sign < 0:
            peaks.append(largest)
            largest, sign = 0.0, -sign
        largest = max(largest, abs(v))
    return np.array(peaks)


def _blocks(scene: Scene, dt: float) -> Loose:
    """Return the middle one of three rigid blocks, at 1 m/s."""
    from dem.axial.leapfrog import march
    from dem.axial.model import build_model
    from dem.axial.state import state_at_rest

    p = calibrate(scene)
    model = build_model(scene, p, Clock(dt, 1, 2))
    state = state_at_rest(model.effects, p.block_count, False)
    state.v[1] = 1.0
    if state.gap_rate is not None:
        state.gap_rate[:] = np.diff(state.v)
    return Loose(lambda steps: march(model, state, 0, steps), lambda: float(state.v[1]))


def _rock(scene: Scene, dt: float, kind: str) -> Loose:
    """Return the middle one of three deformable blocks, at 1 m/s; its speed is that of its mass."""
    from continuum.build import build_model, discretise
    from continuum.explicit.march import run
    from continuum.state import empty_samples, state_at_rest

    discrete = discretise(scene, kind)
    model = build_model(scene, discrete, kind, Clock(dt, 1, 2))
    state = state_at_rest(model, False)
    body, d = discrete.body, scene.pillar.block
    freedom = body.freedom(_middle(body, d), 0)
    state.v[freedom] = 1.0
    state.v_before[:] = state.v
    mass, samples = model.rock.mass[freedom], empty_samples(model, state, 2)

    def advance(steps: int) -> None:
        run(model, state, samples, steps + 2, 1, steps + 1)

    return Loose(advance, lambda: float(mass @ state.v[freedom] / mass.sum()))


def _middle(body: Body, d: float) -> np.ndarray:
    """Return the nodes of the second block of d (m)."""
    heights = body.corners[:, :, 0].mean(axis=1)
    return np.unique(body.cells[(heights > d) & (heights < 2 * d)])
