"""What an end of rock on a dashpot beta Z sends back, Z the impedance of the rock.

The particle velocity of a reflected wave is (1 - beta)/(1 + beta) of the incident one, its stress
the opposite (Lysmer & Kuhlemeyer, J. Eng. Mech. Div. ASCE 95, 1969): beta = 1 is the quiet end, 0
the free one, infinity the fixed one.
"""

import numpy as np
import pytest

from jointwave.cases.loads import load_history
from jointwave.cases.sampling import clock
from jointwave.continuum.build import build_model, critical_step_of, discretise
from jointwave.continuum.explicit.march import run
from jointwave.continuum.state import empty_samples, state_at_rest


@pytest.mark.parametrize("beta", [0.5, 1.0, 2.0])
def test_reflection(bar, beta):
    """(1 - beta) / (1 + beta) of the incident velocity within 0.001, and as a whole waveform.

    20 quadratic elements and 300 steps a wavelength: after four wavelengths the pulse is off by
    less than 1e-4 of a period.
    """
    scene = bar(time__duration=0.075, record__velocity=[40.0])
    discrete = discretise(scene, "equivalent", 1)
    critical = critical_step_of(scene, discrete, "equivalent")
    time = clock(scene, critical, 0.2, False, "continuum")
    model = build_model(scene, discrete, "equivalent", time)
    quiet = model.ends.quiet
    far = np.where(quiet.freedom == quiet.freedom.max(), beta, 1.0)
    quiet = quiet._replace(viscosity=far * quiet.viscosity, beta=far * quiet.beta)
    model = model._replace(ends=model.ends._replace(quiet=quiet))
    state = state_at_rest(model, keep_ledger=False)
    samples = empty_samples(model, state, time.samples)
    run(model, state, samples, time.stride, 0, time.steps + 1)
    load, z = load_history(scene), 2400.0 * 2000.0
    there, back = (load.value(time.times - y / 2000.0) / (2 * z) for y in (40.0, 80.0))
    reflected = samples.velocity[0] - there
    share = reflected @ back / (back @ back)
    reflection = (1 - beta) / (1 + beta)
    assert share == pytest.approx(reflection, abs=1e-3)
    rest = reflected - reflection * back
    assert np.linalg.norm(rest) < 1e-3 * np.linalg.norm(back)
