"""What the tests of bad input share: targets that read it, under a bound on memory.

`make fuzz` sets FUZZ: so many times the inputs, others in each run.
"""

import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings

import targets
from jointwave import cases
from meshes import meshes

#: How many times the inputs of a plain run.
FUZZ = int(os.environ.get("FUZZ", "1"))


@pytest.fixture(scope="session")
def gmsh_files():
    """Return gmsh files of a pillar of three blocks, of every version and form."""
    return meshes()


@pytest.fixture(scope="module")
def meet(tmp_path_factory):
    """Return a function of (target, bytes) that tells whether they were read or refused."""
    folder = tmp_path_factory.mktemp("fuzz")
    for load in Path(cases.__file__).parent.glob("*/*.csv"):
        (folder / load.name).write_bytes(load.read_bytes())
    before = os.environ.get("JOINTWAVE_MEMORY")
    os.environ["JOINTWAVE_MEMORY"] = targets.MEMORY
    yield lambda name, data: targets.met(name, data, folder)
    del os.environ["JOINTWAVE_MEMORY"]
    if before is not None:
        os.environ["JOINTWAVE_MEMORY"] = before


@pytest.fixture
def meets(meet):
    """Return a function that lets a target meet so many inputs and asserts that some were read and
    some refused."""

    def found(target, inputs, count):
        outcomes = set()

        @settings(
            max_examples=FUZZ * count,
            derandomize=FUZZ == 1,
            suppress_health_check=list(HealthCheck),
        )
        @given(inputs)
        def check(data):
            outcomes.add(meet(target, data))

        check()
        assert outcomes == {"read", "refused"}

    return found
