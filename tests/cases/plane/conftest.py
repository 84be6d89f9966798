"""A rock mass without a warning, with any table changed."""

from copy import deepcopy

import pytest

from cases.read import load_tables

TABLES = {
    "title": "one joint",
    "domain": {"size": [20.0, 30.0]},
    "rock": {"density": 2600.0, "intact_modulus": 5e10},
    "joint_sets": [
        {
            "name": "joint",
            "dip": 30.0,
            "through": [10.0, 15.0],
            "normal_stiffness": 1e10,
            "shear_stiffness": 4e9,
        }
    ],
    "waves": [
        {
            "kind": "P",
            "direction": [0.0, 1.0],
            "shape": "ricker",
            "amplitude": 1e6,
            "period": 0.005,
        }
    ],
    "boundaries": dict.fromkeys(("left", "right", "bottom", "top"), "quiet"),
    "time": {"duration": 0.03},
    "record": {"points": [[10.0, 5.0], [10.0, 25.0]], "joints": [[10.0, 15.0]]},
}


@pytest.fixture
def mass():
    """Return a function of dotted keys, a double underscore for the dot."""

    def scene(**changes):
        return load_tables(
            deepcopy(TABLES), "", {k.replace("__", "."): v for k, v in changes.items()}
        )

    return scene
