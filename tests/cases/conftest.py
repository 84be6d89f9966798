"""Scenes of rock masses for tests, in few words."""

from pathlib import Path

import pytest

from jointwave.cases.read import load_tables
from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint import JointSet
from jointwave.cases.validate import validated

LAW = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}


@pytest.fixture
def mass(one_joint):
    """A function of dotted keys, a double underscore for the dot: rock with one joint, and no
    warning."""

    def scene(**changes):
        overrides = {k.replace("__", "."): v for k, v in changes.items()}
        return load_tables(one_joint(), "", overrides)

    return scene


@pytest.fixture(scope="session")
def rock_with():
    """A function of joint sets and other tables: 12 m by 10 m of rock with lambda = mu = 20 GPa."""

    def scene(*sets, poisson=0.25, folder=Path(), **tables):
        own = {
            "title": "rock",
            "domain": {"size": [12.0, 10.0]},
            "rock": {"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": poisson},
            "joint_sets": [{"name": str(k), **LAW, **one} for k, one in enumerate(sets)],
            "time": {"duration": 0.01},
        }
        own |= tables
        size = own["domain"].get("size", [0.0, 0.0])
        own.setdefault("record", {"points": [[0.1, 0.2, 0.3][: len(size)]]})
        return validated(own, folder / "scene.toml", frozenset())

    return scene


@pytest.fixture(scope="session")
def joints():
    """A function of a name, a dip and other keys: a joint set."""
    return lambda name, dip, **keys: JointSet(name=name, dip=dip, **LAW | keys)


@pytest.fixture(scope="session")
def rectangle():
    """A function of a width, a height and other keys: a domain."""
    return lambda x, y, **keys: Domain(size=[x, y], **keys)
