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
ROCK = ("--engine", "continuum", "--model", "jointed", "--set", "numerics.continuum.scheme=")
DAMPED = ("joints.damping_ratio=0.02",)
SHOT = ("record.fields=2e-3",)  # s; a run is looked at wherever it keeps a snapshot
PATIENCE = 600  # s, for what takes seconds: other tests run at the same time


def keys(*changes):
    """Return options that change keys of the scene."""
    return tuple(part for change in changes for part in ("--set", change))


def rock(scheme, *changes):
    """Return the options of a continuum with steps of this scheme."""
    return *ROCK[:-1], ROCK[-1] + scheme, *keys(*changes)


#: Options, name of the result and number of processes of runs that step for a second or two.
RUNS = {
    "axial": (keys("numerics.dem.step_fraction=4e-5", *DAMPED, *SHOT), "dem.nc", 1),
    "spatial": (
        keys("numerics.dem.step_fraction=4e-3", "load.direction=[1, 0, 0]", *SHOT),
        "dem.nc",
        1,
    ),
    "explicit": (
        rock("explicit", "numerics.continuum.step_fraction=2e-3", *SHOT),
        "continuum-jointed.nc",
        1,
    ),
    "implicit": (rock("implicit", "joints.tension=false", *SHOT), "continuum-jointed.nc", 1),
    "shared": (
        rock(
            "explicit",
            "numerics.continuum.step_fraction=0.05",
            "time.duration=0.02",
            "record.fields=1e-3",
        ),
        "continuum-jointed.nc",
        2,
    ),
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
    """Return a function that runs the command in this process, checks its exit status, and gives
    its lines on standard error."""
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
def arguments():
    """Return a function that gives the arguments of a run of RUNS into a folder."""

    def of(kind, out, *more):
        return "run", *SCENE, *AT, *RUNS[kind][0], "--out", out, *more

    return of


@pytest.fixture
def runs():
    """Return the name of the result and the number of processes of every run of RUNS."""
    return {kind: (file, ranks) for kind, (_, file, ranks) in RUNS.items()}


@pytest.fixture
def whole(once, start, said, finish, arguments, runs):
    """Return a function that gives the folder of a run of RUNS that nothing ended, made once."""

    def of(kind):
        def made(folder):
            if runs[kind][1] == 1:
                assert said(*arguments(kind, folder)) == []
            else:
                code, lines = finish(start(*arguments(kind, folder), ranks=runs[kind][1]))
                assert code == 0, lines
            return folder

        return once(f"whole-{kind}", made)

    return of


@pytest.fixture
def refuse_difference():
    """Return a function that fails unless two results are bit-identical, except for their cost."""

    def refuse(one, other):
        with xr.open_dataset(one) as a, xr.open_dataset(other) as b:
            assert a.variables.keys() == b.variables.keys()
            for name in a.variables:
                assert a[name].dims == b[name].dims and a[name].dtype == b[name].dtype
                assert _bits(a[name].values) == _bits(b[name].values), name
            assert _lasting(a) == _lasting(b)

    return refuse


def _bits(values):
    """Return what is in an array, texts as such."""
    return values.tolist() if values.dtype == object else values.tobytes()


def _lasting(result):
    """Return what a result says of itself, but for its cost: a run that goes on factors anew."""
    cost = {"factorisations"} | {key for key in result.attrs if key.startswith("seconds_")}
    return {key: value for key, value in result.attrs.items() if key not in cost}
