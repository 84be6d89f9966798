"""Round-off against what leapfrog itself is: its closed form, and d'Alembert at c dt = d."""

import numpy as np
import pytest

from closed_forms import leapfrog
from jointwave import dem
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.sampling import Clock
from jointwave.compare.exact.bar import images
from jointwave.dem.axial.build import build_model
from jointwave.dem.axial.leapfrog import march
from jointwave.dem.axial.state import state_at_rest


def blocks_after(scene, clock, load=None):
    """Return the displacement of every block after the clock's steps, and the load's forces."""
    p = calibrate(scene)
    model = build_model(scene, p, clock)
    if load is not None:
        model = model._replace(load=load)
    state = state_at_rest(model.effects, p.block_count, ledger=False)
    march(model, state, 0, clock.steps)
    return state.u, model.load


@pytest.mark.parametrize("fraction", [0.05, 0.5, 0.99])
def test_closed_form_of_leapfrog_after_ten_thousand_steps(pillar, fraction):
    """sin(Omega dt / 2) = omega_n dt / 2: round-off grows with the steps, not with the error."""
    scene = pillar()
    p = calibrate(scene)
    dt = fraction * p.spacing / p.bar_speed
    u, load = blocks_after(scene, Clock(dt, 1, 10_001))
    k = p.regular_stiffness * p.area
    force = np.zeros(10_000)
    force[: len(load)] = load[:10_000]
    steps = np.array([10_000])
    expected = leapfrog.displacements(force, steps, dt, k, p.block_mass, p.block_count)[:, 0]
    assert np.abs(u - expected).max() < 1e-10 * np.abs(expected).max()


def test_bar_is_exact_where_a_wave_crosses_one_block_a_step(pillar):
    """At c dt = d leapfrog is d'Alembert's solution at the block centres, with the mean load."""
    probe = pillar()
    p = calibrate(probe)
    centres = p.spacing * (np.arange(p.block_count) + 0.5)
    changes = {
        "record__velocity": centres.tolist(),
        "record__interval": p.spacing / p.bar_speed,
        "numerics__dem__step_fraction": 1.0,
    }
    scene = pillar(**changes)
    result = dem.simulate(scene)
    exact = images.solve(scene)
    assert result.attrs["dt"] == pytest.approx(p.spacing / p.bar_speed, rel=1e-14)
    u, expected = result.displacement.values, exact.displacement.values
    assert np.abs(u - expected).max() < 1e-12 * np.abs(expected).max()
