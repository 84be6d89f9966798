"""A thin soft layer, meshed as rock, and the massless joint that stands for it.

The layer has the rock's density and a hundredth of its modulus: Z_2/Z_1 = c_2/c_1 = 0.1, and
k_2 h = 0.3 at the peak frequency of the pulse. That the two differ, by 1.7 %, is the layer's mass.
"""

import numpy as np
import pytest

from closed_forms import one_joint, thin_layer
from jointwave import continuum
from jointwave.cases.loads import load_history

RATIO, PHASE = 0.1, 0.3
MODULUS, SPEED, PERIOD = 9.6e9, 2000.0, 0.01
THICKNESS = PHASE * RATIO * SPEED * PERIOD / (2 * np.pi)


def transmission(scene, amplitude):
    """Return |T| at 20 m."""
    result = continuum.simulate(scene, "equivalent", dim=1)
    times = result.time.values
    incident = load_history(scene).value(times - 10.0 / SPEED) / 2
    return amplitude(times, result.stress.values[1]) / amplitude(times, incident)


def test_the_meshed_layer_has_its_mass(bar, amplitude):
    """|T| = 0.5643 within 0.1 %: one quadratic element of k h = 0.3, (k h)^4 / 1440 = 6e-6."""
    layer = {"y": 20.0, "normal_stiffness": RATIO**2 * MODULUS / THICKNESS, "thickness": THICKNESS}
    exact = thin_layer.transmission(RATIO, PHASE)
    T = transmission(bar(soft_layers=[layer]), amplitude)
    assert exact == pytest.approx(0.5643, abs=5e-5)
    assert pytest.approx(exact, rel=1e-3) == T


def test_the_interface_has_none(bar, soft_joint, amplitude):
    """|T| = 0.5547 within 0.1 %: the joint of kappa = 1/3."""
    kappa = thin_layer.joint(RATIO, PHASE)
    exact = abs(one_joint.coefficients(1.0, kappa, 1.0)[0])
    T = transmission(bar(soft_layers=[soft_joint(20.0, kappa)]), amplitude)
    assert exact == pytest.approx(0.5547, abs=5e-5)
    assert pytest.approx(exact, rel=1e-3) == T
