"""What an end of rock on a dashpot beta Z sends back, Z the impedance of the rock.

The particle velocity of a reflected wave is (1 - beta)/(1 + beta) of the incident one, its stress
the opposite (Lysmer & Kuhlemeyer, J. Eng. Mech. Div. ASCE 95, 1969): beta = 1 is the quiet end, 0
the free one, infinity the fixed one.
"""

import numpy as np
import pytest

from jointwave.cases.loads import load_history
from jointwave.continuum.plan import plan_of
from jointwave.continuum.problem import in_time
from jointwave.continuum.stepping.leapfrog import Leapfrog


@pytest.mark.parametrize("beta", [0.5, 1.0, 2.0])
def test_reflection(bar, beta):
    """(1 - beta) / (1 + beta) of the incident velocity within 0.001, and as a whole waveform.

    20 quadratic elements and 300 steps a wavelength: after four wavelengths the pulse is off by
    less than 1e-4 of a period.
    """
    scene = bar(
        time__duration=0.075,
        record__velocity=[40.0],
        numerics__continuum__scheme="explicit",
        numerics__continuum__step_fraction=0.2,
    )
    found, problem, choice, _ = plan_of(scene, "equivalent", dim=1)
    far = np.where(problem.quiet.node == found.body.x[:, 0].argmax(), beta, 1.0)
    quiet = problem.quiet._replace(viscosity=far[:, None, None] * problem.quiet.viscosity)
    own = in_time(scene, problem._replace(quiet=quiet), choice.time, None)
    steps = Leapfrog(own, choice.time.dt, choice.time.samples)
    steps.take(0, choice.time.steps + 1, choice.time.stride)
    load, z, times = load_history(scene), 2400.0 * 2000.0, choice.time.times
    there, back = (load.value(times - y / 2000.0) / (2 * z) for y in (40.0, 80.0))
    reflected = steps.samples.velocity[0] - there
    share = reflected @ back / (back @ back)
    reflection = (1 - beta) / (1 + beta)
    assert share == pytest.approx(reflection, abs=1e-3)
    rest = reflected - reflection * back
    assert np.linalg.norm(rest) < 1e-3 * np.linalg.norm(back)
