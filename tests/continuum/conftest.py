"""Bodies of small scenes that the tests of dolfinx bodies share."""

from typing import Any

import pytest

from jointwave.continuum.scene import body_of
from tests.continuum import bodies

SHORT: dict[str, Any] = {
    "pillar__length": 2.0,
    "load__amplitude": 1e5,
    "time__duration": 4e-3,
    "record": {"stress": [0.2, 1.0, 1.6], "velocity": [0.0, 0.3, 1.0], "interval": 5e-5},
    "numerics__continuum__elements_per_block": 1,
}


@pytest.fixture(scope="session")
def rock_mass():
    return bodies.rock_mass


@pytest.fixture(scope="session")
def made(rock_mass):
    """Return a function that gives the body of a scene, keys as for `rock_mass`."""
    return lambda *joints, **changes: body_of(rock_mass(*joints, **changes))


@pytest.fixture
def column(pillar):
    """Return a function that gives a scene of three blocks of 0.5 m, 0.4 m wide, on a mesh, with
    dotted keys changed."""

    def scene(mesh=None, **changes):
        shape = {"pillar__length": 1.5, "pillar__side": 0.4, "pillar__block": 0.5}
        places = {"soft_layers": [], "record__stress": [0.5], "record__velocity": [0.25]}
        if mesh is not None:
            changes["numerics__continuum__mesh"] = str(mesh)
        return pillar(**(shape | places | changes))

    return scene


@pytest.fixture
def short(pillar):
    """Return a function that gives four blocks of 0.5 m, one element long, keys changed."""

    def scene(numerics=None, **changes):
        own = {f"numerics__continuum__{key}": value for key, value in (numerics or {}).items()}
        given = [key for key in changes if key.startswith("record__")]
        record = SHORT["record"] | changes.pop("record", {})
        record |= {key.removeprefix("record__"): changes.pop(key) for key in given}
        keys = SHORT | {"record": record} | own | changes
        if "numerics__continuum__mesh" in changes:
            del keys["numerics__continuum__elements_per_block"]
        return pillar(**keys)

    return scene
