"""The compiled kernels are kept on disk, and never outlive the sources they came from."""

import shutil
from pathlib import Path

import numba
import pytest

import joints
from joints.jit import PACKAGES, cache_directory, jitted

ROOT = Path(joints.__file__).resolve().parent.parent


@pytest.mark.parametrize("edited", ["joints/laws.py", "dem/step.py", "continuum/explicit.py"])
def test_cache_follows_every_source(edited, tmp_path):
    """One character in any kernel's file, a callee's included, is another cache."""
    for package in PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package)
    assert cache_directory(tmp_path) == cache_directory(ROOT)
    with (tmp_path / edited).open("a") as file:
        file.write("#")
    assert cache_directory(tmp_path) != cache_directory(ROOT)


def test_kernels_are_cached_there_with_ieee_arithmetic():
    """Every kernel is made by one decorator: cached, and bit-identical however it is called."""
    assert str(cache_directory(ROOT)) == numba.config.CACHE_DIR
    kernel = jitted(lambda x: x + 1.0)
    assert not kernel.targetoptions.get("fastmath")
