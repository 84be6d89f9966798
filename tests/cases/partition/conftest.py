"""Domains and joint sets for tests, in few words."""

import pytest

from jointwave.cases.schema.domain import Domain
from jointwave.cases.schema.joint import JointSet


@pytest.fixture(scope="session")
def joints():
    """A function of a name, a dip and other keys: a joint set."""
    return lambda name, dip, **keys: JointSet(
        name=name, dip=dip, normal_stiffness=1e10, shear_stiffness=4e9, **keys
    )


@pytest.fixture(scope="session")
def rectangle():
    """A function of a width, a height and other keys: a domain."""
    return lambda x, y, **keys: Domain(size=[x, y], **keys)
