"""What the tests of bad input share: the targets of tools/fuzz, under a bound on memory."""

import importlib.util
import os
from pathlib import Path

import pytest

import cases

TARGETS = Path(__file__).parents[2] / "tools" / "fuzz" / "targets.py"


@pytest.fixture(scope="session")
def targets():
    """Return the module of the targets."""
    spec = importlib.util.spec_from_file_location("fuzz_targets", TARGETS)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


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
