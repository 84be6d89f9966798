"""The critical step against the roots of the characteristic polynomial of one mode."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwave.numerics.critical_step import critical_step


def growth(omega, eta, dt):
    """Return the largest root of z (z-1)^2 + h^2 z^2 + b (3z - 1)(z - 1) / 2, h = omega dt."""
    h2, b = (omega * dt) ** 2, eta * omega**2 * dt
    return np.abs(np.roots([1, h2 + 1.5 * b - 2, 1 - 2 * b, 0.5 * b])).max()


@given(st.floats(1, 1e5), st.floats(0, 100))
def test_one_mode_is_stable_exactly_below_it(omega, ratio):
    """Inside the unit circle just below, outside just above, for damping ratios 0 to 100."""
    eta = 2 * ratio / omega
    dt = critical_step(lambda a, b: (a + b * eta) * omega**2, eta > 0)
    formula = np.sqrt(4 * eta**2 + 4 / omega**2) - 2 * eta
    # The formula itself cancels: its relative round-off grows with the square of the ratio.
    assert dt == pytest.approx(formula, rel=1e-9 * (1 + ratio**2))
    assert growth(omega, eta, 0.999 * dt) <= 1 + 1e-9
    assert growth(omega, eta, 1.001 * dt) > 1
