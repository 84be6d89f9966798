"""The same scene gives the same bits: in another process, on any number of threads."""

import os
import subprocess
import sys

import pytest
import xarray as xr

SCENE = "guo-li-2002/fig-03"
SHORT = {"time.duration": 2e-3, "record.interval": 1e-4, "pillar.length": 10.0}
SHORT |= {"record.stress": [0.0, 5.0, 7.3], "record.velocity": [0.25, 6.1]}
LOSSY = {"joints.damping_ratio": 0.02, "joints.tension": False, "ends.end": "quiet"}
ROCK = {"numerics.continuum.elements_per_block": 2}

#: Scenes of each engine and scheme: what is run, and what is changed.
RUNS = {
    "blocks": (("dem",), LOSSY),
    "blocks, fourth order": (("dem",), {"numerics.dem.scheme": "fourth-order"}),
    "rock, explicit": (
        ("continuum", "--model", "jointed"),
        LOSSY | ROCK | {"numerics.continuum.scheme": "explicit"},
    ),
    "rock, implicit": (
        ("continuum", "--model", "jointed"),
        LOSSY | ROCK | {"numerics.continuum.scheme": "implicit"},
    ),
}

#: Twenty tiles of 64 blocks, with all that threads share: dashpots, slip, the ledger, receivers.
ROW = {
    "pillar.length": 640.0,
    "load.direction": [0.6, 0.8, 0.0],
    "joints.damping_ratio": 0.02,
    "joints.friction_angle": 30.0,
    "joints.cohesion": 1e5,
    "record.stress": [2.0, 32.0, 320.0],
    "record.velocity": [0.25, 31.9],
}


def waves(folder, seed, engine, changes):
    """Return the result of a run in a process of its own, whose hashes are seeded so."""
    out = folder / f"run {seed} {len(list(folder.iterdir()))}"
    options = [x for k, v in changes.items() for x in ("--set", f"{k}={toml(v)}")]
    command = [sys.executable, "-m", "compare", "run", SCENE, "--variant", "", "--engine", *engine]
    done = subprocess.run(
        [*command, *options, "--out", str(out)],
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONHASHSEED": str(seed)},
    )
    assert done.returncode == 0, done.stderr
    (file,) = out.glob("*.nc")
    return xr.load_dataset(file)


def toml(value):
    return str(value).lower() if isinstance(value, bool) else repr(value)


def assert_same_bits(one, other):
    assert one.sizes["time"] > 1 and float(abs(one["stress"]).max()) > 0
    assert list(one.variables) == list(other.variables)
    for name in one.variables:
        assert bits(one[name]) == bits(other[name]), name


def bits(variable):
    """Return the bytes of numbers, the words of texts."""
    values = variable.values
    return values.tolist() if values.dtype.kind in "OUS" else values.tobytes()


@pytest.mark.parametrize("name", RUNS)
def test_a_run_repeats_bit_for_bit(name, tmp_path):
    engine, changes = RUNS[name]
    one, other = (waves(tmp_path, seed, engine, SHORT | changes) for seed in (1, 2))
    assert_same_bits(one, other)


def test_the_last_bit_of_a_load_is_told(tmp_path):
    """Runs that differ by one unit in the last place are not taken for the same."""
    loads = (1e6, 1e6 * (1 + 2**-52))
    one, other = (waves(tmp_path, 1, ("dem",), SHORT | {"load.amplitude": x}) for x in loads)
    assert bits(one["stress"]) != bits(other["stress"])


def test_threads_change_no_bit_of_a_run(tmp_path):
    """Whole runs of the command, in processes of their own."""
    found = [
        waves(tmp_path, threads, ("dem",), SHORT | ROW | {"numerics.dem.threads": threads})
        for threads in (1, 2, 3)
    ]
    assert [result.attrs["threads"] for result in found] == [1, 2, 3]
    for other in found[1:]:
        assert_same_bits(found[0], other)
