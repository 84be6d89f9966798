"""Damping of the blocks themselves: Rayleigh's modal rates, Cundall's brake on a gain."""

import numpy as np
import pytest

from closed_forms.leapfrog import frequencies
from jointwave.cases.material.calibrate import calibrate


def decay_rates(matrix, dt, omega):
    """Return the decay rates (1/s) of the modes of these frequencies (rad/s) in a step's matrix."""
    z = np.linalg.eigvals(matrix)
    turning = z[z.imag > 1e-9]
    angle = np.angle(turning) / dt
    nearest = [np.argmin(np.abs(angle - w)) for w in omega]
    return -np.log(np.abs(turning[nearest])) / dt


@pytest.mark.parametrize("alpha, ratio", [(40.0, None), (None, 0.05), (40.0, 0.05)])
def test_modes_decay_at_the_rayleigh_rate(pillar, step_matrix, alpha, ratio):
    """alpha / 2 + eta omega^2 / 2 for every mode of the free chain, to second order in the step.

    The error is a fraction of (omega dt)^2, as the frequency's own (omega dt)^2 / 24 is.
    """
    rayleigh = {"damping__mass_proportional": alpha, "joints__damping_ratio": ratio}
    scene = pillar(
        pillar__length=6.0,
        record={"stress": [3.0]},
        **{key: value for key, value in rayleigh.items() if value is not None},
    )
    p = calibrate(scene)
    natural = frequencies(p.stiffness[0] * p.area, p.block_mass, p.block_count)[1:7]
    rate = (alpha or 0.0) / 2 + (p.time_constant or 0.0) * natural**2 / 2
    omega = np.sqrt(natural**2 - rate**2)
    errors = [
        np.abs(decay_rates(step_matrix(scene, dt), dt, omega) / rate - 1) for dt in (2e-5, 1e-5)
    ]
    assert (errors[0] < (natural * 2e-5) ** 2).all()
    assert errors[0] == pytest.approx(4 * errors[1], rel=0.02)
