"""What the tests of bad input share: targets that read it, under a bound on memory.

`make fuzz` sets FUZZ: so many times the inputs, others in each run."""

import os
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings

import targets
from jointwave import cases

#: How many times the inputs of a plain run.
FUZZ = int(os.environ.get("FUZZ", "1"))
EVERY = list(HealthCheck)


@pytest.fixture(scope="session")
def gmsh_files(tmp_path_factory):
    """Return files of a pillar of three blocks of 0.4 x 0.5 m with its rock and joints as groups,
    in the plane and in space, of gmsh's versions 2.2 and 4.1, as text and binary."""
    from tests.continuum.drawing import drawn

    path = tmp_path_factory.mktemp("gmsh") / "pillar.msh"
    return [
        drawn(path, kind, elements=1, ends=False, version=version, binary=binary).read_bytes()
        for kind in ("triangle", "tetrahedron")
        for version in (2.2, 4.1)
        for binary in (0, 1)
    ]


@pytest.fixture
def meets(tmp_path, monkeypatch):
    """Return a function that lets a target meet so many inputs and asserts that some were read and
    some refused."""
    for load in Path(cases.__file__).parent.glob("*/*.csv"):
        (tmp_path / load.name).write_bytes(load.read_bytes())
    monkeypatch.setenv("JOINTWAVE_MEMORY", targets.MEMORY)

    def found(target, inputs, count):
        outcomes = set()

        @settings(max_examples=FUZZ * count, derandomize=FUZZ == 1, suppress_health_check=EVERY)
        @given(inputs)
        def check(data):
            outcomes.add(targets.met(target, data, tmp_path))

        check()
        assert outcomes == {"read", "refused"}

    return found
