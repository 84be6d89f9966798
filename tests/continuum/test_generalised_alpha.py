"""The constants of the implicit scheme: what they must be at known radii, and what theory asks."""

import numpy as np
import pytest

from closed_forms import generalised_alpha as theory
from jointwave.continuum.stepping.implicit import scheme


@pytest.mark.parametrize(
    ("rho", "expected"),
    [
        (1.0, (1 / 2, 1 / 2, 1 / 4, 1 / 2)),  # the trapezoidal rule
        (0.5, (0.0, 1 / 3, 4 / 9, 5 / 6)),  # that of Hilber, Hughes & Taylor, alpha = -1/3
        (0.0, (-1.0, 0.0, 1.0, 3 / 2)),
    ],
)
def test_constants_at_known_radii(rho, expected):
    assert scheme(rho) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("rho", [0.0, 0.25, 0.5, 0.9, 1.0])
def test_radius_is_kept_at_infinity_and_never_exceeded(rho):
    """The characteristic polynomial at infinity is (z + rho)^3; round-off of its triple root would
    be its cube root, so it is the polynomial that is compared."""
    found = np.poly(theory.amplification(scheme(rho), 1e7))
    assert found == pytest.approx(np.poly([-rho] * 3), abs=1e-12)
    x = np.logspace(-3, 5, 200)
    assert theory.spectral_radius(scheme(rho), x).max() <= 1 + 1e-8
