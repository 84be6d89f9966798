"""A bar under a Ricker pulse, which tests of exact solutions share."""

from typing import Any

import numpy as np
import pytest

PERIOD = 0.01  # s, of the Ricker wavelet's peak frequency
DENSITY, MODULUS, SPEED = 2400.0, 9.6e9, 2000.0
BAR: dict[str, Any] = {
    "pillar": {"length": 60.0, "side": 0.5, "block": 1.0},
    "rock": {"density": DENSITY, "equivalent_modulus": MODULUS, "equivalent_poisson": 0.25},
    "load": {"shape": "ricker", "amplitude": 1e6, "period": PERIOD},
    "ends": {"start": "quiet", "end": "quiet"},
    "time": {"duration": 0.1},
    "record": {"stress": [10.0, 30.0], "velocity": [], "interval": 1e-4},
    "numerics__continuum__elements_per_block": 1,
}


@pytest.fixture
def bar(pillar):
    """Return a function that gives 60 m of rock of 2000 m/s between quiet ends, keys changed.

    Waves of the peak frequency are 20 blocks of 1 m long, one quadratic element each.
    """
    return lambda **changes: pillar(**{**BAR, **changes})


@pytest.fixture
def soft_joint():
    """Return a function that gives the soft layer at y (m) whose joint has kappa = K/(Z omega) at
    the peak frequency; the homogenised bar holds the compliance of an ordinary joint already."""

    def layer(y: float, kappa: float, impedance: float = DENSITY * SPEED) -> dict[str, float]:
        excess = 1 / (kappa * impedance * 2 * np.pi / PERIOD)
        return {"y": y, "normal_stiffness": 1 / (excess + 1.0 / MODULUS)}

    return layer


@pytest.fixture
def amplitude():
    """Return a function of equally spaced times (s) and a wave, silent at both ends, that gives the
    magnitude of its Fourier integral at the peak frequency."""

    def magnitude(times: np.ndarray, wave: np.ndarray) -> float:
        return float(abs(wave @ np.exp(-2j * np.pi / PERIOD * times)) * (times[1] - times[0]))

    return magnitude
