"""Compiled kernels are kept on disk, never outlive their sources, and flush denormals."""

import fcntl
import os
import shutil
import subprocess
import sys
import threading
import time
from collections import Counter
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import numba
import numpy as np
import pytest

from jointwave import joints
from jointwave.cases.errors import SceneError
from jointwave.numerics import jit
from jointwave.numerics.cache import PACKAGES, UNUSED, cache_directory, make, mark_used
from jointwave.numerics.denormals import ARM, X86, flush_denormals, restore_denormals
from jointwave.numerics.jit import jitted

ROOT = Path(joints.__file__).resolve().parent.parent


def test_cache_follows_every_source(tmp_path):
    """One character in any kernel's file, a callee's included, is another cache."""
    for package in PACKAGES:
        shutil.copytree(ROOT / package, tmp_path / package)
    states = {cache_directory(tmp_path)}
    assert states == {cache_directory(ROOT)} == {jit.DIRECTORY}
    for edited in ("joints/law.py", "dem/kernel/loop.py", "continuum/stepping/explicit.py"):
        with (tmp_path / edited).open("a") as file:
            file.write("#")
        states.add(cache_directory(tmp_path))
    assert len(states) == 4
    jitted(more)
    assert str(jit.DIRECTORY) == numba.config.CACHE_DIR


def test_states_that_no_program_has_used_for_long_are_dropped(tmp_path):
    """When a new one is made: what is in use and what is not ours stays. Use makes none."""
    past, used, other = (tmp_path / name for name in ("0" * 16, "1" * 16, "mine"))
    for folder in (past, used, other):
        (folder / "joints").mkdir(parents=True)
        (folder / "joints" / "a.nbi").touch()
        os.utime(folder, (0, time.time() - 1.01 * UNUSED))
    mark_used(used)
    mark_used(tmp_path / ("3" * 16))
    make(used)
    assert past.exists()
    make(tmp_path / ("2" * 16))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["1" * 16, "2" * 16, "mine"]
    assert (other / "joints" / "a.nbi").exists() and (used / "joints" / "a.nbi").exists()


def more(x):
    return x + 1.0


def test_a_kernel_is_compiled_where_nothing_can_be_written(monkeypatch):
    """A user without a home, beside sources of another's: nothing under /proc can be made."""
    monkeypatch.setenv("HOME", "/proc/nobody")
    monkeypatch.setattr(jit, "DIRECTORY", Path("/proc/nobody/cache"))
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    made = {}
    exec(compile("def less(x): return x - 1.0", "/proc/nobody/less.py", "exec"), made)
    assert jitted(made["less"])(2.0) == 1.0


def test_kernels_that_numba_may_not_compile_are_refused_in_a_line(monkeypatch):
    monkeypatch.setattr(numba.config, "DISABLE_JIT", 1)
    with pytest.raises(SceneError, match=r"NUMBA_DISABLE_JIT: must be 0"):
        jitted(more)


def test_one_process_at_a_time_compiles_a_function(tmp_path, monkeypatch):
    """While another holds its lock a kernel waits, and nothing enters the cache; then it does."""
    monkeypatch.setattr(jit, "DIRECTORY", tmp_path)
    kernel = jitted(more)
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")  # as numba does when it is set anew
    worker = threading.Thread(target=kernel, args=(1.0,))
    with (tmp_path / f"{__name__}.more.lock").open("w") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        worker.start()
        worker.join(timeout=0.3)
        assert worker.is_alive() and not list(tmp_path.rglob("*.nb?"))
    worker.join()
    assert {path.suffix for path in tmp_path.rglob("*.nb?")} == {".nbi", ".nbc"}


def test_kernels_of_different_flags_compile_at_the_same_time(tmp_path, monkeypatch):
    """Each has a lock and files of its own; the same flags have the same in every process."""
    monkeypatch.setattr(jit, "DIRECTORY", tmp_path)

    def kernel(flags):
        def shifted(x):
            return x + flags[0]

        return jitted(shifted, flags)

    assert kernel((1.0, True))(1.0) == 2.0
    (lock,) = tmp_path.glob("*.lock")
    with lock.open("w") as other:
        fcntl.flock(other, fcntl.LOCK_EX)
        assert kernel((2.0, True))(1.0) == 3.0
    assert kernel((1.0, True))(1.0) == 2.0
    assert len([*tmp_path.glob("*.lock")]) == len([*tmp_path.rglob("*.nbc")]) == 2


def test_what_takes_long_is_announced_once(monkeypatch, caplog):
    jit.announce.cache_clear()
    monkeypatch.setattr(jit, "WAIT", 0.0)
    slow = SimpleNamespace(compile=lambda types: time.sleep(0.3), py_func=more)
    with caplog.at_level("INFO", logger="jointwave"):
        jit.compile_for(slow, ())
        jit.compile_for(slow, ())
    assert [record.message.split(" for")[0] for record in caplog.records] == ["compiling kernels"]


#: Runs that between them take a kernel of every kind: of blocks, of explicit rock, of implicit.
PROGRAM = """
import sys
from jointwave.cases.errors import SceneError
from jointwave.numerics import jit

compile_for = jit.compile_for

def told(kernel, types):
    found = kernel.stats.cache_hits.total()
    compile_for(kernel, types)
    loaded = kernel.stats.cache_hits.total() > found
    print(kernel.py_func.__qualname__, types, "loaded" if loaded else "compiled")

jit.compile_for = told
import jointwave

short = {"variants": [], "pillar.length": 4.0, "time.duration": 1e-3, "record.stress": [2.0],
         "record.velocity": [2.0], "record.energy": False}
implicit = {"numerics.continuum.scheme": "implicit"}
for engine, changes in (("dem", {}), ("continuum-jointed", {}), ("continuum-jointed", implicit)):
    jointwave.simulate(jointwave.load("guo-li-2002/fig-03", "", short | changes), engine)
"""

#: Slip across the axis, and a rock mass, whose kernel has been seen to be compiled once more by a
#: second process.
MORE = """
inclined = {"load.direction": [0.6, 0.8, 0.0], "joints.friction_angle": 30.0}
for name, changes in (("guo-li-2002/fig-03", short | inclined),
                      ("rock-mass/one-joint", {"variants": [], "time.duration": 1e-3})):
    jointwave.simulate(jointwave.load(name, "", changes), "dem")
"""


@pytest.fixture
def start(tmp_path):
    """Start a program that runs engines from a copy of the sources, whose cache of kernels is empty
    at first; the first one compiles the sources of Python too, later ones load their bytecode."""
    tree, alone = tmp_path / "sources", shutil.ignore_patterns("__pycache__")
    for name in ("", "cases", "compare", "results", *PACKAGES):
        part = Path(import_module(f"jointwave.{name}".strip(".")).__file__).parent
        shutil.copytree(part, tree / "jointwave" / name, ignore=alone, dirs_exist_ok=True)
    usual = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "fenics"
    usual.mkdir(parents=True, exist_ok=True)
    (tmp_path / "fenics").symlink_to(usual)  # forms are compiled as ever
    environment = {**os.environ, "PYTHONPATH": str(tree), "XDG_CACHE_HOME": str(tmp_path)}
    for name in ("NUMBA_CACHE_DIR", "PYTHONDONTWRITEBYTECODE", "PYTHONPYCACHEPREFIX"):
        environment.pop(name, None)

    def started(program=PROGRAM):
        (tmp_path / "program.py").write_text(program)
        command = [sys.executable, str(tmp_path / "program.py")]
        return subprocess.Popen(command, env=environment, text=True, stdout=subprocess.PIPE)

    return started


def told_by(process):
    """Return each kernel that a program took, and how often it did which way."""
    lines = process.communicate()[0].splitlines()
    assert process.returncode == 0 and len(lines) >= 4
    return Counter(tuple(line.rsplit(maxsplit=1)) for line in lines)


def test_a_second_process_finds_every_kernel_of_both_engines(start):
    first, second = told_by(start()), told_by(start())
    assert {way for _, way in first} == {"compiled"}
    assert second == Counter({(kernel, "loaded"): n for (kernel, _), n in first.items()})


@pytest.mark.slow
def test_processes_that_start_at_once_compile_each_kernel_once(start):
    """Whichever comes first compiles it, the other waits and loads it."""
    one, other = start(PROGRAM + MORE), start(PROGRAM + MORE)
    both = told_by(one) + told_by(other)
    for kernel, _ in both:
        assert both[kernel, "compiled"] == both[kernel, "loaded"], both


@jitted
def halve(x, out, flush):
    if flush:
        old = flush_denormals()
    for i in range(x.size):
        out[i] = x[i] * 0.5
    if flush:
        restore_denormals(old)


@pytest.mark.skipif(not (X86 or ARM), reason="tiny numbers stay on this kind of processor")
def test_tiny_numbers_are_zero_only_while_asked():
    """2.2e-308 halved is below full precision: zero under the flag, itself before and after."""
    smallest, half = np.full(3, np.finfo(float).tiny), np.zeros(3)
    for flush, expected in ((False, np.ldexp(smallest, -1)), (True, 0.0), (False, smallest / 2)):
        halve(smallest, half, flush)
        assert (half == expected).all() and half.any() != flush
