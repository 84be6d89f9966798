"""What the tests of rigid blocks share: short rows in space, narrow tiles, equal results."""

from copy import deepcopy
from typing import Any

import numpy as np
import pytest

from jointwave.dem.contacts import chunks
from jointwave.dem.kernel import parts

SHORT: dict[str, Any] = {
    "pillar__length": 8.0,
    "rock__intact_modulus": None,  # at a wall the half spring of a joint, whose numbers are at hand
    "load__amplitude": 1e5,
    "load__direction": [0.48, 0.6, -0.64],
    "load__at": [0.1, -0.05],
    "time__duration": 0.03,
    "record": {"stress": [0.0, 2.0, 5.0, 8.0], "velocity": [3.0, 6.0], "interval": 1e-4},
}


@pytest.fixture
def row(pillar):
    """Return a function that gives 16 blocks under an oblique eccentric blow, keys changed."""
    return lambda **changes: pillar(**{**deepcopy(SHORT), **changes})


@pytest.fixture
def narrow(monkeypatch):
    """Divide blocks into as many tiles as they allow, so that threads share a few of them."""
    monkeypatch.setattr(chunks, "LEAST", 1)
    monkeypatch.setattr(parts, "THIN", 2)
    monkeypatch.setattr(parts, "FEWEST", 2)


@pytest.fixture
def assert_alike():
    """Return a function that compares results of different numbers of threads: every bit of what
    moves and is carried, and the ledger, whose sums have another order."""

    def compare(found, expected):
        energy = expected.energy.values if "energy" in expected else np.zeros(1)
        if energy.any():
            assert np.abs(found.energy.values - energy).max() < 1e-13 * np.abs(energy).max()
        one, other = (x.drop_vars("energy", errors="ignore") for x in (found, expected))
        assert one.equals(other)

    return compare
