"""Scenes for the exact solutions: the paper's pillar with tables changed, and the misfit."""

import numpy as np
import pytest

from jointwave.cases import Scene

PILLAR = {
    "title": "the paper's pillar",
    "pillar": {"length": 50.0, "side": 0.5, "block": 0.5},
    "rock": {"density": 2400.0, "p_speed": 2200.0, "s_speed": 800.0, "intact_modulus": 8.64e10},
    "load": {"shape": "sine", "amplitude": 1.0e6, "period": 0.01},
    "time": {"duration": 0.12},
    "record": {"stress": [20.0], "velocity": [0.0, 20.0, 33.3]},
}


@pytest.fixture
def scene():
    """Return the paper's pillar; a keyword's table is merged into the scene's, a list replaces."""

    def make(**tables):
        merged = {
            key: value if isinstance(value, list) else {**PILLAR.get(key, {}), **value}
            for key, value in tables.items()
        }
        return Scene.model_validate({**PILLAR, **merged})

    return make


@pytest.fixture
def misfit():
    """Return the relative L2 misfit ||a - b|| / ||b|| of two results' variable, or of arrays."""

    def relative(a, b, variable="stress"):
        a, b = (np.asarray(x[variable] if hasattr(x, "data_vars") else x) for x in (a, b))
        assert a.shape == b.shape
        return float(np.linalg.norm(a - b) / np.linalg.norm(b))

    return relative
