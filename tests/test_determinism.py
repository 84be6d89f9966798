"""The same scene gives the same bits in another process, on threads too."""

import json
import os
import subprocess
import sys

import pytest
import xarray as xr

from jointwave.cases import load_variant
from jointwave.compare.engines import solve
from jointwave.compare.scenes import find

SCENE = "guo-li-2002/fig-03"
SHORT = {"time.duration": 2e-3, "record.interval": 1e-4, "pillar.length": 10.0}
SHORT |= {"record.stress": [0.0, 5.0, 7.3], "record.velocity": [0.25, 6.1]}
LOSSY = {"joints.tension": False, "ends.end": "quiet"}
ROCK = LOSSY | {"joints.damping_ratio": 0.02, "numerics.continuum.elements_per_block": 2}

#: Thirteen tiles of 1024 blocks, with what threads share: slip, the ledger, receivers.
ROW = {
    "pillar.length": 6400.0,
    "load.direction": [0.6, 0.8, 0.0],
    "joints.friction_angle": 30.0,
    "joints.cohesion": 1e5,
    "record.stress": [2.0, 32.0, 320.0],
    "record.velocity": [0.25, 31.9],
}

#: Scenes of each engine and scheme: who solves them, and what is changed.
RUNS = {
    "blocks": ("dem", LOSSY),
    "blocks, fourth order": ("dem", {"numerics.dem.scheme": "fourth-order"}),
    "rock, explicit": ("continuum-jointed", ROCK | {"numerics.continuum.scheme": "explicit"}),
    "rock, implicit": ("continuum-jointed", ROCK | {"numerics.continuum.scheme": "implicit"}),
    "blocks on threads": ("dem", ROW | {"numerics.dem.threads": 3}),
}

RUN_ALL = """
import json, sys
import jointwave
for name, (engine, changes) in json.loads(sys.argv[2]).items():
    scene = jointwave.load(sys.argv[1], changes=changes)
    jointwave.simulate(scene, engine).to_netcdf(f"{name}.nc")
"""


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Return the results of all runs of this and of another process, of another hash seed."""
    runs = {name: (engine, SHORT | keys) for name, (engine, keys) in RUNS.items()}
    folder, here = tmp_path_factory.mktemp("runs"), tmp_path_factory.mktemp("here")
    seed = "2" if os.environ.get("PYTHONHASHSEED") == "1" else "1"
    done = subprocess.run(
        [sys.executable, "-c", RUN_ALL, SCENE, json.dumps(runs)],
        capture_output=True,
        text=True,
        cwd=folder,
        env={**os.environ, "PYTHONHASHSEED": seed},
    )
    assert done.returncode == 0, done.stderr
    for name, (engine, keys) in runs.items():
        solve(engine, load_variant(find(SCENE), "", keys)).to_netcdf(here / f"{name}.nc")
    return tuple({one: xr.load_dataset(at / f"{one}.nc") for one in RUNS} for at in (folder, here))


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
def test_a_run_repeats_bit_for_bit(results, name):
    one, other = results
    assert_same_bits(one[name], other[name])


def test_the_last_bit_of_a_load_is_told():
    loads = (1e6, 1e6 * (1 + 2**-52))
    one, other = (
        solve("dem", load_variant(find(SCENE), "", SHORT | {"load.amplitude": x})) for x in loads
    )
    assert bits(one["stress"]) != bits(other["stress"])
