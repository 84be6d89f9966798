"""The compiled kernels are kept on disk, and never outlive the sources they came from."""

import fcntl
import os
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import numba
import pytest

from jointwave import joints
from jointwave.numerics import jit
from jointwave.numerics.cache import PACKAGES, UNUSED, cache_directory, make, mark_used
from jointwave.numerics.jit import jitted

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


def test_kernels_are_cached_there():
    assert cache_directory(ROOT) == jit.DIRECTORY
    jitted(lambda x: x + 1.0)
    assert str(jit.DIRECTORY) == numba.config.CACHE_DIR


def test_one_process_at_a_time_compiles(tmp_path, monkeypatch):
    """While another holds the lock a kernel waits, and nothing enters the cache; then it does."""
    monkeypatch.setattr(jit, "DIRECTORY", tmp_path)
    kernel = jitted(lambda x: x + 1.0)
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")  # as numba does when it is set anew
    worker = threading.Thread(target=kernel, args=(1.0,))
    with (tmp_path / "lock").open("w") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        worker.start()
        worker.join(timeout=0.3)
        assert worker.is_alive() and not list(tmp_path.rglob("*.nb?"))
    worker.join()
    assert {path.suffix for path in tmp_path.rglob("*.nb?")} == {".nbi", ".nbc"}


def test_what_takes_long_is_announced_once(monkeypatch, caplog):
    jit.announce.cache_clear()
    monkeypatch.setattr(jit, "WAIT", 0.0)
    slow = SimpleNamespace(compile=lambda types: time.sleep(0.3))
    with caplog.at_level("INFO", logger="jointwave"):
        jit.compile_for(slow, ())
        jit.compile_for(slow, ())
    assert [record.message.split(" for")[0] for record in caplog.records] == ["compiling kernels"]


PROGRAM = """
import sys
from jointwave.numerics import jit

compile_for = jit.compile_for

def told(kernel, types):
    compile_for(kernel, types)
    print(kernel.py_func.__qualname__, "loaded" if kernel.stats.cache_hits else "compiled")

jit.compile_for = told
import jointwave

joints = {"joints.friction_angle": 30.0}
short = {"variants": [], "pillar.length": 4.0, "time.duration": 1e-3, "record.stress": [2.0],
         "record.velocity": [2.0]}
inclined = {"load.direction": [0.6, 0.8, 0.0], "numerics.continuum.elements_per_block": 1}
implicit = {"numerics.continuum.scheme": "implicit"}
fourth = {"numerics.dem.scheme": "fourth-order"}
for engine, name, changes in (
    ("dem", "guo-li-2002/fig-03", short),
    ("dem", "guo-li-2002/fig-03", short | fourth),
    ("dem", "guo-li-2002/fig-03", short | inclined | joints),
    ("dem", "rock-mass/one-joint", {"variants": [], "time.duration": 1e-3}),
    ("continuum-jointed", "guo-li-2002/fig-03", short),
    ("continuum-jointed", "guo-li-2002/fig-03", short | implicit),
):
    jointwave.simulate(jointwave.load(name, "", changes), engine)
"""


def test_a_second_process_finds_every_kernel_of_both_engines(tmp_path):
    """Two that start at once share the work: each kernel is compiled once, and loaded after."""
    (tmp_path / "program.py").write_text(PROGRAM)
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": str(tmp_path)}
    environment.pop("NUMBA_CACHE_DIR", None)
    command = [sys.executable, str(tmp_path / "program.py")]
    both = [
        subprocess.Popen(command, env=environment, text=True, stdout=subprocess.PIPE)
        for _ in range(2)
    ]
    first = [process.communicate()[0].splitlines() for process in both]
    assert not any(process.returncode for process in both)
    for one, other in zip(*first, strict=True):
        assert sorted(line.split()[-1] for line in (one, other)) == ["compiled", "loaded"]
    again = subprocess.check_output(command, env=environment, text=True).splitlines()
    assert len(again) == len(first[0]) >= 6
    assert all(line.endswith(" loaded") for line in again), again
