"""Tables of rock masses that the field cases change."""

import re
from math import cos, radians, sin

import numpy as np

import jointwave as jw

ENGINES = ("dem", "continuum-jointed")
SIDES = ("left", "right", "bottom", "top")
GRANITE = {"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.25}
P_SPEED, S_SPEED = (6e10 / 2600.0) ** 0.5, (2e10 / 2600.0) ** 0.5  # of granite, m/s
G, WEIGHT = 9.81, 2400.0 * 9.81 * 1.0  # m/s2; Pa, of the slab of `slope`, 1 m thick
JOINT = {"name": "joint", "normal_stiffness": 1.6e10, "shear_stiffness": 9e9}


def mass(width, height, **tables):
    """Return granite of this size (m) between quiet sides, some tables replaced."""
    own = {"title": "a rock mass", "domain": {"size": [width, height]}, "rock": GRANITE}
    return own | {"boundaries": dict.fromkeys(SIDES, "quiet")} | tables


def wave(kind="P", direction=(0.0, 1.0), period=0.005, **keys):
    """Return a Ricker wavelet of 1 MPa."""
    own = {"kind": kind, "direction": list(direction), "shape": "ricker", "amplitude": 1e6}
    return own | {"period": period} | keys


def slope(angle, friction, width=2.0, height=2.0, **tables):
    """Return the tables of a slab on its fixed base; gravity is tilted (degrees), not the slope."""
    steep, bed = radians(angle), {"name": "bed", "dip": 0.0, "through": [1.0, 1.0]}
    bed |= {"normal_stiffness": 2e9, "shear_stiffness": 1e9, "tension": False}
    own = {
        "rock": {"density": 2400.0, "intact_modulus": 5e10},
        "joint_sets": [bed | {"friction_angle": friction}],
        "gravity": {"direction": [sin(steep), -cos(steep)], "acceleration": G},
        "boundaries": {"bottom": "fixed"},
        "time": {"duration": 2e-3},
        "record": {"points": [[1.0, 1.7]], "joints": [[1.0, 1.0]], "interval": 2e-4},
        "numerics": {"dem": {"block": 1.0, "static_tolerance": 1e-11}, "continuum": {"size": 1.0}},
    }
    return mass(width, height, **own | tables)


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
