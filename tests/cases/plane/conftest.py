"""A rock mass without a warning, with any table changed."""

import pytest

from jointwave.cases.read import load_tables


@pytest.fixture
def mass(one_joint):
    """Return a function of dotted keys, a double underscore for the dot."""

    def scene(**changes):
        overrides = {k.replace("__", "."): v for k, v in changes.items()}
        return load_tables(one_joint(), "", overrides)

    return scene
