"""Place and time at which a pulse first breaks a bar with a free end, jointed rock and the chain.

At the distance x from the free end a pulse f, which entered the start at t = 0, and its reflection
add up to the tension (Kolsky, Stress Waves in Solids, 1953)

    g(x, t) = f(t - (L + x)/c) - f(t - (L - x)/c)

The first failure is the least t with g >= sigma_t anywhere. A saw tooth of length lam breaks at
x = lam sigma_t / (2 p0). Holds until the reflection is back at the start."""

from typing import NamedTuple

import numpy as np

from jointwave.cases.histories import LoadHistory
from jointwave.cases.loads import late_load
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.properties import Properties
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar.bars import bar_of
from jointwave.compare.exact.bar.laplace import bounded
from jointwave.compare.exact.blocks.pillar import system_of
from jointwave.compare.exact.blocks.row_of_blocks import contact_forces
from jointwave.compare.exact.linear import twins

POINTS = 1001  # of a grid of places or times
REFINEMENTS = 3  # of the grid, each by POINTS / 10 about the first failure


class Spall(NamedTuple):
    """Where and when tension first reaches the strength.

    distance : from the free end, m. time : since the pulse entered at the start, s."""

    distance: float
    time: float


def spall(
    load: LoadHistory, strength: float, length: float, speed: float, duration: float
) -> Spall | None:
    """Return the first failure in tension of a homogenised bar, None where there is none.

    load : the end stress up to `duration` (s), Pa, compression positive. strength : tensile, Pa.
    length, speed : of the bar, m and m/s."""
    x, t = np.linspace(0.0, length, POINTS), np.linspace(0.0, duration, POINTS)
    found = None
    for _ in range(1 + REFINEMENTS):
        there, back = (t - ((length + sign * x) / speed)[:, None] for sign in (1, -1))
        excess = load.value(there) - load.value(back) - strength
        breaks = np.flatnonzero((excess >= 0).any(axis=1))
        if not breaks.size:
            break
        k = np.argmax(excess[breaks] >= 0, axis=1)
        late, before = excess[breaks, k], np.minimum(excess[breaks, np.maximum(k - 1, 0)], 0.0)
        times = t[k] - (t[1] - t[0]) * late / np.maximum(late - before, 1e-300)
        best = int(np.argmin(times))
        found = Spall(float(x[breaks[best]]), float(times[best]))
        x, t = (
            np.linspace(max(at - 5 * (one[1] - one[0]), 0.0), at + 5 * (one[1] - one[0]), POINTS)
            for at, one in zip(found, (x, t), strict=True)
        )
        x = np.minimum(x, length)
    return found


def jointed_spall(scene: Scene) -> Spall | None:
    """Return the first failure of the scene's deformable rock at one of its joints, to a sample. It
    is linear until then, so the exact stress at all joints holds."""
    p, times = calibrate(scene), sample_times(scene)
    bar, joints = bar_of(scene, resolved=True), p.joint_y.tolist()
    load, period = late_load(scene, "jointed"), scene.load.time_scale
    (stress, _, _), _ = bounded(bar, load, times, joints, [], period)
    return _first(scene, p, -stress.T)


def lattice_spall(scene: Scene) -> Spall | None:
    """Return the same of the scene's rigid-block chain; gravity, if any, is static."""
    p, model = calibrate(scene), system_of(scene)
    states = twins(model.matrix, model.load, late_load(scene), sample_times(scene))[0]
    return _first(scene, p, -contact_forces(model, states)[:, 1 : scene.block_count] / p.area)


def _first(scene: Scene, p: Properties, tension: np.ndarray) -> Spall | None:
    """Return the first sample at which the tension [n, joints] (Pa) of a joint is its strength."""
    share = tension / p.tensile_strength
    breaks = np.flatnonzero((share >= 1).any(axis=1))
    if not breaks.size:
        return None
    y = p.joint_y[np.argmax(share[breaks[0]])]
    return Spall(float(scene.pillar.length - y), float(sample_times(scene)[breaks[0]]))
