"""Scenes for tests: the paper's pillar with any key changed."""

from pathlib import Path

import pytest
from hypothesis import settings

import cases

# The first example compiles a kernel, which no deadline foresees.
settings.register_profile("jointwave", deadline=None)
settings.load_profile("jointwave")

PILLAR = Path(cases.__file__).parent / "guo-li-2002" / "fig-03.toml"


@pytest.fixture
def pillar():
    """Return a function that gives the paper's free pillar with dotted keys changed."""

    def scene(**changes):
        overrides = {key.replace("__", "."): value for key, value in changes.items()}
        return cases.load_variant(PILLAR, "", overrides)

    return scene
