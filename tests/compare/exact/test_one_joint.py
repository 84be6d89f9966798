"""One joint between half-spaces: coefficients, and waveforms against the Laplace bar."""

import numpy as np
import pytest

from closed_forms.one_joint import coefficients
from jointwave.compare.exact.bar.bars import EQUIVALENT
from jointwave.compare.exact.joint import one_joint

LAYER = {"y": 20.0, "spacing_stiffness": 4.375e8}
RECORD = {"stress": [5.0, 20.0, 41.3], "velocity": [0.0, 19.75, 20.0, 33.3]}


@pytest.mark.parametrize(
    "kappa, expected", [(0.25, 0.4472), (0.5, 0.7071), (1, 0.8944), (2, 0.9701), (5, 0.9950)]
)
def test_transmission_by_kappa(kappa, expected):
    """Schoenberg (1980) at five kappa, to the digits given; |T|^2 + |R|^2 = 1 without a dashpot."""
    transmitted, reflected = coefficients(100.0, kappa * 3e6 * 100.0, 3e6)
    assert abs(transmitted) == pytest.approx(expected, abs=5e-5)
    assert abs(transmitted) == pytest.approx(2 * kappa / np.sqrt(4 * kappa**2 + 1), rel=1e-12)
    assert abs(reflected) == pytest.approx(1 / np.sqrt(4 * kappa**2 + 1), rel=1e-12)


def test_a_dashpot_passes_high_frequencies_and_takes_energy():
    omega = np.array([10.0, 1e3, 1e8])
    transmitted, reflected = coefficients(omega, 3e8, 3e6, viscosity=2e6)
    assert (abs(transmitted) ** 2 + abs(reflected) ** 2 < 1).all()
    assert abs(transmitted[-1]) == pytest.approx(1 / (1 + 3e6 / (2 * 2e6)), rel=1e-6)


@pytest.mark.parametrize("zeta", [None, 0.02, 0.5])
@pytest.mark.parametrize(
    "start, end, duration", [("quiet", "matched", 0.12), ("free", "quiet", 0.029)]
)
def test_the_laplace_bar_agrees(scene, misfit, zeta, start, end, duration):
    """0.009 % by the rules of `laplace`. Velocity on the layer is the mean of both sides."""
    layer = LAYER if zeta is None else {**LAYER, "damping_ratio": zeta}
    at = scene(
        soft_layers=[layer],
        ends={"start": start, "end": end},
        time={"duration": duration},
        record=RECORD,
    )
    assert one_joint.applies(at)
    a, b = one_joint.solve(at), EQUIVALENT.run(at)
    for variable in ("stress", "velocity", "displacement"):
        assert misfit(a, b, variable) < 9e-5
