"""Shared by the tests of checkpoints: real processes, and results compared bit by bit."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr

SCENE = ("guo-li-2002/fig-03", "--variant", "", "--set", "pillar.length=10.0")
AT = ("--set", "record.stress=[5.0]", "--set", "record.velocity=[4.75, 5.25]")
PATIENCE = 600  # s, for what takes seconds: other tests run at the same time


def keys(*changes):
    return tuple(part for change in changes for part in ("--set", change))


#: A run is looked at wherever it keeps a snapshot.
AXIAL = ("numerics.dem.step_fraction=4e-5", "joints.damping_ratio=0.02", "record.fields=2e-3")
SHARED = ("numerics.continuum.step_fraction=0.05", "time.duration=0.02", "record.fields=1e-3")
ROCK = ("--engine", "continuum", "--model", "jointed")
#: Options of runs that step for a second or two, in one process and in two; other engines show what
#: they save in test_checkpoints.py.
RUNS = {
    "axial": keys(*AXIAL),
    "shared": (*ROCK, *keys("numerics.continuum.scheme=explicit", *SHARED)),
}


@pytest.fixture
def is_locked():
    """Return a function that says whether a command has locked a folder of results."""

    def found(folder):
        place = f":{folder.stat().st_ino} " if folder.is_dir() else "nowhere"
        return place in Path("/proc/locks").read_text()

    return found


@pytest.fixture
def start(request):
    """Return a function that starts `jointwave` with these arguments, on so many processes.

    None is left running. Each is the first of a process group of its own, so that Ctrl-C can reach
    all of one, and minds it even where the tests run in the background.
    """
    begun = []

    def started(*arguments, ranks=1, out=subprocess.PIPE):
        command = [sys.executable, "-m", "jointwave", *map(str, arguments)]
        environment = None
        if ranks > 1:
            mpiexec, environment = request.getfixturevalue("mpiexec")
            command = [*mpiexec, "-n", str(ranks), *command]
        begun.append(
            subprocess.Popen(
                command,
                stdout=out,
                stderr=subprocess.PIPE,
                text=True,
                env=environment,
                start_new_session=True,
                preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
            )
        )
        return begun[-1]

    yield started
    for process in begun:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
            process.communicate()


@pytest.fixture
def finish(without_warnings):
    """Return a function that waits for a process to end; gives its exit code and its own lines,
    but for warnings: the scenes end early."""

    def finished(process):
        _, said = process.communicate(timeout=PATIENCE)
        assert "Traceback" not in said, said
        lines = [line for line in without_warnings(said) if line.startswith("jointwave: ")]
        return process.returncode, lines

    return finished


@pytest.fixture
def said(jointwave, without_warnings):
    return lambda *run, code=0: without_warnings(jointwave(*run, code=code).err)


@pytest.fixture
def until():
    """Return a function that waits until something holds while a process runs.

    It returns whether it came to hold before the process ended.
    """

    def waited(process, holds):
        end = time.monotonic() + PATIENCE
        while process.poll() is None:
            if holds():
                return True
            assert time.monotonic() < end, "nothing happens"
            time.sleep(0.005)
        return False

    return waited


@pytest.fixture
def stopped(start, until, finish):
    """Return a function that starts a run, sends it a signal at its first checkpoint in a folder,
    and gives its exit code and its lines."""

    def ended(run, folder, number):
        process = start(*run)
        assert until(process, lambda: list(folder.glob(".*.checkpoint-*-0.npz")))
        process.send_signal(number)
        return finish(process)

    return ended


@pytest.fixture
def arguments():
    def of(kind, out, *more):
        return "run", *SCENE, *AT, *RUNS[kind], "--out", out, *more

    return of


@pytest.fixture
def whole(once, start, finish, arguments):
    """Return a function that gives the result of a run of RUNS that nothing ended, made once."""

    def of(kind):
        def made(folder):
            code, lines = finish(start(*arguments(kind, folder), ranks=1 + (kind == "shared")))
            assert code == 0, lines
            (result,) = folder.glob("*.nc")
            return result

        return once(f"whole-{kind}", made)

    return of


@pytest.fixture
def refuse_difference():
    """Return a function that fails unless two results are bit-identical, except for their cost: a
    run that goes on factors anew."""

    def refuse(*paths):
        one, other = (xr.load_dataset(path) for path in paths)
        for result in (one, other):
            cost = ("seconds_", "factorisations")
            result.attrs = {k: v for k, v in result.attrs.items() if not k.startswith(cost)}
        xr.testing.assert_identical(one, other)
        for name, values in one.variables.items():
            if values.dtype != object:
                assert values.dtype == other[name].dtype
                assert values.values.tobytes() == other[name].values.tobytes(), name

    return refuse
