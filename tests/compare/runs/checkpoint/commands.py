"""Commands of runs that tests end; what is waited for, and results compared bit by bit."""

import time
from pathlib import Path

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


def arguments(kind, out, *more):
    """Return those of a run of RUNS into a folder."""
    return "run", *SCENE, *AT, *RUNS[kind], "--out", out, *more


def is_locked(folder):
    """Return whether a command has locked a folder of results."""
    place = f":{folder.stat().st_ino} " if folder.is_dir() else "nowhere"
    return place in Path("/proc/locks").read_text()


def until(process, holds):
    """Wait until something holds while a process runs; return whether it did before that ended."""
    end = time.monotonic() + PATIENCE
    while process.poll() is None:
        if holds():
            return True
        assert time.monotonic() < end, "nothing happens"
        time.sleep(0.005)
    return False


def refuse_difference(*paths):
    """Fail unless two results are bit-identical, but for their cost: a resumed run factors anew."""
    one, other = (xr.load_dataset(path) for path in paths)
    for result in (one, other):
        cost = ("seconds_", "factorisations")
        result.attrs = {k: v for k, v in result.attrs.items() if not k.startswith(cost)}
    xr.testing.assert_identical(one, other)
    for name, values in one.variables.items():
        if values.dtype != object:
            assert values.dtype == other[name].dtype
            assert values.values.tobytes() == other[name].values.tobytes(), name
