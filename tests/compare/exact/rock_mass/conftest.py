"""Shared by the tests of exact solutions of rock masses."""

import numpy as np
import pytest

from jointwave.cases.read import load_tables


@pytest.fixture(scope="session")
def joint(one_joint):
    """Return a joint of 1e10 and 4e9 Pa/m through the middle with keys changed."""
    (own,) = one_joint()["joint_sets"]
    return lambda **keys: own | {"dip": 25.0, "through": [20.0, 15.0]} | keys


@pytest.fixture(scope="session")
def wave(one_joint):
    """Return a P wave upwards, a Ricker pulse of 1 MPa and 200 Hz, with keys changed."""
    (own,) = one_joint()["waves"]
    return lambda **keys: own | keys


@pytest.fixture(scope="session")
def rock_mass(one_joint, joint):
    """Return rock of 2500 kg/m3 with speeds of 4898.98 and 2828.43 m/s, 40 m by 30 m, quiet all
    around, of this joint and this wave, with tables changed; None takes a key out."""
    own = one_joint(
        domain={"size": [40.0, 30.0]},
        rock={"density": 2500.0, "intact_modulus": 5e10, "intact_poisson": 0.25},
        joint_sets=[joint()],
        record={"points": [[18.0, 4.0], [22.0, 27.0]], "joints": [[20.0, 15.0]], "interval": 1e-4},
    )

    def scene(**changes):
        tables = own | changes
        for key, value in changes.items():
            if isinstance(own.get(key), dict):
                both = own[key] | value
                tables[key] = {k: v for k, v in both.items() if v is not None}
        return load_tables(tables)

    return scene


@pytest.fixture(scope="session")
def straight(rock_mass, joint, wave):
    """A function of keys of the joint and of the wave, which meets the joint straight on at an
    angle to the axes, and of the prestress."""
    n = [-np.sin(np.radians(25.0)), np.cos(np.radians(25.0))]
    whole = {"direction": n, "through": [16.0, -6.0]}
    return lambda law, one, pressed=None: rock_mass(
        joint_sets=[joint(**law)],
        waves=[wave(**whole | one)],
        **({"prestress": pressed} if pressed else {}),
    )
