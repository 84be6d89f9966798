"""What the tests of bad input share: the targets of tools/fuzz, under a bound on memory."""

import importlib.util
import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings

import cases

TOOLS = Path(__file__).parents[2] / "tools" / "fuzz"


def module(name):
    """Return a module of tools/fuzz."""
    spec = importlib.util.spec_from_file_location(f"fuzz_{name}", TOOLS / f"{name}.py")
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


@pytest.fixture(scope="session")
def targets():
    """Return the module of the targets."""
    return module("targets")


@pytest.fixture(scope="session")
def meshes():
    """Return gmsh files of a pillar of three blocks, of every version and form."""
    return module("seeds").meshes()


@pytest.fixture(scope="module")
def meet(targets, tmp_path_factory):
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

        @settings(max_examples=count, suppress_health_check=list(HealthCheck))
        @given(inputs)
        def check(data):
            outcomes.add(meet(target, data))

        check()
        assert outcomes == {"read", "refused"}

    return found
