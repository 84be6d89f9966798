"""The compiled kernels are kept on disk, and never outlive the sources they came from."""

import fcntl
import os
import pickle
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

import numba
import pytest

import dem
import joints
from numerics import jit
from numerics.cache import PACKAGES, UNUSED, cache_directory, make, mark_used
from numerics.jit import jitted

ROOT = Path(joints.__file__).resolve().parent.parent


@pytest.mark.parametrize(
    "edited", ["joints/law.py", "dem/spatial/leapfrog.py", "continuum/explicit/march.py"]
)
def test_cache_follows_every_source(edited, tmp_path):
    """One character in any kernel's file, a callee's included, is another cache."""
    for package in PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package)
    assert cache_directory(tmp_path) == cache_directory(ROOT)
    with (tmp_path / edited).open("a") as file:
        file.write("#")
    assert cache_directory(tmp_path) != cache_directory(ROOT)


def test_states_that_no_program_has_used_for_long_are_dropped(tmp_path):
    """When a new one is made: the past is dropped, what is in use and what is not ours stays."""
    past, used, other = (tmp_path / name for name in ("0" * 16, "1" * 16, "mine"))
    for folder in (past, used, other):
        (folder / "joints").mkdir(parents=True)
        (folder / "joints" / "a.nbi").touch()
        os.utime(folder, (0, time.time() - 1.01 * UNUSED))
    mark_used(used)
    make(used)
    assert past.exists()
    make(tmp_path / ("2" * 16))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["1" * 16, "2" * 16, "mine"]
    assert (other / "joints" / "a.nbi").exists() and (used / "joints" / "a.nbi").exists()


def test_a_cache_that_is_not_there_is_not_made_by_its_use(tmp_path):
    mark_used(tmp_path / ("3" * 16))
    assert not list(tmp_path.iterdir())


def test_kernels_are_cached_there_with_ieee_arithmetic():
    """Every kernel is made by one decorator: cached, and bit-identical however it is called."""
    assert cache_directory(ROOT) == jit.DIRECTORY
    kernel = jitted(lambda x: x + 1.0)
    assert str(jit.DIRECTORY) == numba.config.CACHE_DIR
    assert not kernel.targetoptions.get("fastmath")


def test_one_process_at_a_time_enters_the_cache(tmp_path, monkeypatch):
    """While another holds the cache a kernel compiles but does not save; then it does."""
    monkeypatch.setattr(jit, "DIRECTORY", tmp_path)
    kernel = jitted(lambda x: x + 1.0)
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")  # as numba does when it is set anew
    worker = threading.Thread(target=kernel, args=(1.0,))
    with (tmp_path / "lock").open("w") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        worker.start()
        while worker.is_alive() and not kernel.signatures:
            time.sleep(0.01)
        worker.join(timeout=0.2)
        assert worker.is_alive()
        assert not list(tmp_path.rglob("*.nb?"))
    worker.join()
    assert {path.suffix for path in tmp_path.rglob("*.nb?")} == {".nbi", ".nbc"}


def test_one_process_at_a_time_compiles_a_kernel(tmp_path, monkeypatch):
    """While another compiles it a kernel waits; then it loads what the other has saved."""
    monkeypatch.setattr(jit, "DIRECTORY", tmp_path / "cache")

    def increased(x):
        return x + 1.0

    assert jitted(increased)(1.0) == 2.0
    (lock,) = (tmp_path / "cache").glob("*.lock")
    (index,) = (tmp_path / "cache").rglob("*.nbi")
    kept = index.rename(tmp_path / "kept")
    kernel = jitted(increased)
    worker = threading.Thread(target=kernel, args=(1.0,))
    with lock.open("w") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        worker.start()
        worker.join(timeout=0.3)
        assert worker.is_alive()
        kept.rename(index)
    worker.join()
    assert kernel.stats.cache_hits and not kernel.stats.cache_misses


SUM = """
import sys
import numpy
from numerics.jit import jitted

@jitted
def total(a):
    found, rows = 0.0, numpy.zeros(a.size)
    for i in range(a.size):
        rows[i] = a[i] + 1.0
        found += rows[i]
    return found, rows

found, rows = total(numpy.ones(3))
assert found == 6.0 and rows.tolist() == [2.0, 2.0, 2.0]
print(int(not total.stats.cache_hits), "numba.np.npyfuncs" in sys.modules)
if len(sys.argv) > 1:
    print(total(numpy.ones(3, dtype=numpy.float32))[0])
"""


def test_a_cached_kernel_runs_without_the_registries_of_the_compiler(tmp_path):
    """They take longer to import than a short run; a kernel that must be compiled still finds
    them, after another one has been loaded without them too."""
    (tmp_path / "program.py").write_text(SUM)
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": str(tmp_path)}
    command = [sys.executable, str(tmp_path / "program.py")]
    said = [
        subprocess.check_output([*command, *more], env=environment, text=True).split()
        for more in ([], [], ["another type"])
    ]
    assert said == [["1", "True"], ["0", "False"], ["0", "False", "6.0"]]


SLIDES = {"load.direction": [0.6, 0.8, 0.0], "joints.friction_angle": 30.0}


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"numerics.dem.scheme": "fourth-order"},
        pytest.param(SLIDES, marks=pytest.mark.slow),
    ],
)
def test_no_kernel_takes_a_kernel_as_an_argument(changes, scene_with):
    """What numba keeps of such a one it cannot write again in a process that has let the other go:
    so none that was compiled for a run, of this or another test, is kept for the type of a
    kernel."""
    dem.simulate(scene_with(**{"time.duration": 1e-3} | changes))
    kept = {path.name: signatures(path) for path in jit.DIRECTORY.rglob("*.nbi")}
    assert any("march" in name or "loop" in name for name in kept), sorted(kept)
    for name, found in kept.items():
        for types in found:
            assert not any(isinstance(one, numba.types.Dispatcher) for one in types), name


def signatures(index):
    """Return the types of the arguments that a kernel has been compiled for."""
    with index.open("rb") as file:
        pickle.load(file)  # of numba's version
        _stamp, overloads = pickle.loads(file.read())
    return [key[0] for key in overloads]
