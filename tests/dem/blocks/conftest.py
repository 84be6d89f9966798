"""What the tests of blocks in the plane share: scenes in few words."""

import pytest

from jointwave.cases import load_tables

JOINT = {"name": "joint", "dip": 30.0, "through": [6.0, 5.0]}
JOINT |= {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
TABLES = {
    "title": "blocks",
    "domain": {"size": [12.0, 10.0]},
    "rock": {"density": 2600.0, "intact_modulus": 5e10},
    "joint_sets": [JOINT],
    "boundaries": dict.fromkeys(("left", "right", "bottom", "top"), "quiet"),
    "numerics": {"dem": {"block": 1.0}},
    "time": {"duration": 0.01},
    "record": {"points": [[4.3, 2.1], [8.2, 7.7]], "joints": [[6.1, 5.0]], "interval": 1e-4},
}
WAVE = {"kind": "P", "direction": [0.0, 1.0], "shape": "ricker", "amplitude": 1e6, "period": 0.004}


@pytest.fixture(scope="session")
def joint():
    """Return a joint of 1e10 and 4e9 Pa/m at 30 degrees with keys changed."""
    return lambda **keys: {k: v for k, v in (JOINT | keys).items() if v is not None}


@pytest.fixture(scope="session")
def wave():
    """Return a P wave upwards, a Ricker pulse of 1 MPa and 250 Hz, with keys changed."""
    return lambda **keys: WAVE | keys


@pytest.fixture(scope="session")
def rock_mass():
    """Return one joint in blocks of 1 m, 12 m by 10 m, quiet all around, with tables changed: keys
    of tables are added, None takes one out."""

    def scene(**changes):
        tables = dict(TABLES)
        for key, value in changes.items():
            both = value
            if isinstance(TABLES.get(key), dict) and isinstance(value, dict):
                both = {k: v for k, v in (TABLES[key] | value).items() if v is not None}
            tables[key] = both
        given = {key: value for key, value in tables.items() if value is not None}
        return load_tables(given)

    return scene
