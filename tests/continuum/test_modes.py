"""One mode of the rock by itself: leapfrog's own frequency and its damping, in closed form.

With a = alpha dt / 2 a mode of frequency omega obeys

    (1 + a) u[n+1] - (2 - (omega dt)^2) u[n] + (1 - a) u[n-1] = 0,

so |u| falls by sqrt((1 - a) / (1 + a)) at every step: alpha / 2 but for (alpha dt)^2.
"""

import numpy as np
import pytest
from scipy.linalg import eigh

from jointwave.continuum.build import operators

#: A load that is nothing, but there: its kernel is compiled for other tests too.
STILL = {"load": {"shape": "step", "amplitude": 1e-30}}


def free_mode(discrete, number: int) -> tuple[float, np.ndarray]:
    """Return the frequency (rad/s) and the shape [freedoms] of a mode, joints included."""
    stiffness, _ = operators(discrete)
    moving = np.flatnonzero(stiffness.diagonal() > 0)
    mass = discrete.body.mass[moving]
    dense = stiffness[moving][:, moving].toarray()
    square, shapes = eigh(dense, np.diag(mass), subset_by_index=[number, number])
    mode = np.zeros(discrete.body.mass.size)
    mode[moving] = shapes[:, 0]
    return float(np.sqrt(square[0])), mode


@pytest.mark.parametrize("alpha", [0.0, 100.0])
@pytest.mark.parametrize(("dim", "number"), [(1, 1), (1, 5), (3, 6), (3, 20)])
def test_mode_rings_at_the_frequency_and_decays_at_the_rate_of_leapfrog(
    dim, number, alpha, short, ready
):
    """The first modes of a free bar or column are rigid: 1 in one dimension, 6 in three.

    400 steps at half the critical one, to 1e-9 of the start in every freedom.
    """
    damping = {"damping__mass_proportional": alpha} if alpha else {}
    run = ready(short(**STILL, **damping), "jointed", dim, samples=401)
    omega, mode = free_mode(run.discrete, number)
    dt, steps = run.time.dt, 400
    a, x = alpha * dt / 2, (omega * dt) ** 2
    root = np.roots([1 + a, x - 2, 1 - a])[0]
    assert abs(root) == pytest.approx(np.sqrt((1 - a) / (1 + a)), rel=1e-12)
    run.state.u[:] = mode
    run.state.v[:] = run.state.v_before[:] = mode * (1 - (1 / root).real) / dt
    run.take(0, steps)
    expected = mode * (root**steps).real
    assert np.abs(run.state.u - expected).max() < 1e-9 * np.abs(mode).max()
    decay = -np.log(abs(root)) / dt
    assert decay == pytest.approx(alpha / 2, rel=1e-3, abs=1e-9)
