"""Runs that would not fit the memory are refused before anything of theirs is made."""

import os
import re
import struct
import subprocess
import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from jointwave import cases
from jointwave.cases.errors import SceneError
from jointwave.cases.gmsh_file import read_tagged
from jointwave.cases.records import read_columns, read_history
from jointwave.cases.run_memory import refuse_beyond_memory, waveform_bytes
from jointwave.cases.size import LIMIT, memory
from jointwave.compare.engines import solve, solver
from jointwave.compare.misfit.columns import read_netcdf
from jointwave.compare.report import peers
from jointwave.compare.runs.output import read_rows
from jointwave.compare.scenes import load
from jointwave.results import dataset
from jointwave.results.labels import QUANTITIES, RECEIVERS
from jointwave.results.netcdf import load_netcdf

AT_ONCE = 200e6  # bytes: what reading a scene of ten million blocks takes, not one run refused here


@pytest.fixture
def limit(monkeypatch):
    """Set the memory that runs may take, GB."""
    return lambda size: monkeypatch.setenv(LIMIT, str(size))


SHORT = {"record__interval": 1e-7, "time__duration": 1e-5}
LONG = {"record__interval": 1e-6, "time__duration": 1.0, "load__period": 0.01}
SPACE = {"load__direction": [0.6, 0.8, 0.0]}

FRACTION, ELEMENTS = "numerics.dem.step_fraction", "numerics.continuum.elements_per_block"
COARSE = dict(numerics__continuum__elements_per_block=1)
FINE = dict(numerics__continuum__elements_per_block=1000, pillar__block=0.05)
THICK = dict(numerics__continuum__dim=3, numerics__continuum__elements_across=50)
FIELDS = dict(record__fields=1e-5, time__duration=1e-2, record__interval=1e-5)
FOURTH = dict(numerics__dem__scheme="fourth-order", numerics__dem__step_fraction=3e-7)
ONCE = dict(record__interval=1.0, time__duration=9.0)
OPENS = dict(joints__tension=False, record__interval=1e-6)
SHARP = dict(load__period=1e-12, record__interval=1e-5)
BRIEF = dict(load__period=1e-9, record__interval=1e-4)

#: What is too large for 0.1 GB, the solver, and the key that decides it or what of it is large.
LARGE = {
    "blocks": (SHORT | dict(pillar__block=2e-5), "dem", "pillar.block"),
    "blocks in space": (SHORT | SPACE | dict(pillar__block=5e-5), "dem", "pillar.block"),
    "samples": (LONG, "dem", "record.interval"),
    "samples in space": (LONG | SPACE, "dem", "record.interval"),
    "steps": (dict(numerics__dem__step_fraction=1e-7), "dem", FRACTION),
    "steps of fourth order": (FOURTH, "dem", FRACTION),
    "snapshots": (FIELDS | dict(pillar__block=0.025), "dem", "record.fields"),
    "elements": (FINE, "continuum-jointed", ELEMENTS),
    "elements that a short period asks for": (SHARP, "continuum-equivalent", ELEMENTS),
    "cells of a column": (THICK, "continuum-jointed", "numerics.continuum.elements_across"),
    "samples of an exact solution": (LONG | {"time__duration": 3.0}, "lattice", "record.interval"),
    "a short load": (BRIEF, "jointed-bar", "jointed-bar: .*instants of the load"),
    "an integral": (ONCE, "lattice", "lattice: .*points of integration"),
    "states": (OPENS, "no-tension-chain", "no-tension-chain: .*states of"),
}


@pytest.mark.parametrize("name", LARGE)
def test_a_large_run_is_refused_with_its_estimate(pillar, limit, name):
    """In one line that names the key and both sizes, before the arrays are made."""
    changes, solver, key = LARGE[name]
    scene = pillar(**changes)
    limit(0.1)
    tracemalloc.start()
    with pytest.raises(SceneError, match=rf"{key}.*would need about .* (GB|MB)") as error:
        solve(solver, scene)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert "100 MB available" in str(error.value) and len(str(error.value).splitlines()) == 1
    assert most < AT_ONCE


@pytest.mark.parametrize(
    "solver, changes", [("dem", {}), ("dem", SPACE), ("continuum-jointed", COARSE)]
)
def test_a_run_within_the_memory_is_made(pillar, limit, solver, changes):
    """The estimate of a short run of a hundred blocks is some MB, far below what it is given."""
    limit(5e-3)
    short = dict(time__duration=2e-3, record__interval=1e-4)
    assert solve(solver, pillar(**short, **changes)).sizes["time"] == 21


def test_elements_of_rock_that_nothing_excites_fit_and_a_refusal_names_some_that_do(
    one_joint, limit
):
    """However short the run is, they are those of a wave as long as the rock's least extent."""
    joints = [{"name": "bed", "dip": 0.0, "spacing": 10.0}]
    joints[0] |= {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
    weight = {"acceleration": 9.81, "static": False}
    tables = one_joint(gravity=weight, boundaries={"bottom": "fixed"}, joint_sets=joints)
    del tables["waves"]

    def run(duration, **continuum):
        numerics = {"continuum": continuum}
        scene = load(tables | {"time": {"duration": duration}, "numerics": numerics})
        return solver("continuum-jointed").prepare(scene)

    assert run(1e-3).freedoms == run(1e-5).freedoms > run(1.0).freedoms
    limit(1e-3)
    with pytest.raises(SceneError, match=r"numerics\.continuum\.size: .*; elements of") as error:
        run(1e-3)
    size = float(re.search(r"elements of (\S+) m fit", str(error.value))[1])
    assert run(1e-3, size=size).freedoms > 0
    with pytest.raises(SceneError, match=r"numerics\.continuum\.size"):
        run(1e-3, size=size / 1.3)


CHILD = """
import sys
from pathlib import Path
from jointwave import cases
from jointwave.compare.runs.output import write_dataset
from jointwave.dem import simulate


def highest():
    lines = open("/proc/self/status").read().splitlines()
    return 1024 * int(next(x for x in lines if x.startswith("VmHWM")).split()[1])


def run(blocks, samples):
    changes = {"variants": [], "pillar.length": 0.5 * blocks, "record.stress": [1.0],
               "record.velocity": [1.0], "record.interval": 1e-6, "time.duration": 1e-6 * samples}
    found = simulate(cases.load_variant(sys.argv[1], "", changes))
    write_dataset(Path(sys.argv[4]), found)


run(10, 10)
before = highest()
run(int(sys.argv[2]), int(sys.argv[3]))
print(highest() - before)
"""


@pytest.mark.parametrize(
    "blocks, samples, key", [(1_000_000, 3, "pillar.block"), (10, 2_000_000, "record.interval")]
)
def test_the_estimate_is_near_what_a_run_takes(pillar, limit, tmp_path, blocks, samples, key):
    """No more, or a run that fits would be refused; no less than a third, or it bounds nothing."""
    file = Path(cases.__file__).parent / "guo-li-2002" / "fig-03.toml"
    arguments = map(str, (file, blocks, samples, tmp_path / "x.nc"))
    command = [sys.executable, "-c", CHILD, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    changes = dict(pillar__length=0.5 * blocks, record__stress=[1.0], record__velocity=[1.0])
    limit(1e-5)
    with pytest.raises(SceneError) as error:
        solve("dem", pillar(record__interval=1e-6, time__duration=1e-6 * samples, **changes))
    number, unit = re.search(r"about ([\d.e+]+) (GB|MB) of memory", str(error.value)).groups()
    estimate = float(number) * {"GB": 1e9, "MB": 1e6}[unit]
    assert error.value.key == key
    assert float(done.stdout) / 3 <= estimate <= float(done.stdout)


def test_a_file_of_curves_is_read_where_it_fits(tmp_path, limit):
    """What does not is refused by what its header says."""
    path, time = tmp_path / "run.nc", np.arange(20_000.0)
    axes = {"time": time, "stress_y": [1.0]}
    one = xr.Dataset({"stress": (("stress_y", "time"), time[None])}, axes)
    one.to_netcdf(path, engine="scipy")
    assert read_netcdf(path, 3).time.values.size == 20_000
    limit(1e-4)
    with pytest.raises(ValueError, match=r"cannot be read as NetCDF: .*would need"):
        read_netcdf(path, 3)


def test_the_bound_is_the_users_or_the_machines(monkeypatch, limit):
    limit(3)
    assert memory() == 3e9
    monkeypatch.delenv(LIMIT)
    assert 1e8 < memory() <= os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    for wrong in ("", "much", "-1", "nan", "inf", "0"):
        limit(wrong)
        with pytest.raises(SceneError, match=f"{LIMIT}: is .*must be a positive number"):
            memory()


def test_a_run_at_the_bound_is_not_refused(pillar, limit):
    limit(1.0)
    refuse_beyond_memory(pillar(), {"pillar.block": 0.4e9, "record.interval": 0.6e9})
    with pytest.raises(SceneError, match=r"record\.interval"):
        refuse_beyond_memory(pillar(), {"pillar.block": 0.4e9, "record.interval": 0.61e9})


def test_a_waveform_beyond_what_a_file_holds_is_refused(pillar):
    """Thirty sections of ten million samples: 2.4 GB, and the format ends at 2 GB a variable."""
    places = [0.5 * i for i in range(30)]
    scene = pillar(record__stress=places, record__interval=1e-7, time__duration=1.0)
    said = r"record\.stress = '30 places'.*2\.4 GB; at most 2\.15 GB"
    with pytest.raises(SceneError, match=said):
        waveform_bytes(scene)


def hollow(path, begins, size=3_000_000_000):
    """Write a file that says it is `size` long and takes 4 kB of the disk."""
    path.write_bytes(begins)
    os.truncate(path, size)
    assert path.stat().st_blocks <= 16
    return path


def classic(path, count, variables, size):
    """Write NetCDF 3 whose variables of `count` doubles over time all lie in the same place."""

    def name(text):
        return struct.pack(">i", len(text)) + text.encode() + b"\0" * (-len(text) % 4)

    nothing, bytes_of = struct.pack(">ii", 0, 0), min(8 * count, 2**31 - 4)
    header = b"CDF\2" + struct.pack(">iii", 0, 10, 1) + name("time") + struct.pack(">i", count)
    header += nothing + struct.pack(">ii", 11, len(variables))
    for one in variables:
        where = struct.pack(">iiq", 6, bytes_of, 4096)
        header += name(one) + struct.pack(">ii", 1, 0) + nothing + where
    assert len(header) < 4096
    return hollow(path, header, size)


def lines(path, text):
    path.write_text(text)
    return path


#: Files that are small on the disk or to look at, and what a command does with them.
NAMES = ["time", *QUANTITIES, *RECEIVERS, *dataset.NAMES]
BIG = 2**31 + 4096
BOMBS = {
    "curves as NetCDF": lambda p: read_netcdf(classic(p / "a.nc", 2**28, ["time"], BIG), 3),
    "curves in one place": lambda p: read_netcdf(classic(p / "a.nc", 2**20, NAMES, 9_000_000), 3),
    "a result": lambda p: load_netcdf(classic(p / "a.nc", 2**28, ["stress"], BIG)),
    "curves as CSV": lambda p: read_columns(lines(p / "a.csv", "0,0\n" * 5_000_000)),
    "curves in one line": lambda p: read_columns(lines(p / "a.csv", "0," * 1_500_000)),
    "a hollow CSV": lambda p: read_columns(hollow(p / "a.csv", b"0,0\n", 20_000_000)),
    "a load": lambda p: read_history(lines(p / "a.csv", "0,0\n" * 5_000_000), "stress"),
    "a row": lambda p: read_rows(hollow(p / "a.json", b"{")),
    "a row of lists": lambda p: read_rows(lines(p / "a.json", "[" + "[]," * 2_000_000 + "0]")),
    "a row of depth": lambda p: read_rows(lines(p / "a.json", "[" * 500_000)),
    "a table of peers": lambda p: peers.read(hollow(p / "a.csv", b"curve\n")),
    "a mesh": lambda p: read_tagged(hollow(p / "a.msh", b"$MeshFormat\n4.1 1 8\n")),
    "a scene": lambda p: cases.load(lines(p / "a.toml", "a=1\n" * 600_000)),
    "a hollow scene": lambda p: cases.load(hollow(p / "a.toml", b"title = 'a'")),
}


@pytest.mark.parametrize("name", BOMBS)
def test_a_file_is_refused_before_it_takes_the_memory(name, limit, tmp_path):
    limit(0.2)
    tracemalloc.start()
    with pytest.raises((SceneError, ValueError, MemoryError)) as error:
        BOMBS[name](tmp_path)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 0.25e9
    assert len(str(error.value).splitlines()) == 1
    assert re.search("would need|too large|longer than|not valid JSON", str(error.value))
