"""Rock of a constant quality factor in plane strain."""

import numpy as np
import pytest

from jointwave.cases.material.constant_q import fitted
from jointwave.continuum.explicit.march import run as take
from jointwave.continuum.run import run_of
from tests.continuum.test_constant_q import started
from tests.continuum.test_modes import free_mode


def test_plane_rock_rings_and_decays_as_the_root_of_leapfrog_says(rock_mass):
    """One quality factor for all moduli in plane strain, too; mode 8 of a free square."""
    rock = {"density": 2600.0, "intact_modulus": 5e10, "quality_factor": 10.0}
    scene = rock_mass(rock=rock | {"reference_frequency": 400.0})
    run = run_of(scene, "jointed")
    memory, dt = run.model.rock.memory, run.model.dt
    omega, mode = free_mode(run.discrete, 8)
    unrelaxed = run.discrete.materials[0].stiffness[0, 0] / 6e10
    assert unrelaxed == pytest.approx(fitted(10.0, 400.0, 40.0, 4e3).unrelaxed)
    z, expected = started(run.state, memory, omega, mode, dt)
    take(run.model, run.state, run.samples, run.choice.time.stride, 0, 400)
    assert abs(z) < 1 - 5e-5
    assert np.abs(run.state.u - expected(400)).max() < 1e-9 * np.abs(mode).max()
