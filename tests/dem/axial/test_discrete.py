"""Round-off against what leapfrog itself is: its closed form, and d'Alembert at c dt = d."""

import numpy as np
import pytest

from closed_forms import leapfrog
from jointwave import dem
from jointwave.cases.loads import load_history, step_means
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.bar import images


def at_centres(p):
    """Return the centres of all blocks, m."""
    return (p.spacing * (np.arange(p.block_count) + 0.5)).tolist()


@pytest.mark.parametrize("fraction", [0.05, 0.5, 0.99])
def test_closed_form_of_leapfrog_after_ten_thousand_steps(pillar, fraction):
    """sin(Omega dt / 2) = omega_n dt / 2: round-off grows with the steps, not with the error."""
    p = calibrate(pillar())
    dt, steps = fraction * p.spacing / p.bar_speed, 10_000
    result = dem.simulate(
        pillar(
            record={"velocity": at_centres(p), "interval": 1000 * dt},
            time__duration=steps * dt,
            numerics__dem__step_fraction=fraction,
        )
    )
    assert result.attrs["steps"] == steps
    dt, k = result.attrs["dt"], p.regular_stiffness * p.area
    force = p.area * step_means(load_history(pillar()), dt, steps)
    expected = leapfrog.displacements(force, np.array([steps]), dt, k, p.block_mass, p.block_count)[
        :, 0
    ]
    off = np.abs(result.displacement.values[:, -1, 0] - expected)
    assert off.max() < 1e-10 * np.abs(expected).max()


def test_bar_is_exact_where_a_wave_crosses_one_block_a_step(pillar):
    """At c dt = d leapfrog is d'Alembert's solution at the block centres, with the mean load."""
    probe = pillar()
    p = calibrate(probe)
    changes = {
        "record__velocity": at_centres(p),
        "record__interval": p.spacing / p.bar_speed,
        "numerics__dem__step_fraction": 1.0,
    }
    scene = pillar(**changes)
    result = dem.simulate(scene)
    exact = images.solve(scene)
    assert result.attrs["dt"] == pytest.approx(p.spacing / p.bar_speed, rel=1e-14)
    u, expected = result.displacement.values, exact.displacement.values
    assert np.abs(u - expected).max() < 1e-12 * np.abs(expected).max()
