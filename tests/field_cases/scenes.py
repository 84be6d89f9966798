"""Tables of rock masses that the field cases change."""

import re

import numpy as np

import jointwave as jw

ENGINES = ("dem", "continuum-jointed")
SIDES = ("left", "right", "bottom", "top")
GRANITE = {"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.25}
P_SPEED, S_SPEED = (6e10 / 2600.0) ** 0.5, (2e10 / 2600.0) ** 0.5  # of granite, m/s
JOINT = {"name": "joint", "normal_stiffness": 1.6e10, "shear_stiffness": 9e9}


def mass(width, height, **tables):
    """Return granite of this size (m) between quiet sides, some tables replaced."""
    own = {
        "title": "a rock mass",
        "domain": {"size": [width, height]},
        "rock": GRANITE,
        "boundaries": dict.fromkeys(SIDES, "quiet"),
    }
    return own | tables


def wave(kind="P", direction=(0.0, 1.0), period=0.005, **keys):
    """Return a Ricker wavelet of 1 MPa."""
    own = {"kind": kind, "direction": list(direction), "shape": "ricker", "amplitude": 1e6}
    return own | {"period": period} | keys


def stands(scene, engine="dem"):
    """Return whether a scene has a static state, at which nothing moves; what falls says so."""
    try:
        found = jw.simulate(scene, engine)
    except jw.SceneError as error:
        words = r"no static state.* moves .*it slides, tips or is unsupported"
        assert re.search(words, str(error)), error
        return False
    assert np.abs(found.velocity).max() < 1e-6  # m/s
    return True
