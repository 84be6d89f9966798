"""`jointwave doctor`: packages present, missing or broken, and whether the engines are correct."""

import json
import os
import sys

import pytest

from jointwave.compare.cli import doctor
from jointwave.compare.cli.doctor import PAIRS, PARTS, look

BLOCKS, ROCK = PAIRS


@pytest.fixture
def broken(tmp_path, monkeypatch):
    """Return a function that puts a module of some source before all others of its name."""

    def put(name, source):
        (tmp_path / f"{name}.py").write_text(source)
        monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)

    return put


def test_everything_is_a_line_and_all_is_well_here(jointwave):
    """Every part that is looked at, both checks with their numbers, exit 0. The lattice is 0.1 %
    from the blocks, the jointed bar 4 %: each check measures the pair that it names."""
    facts = json.loads(jointwave("doctor", "--json").out)
    assert facts["well"] and facts["kernel_cache"] and sys.executable in facts["Python"]
    assert [part["part"] for part in facts["parts"]] == [*PARTS]
    for part in facts["parts"]:
        assert part["state"] in ("found", "missing", "broken") and part["found"]
        assert bool(part["hint"]) == (part["state"] != "found")
    assert [one["pair"] for one in facts["self_check"]] == [BLOCKS, ROCK]
    for one in facts["self_check"]:
        assert 0 < one["misfit"] <= one["bound"] and one["holds"]
    assert facts["self_check"][0]["misfit"] == pytest.approx(1e-3, rel=0.1)


def test_what_breaks_is_a_line_and_fails_the_check_that_needs_it_alone(
    broken, jointwave, monkeypatch
):
    """An error, and an end of the process; the check of the rock fails with the reason, exit 1, and
    the blocks are right."""
    few = ("numba", "obspy", "gmsh", "dolfinx")
    monkeypatch.setattr(doctor, "PARTS", {name: PARTS[name] for name in few})
    broken("obspy", "raise RuntimeError('first line\\nsecond line')")
    broken("gmsh", "import os; os.abort()")
    broken("dolfinx", "raise ImportError('libdolfinx.so: cannot open shared object file')")
    facts = json.loads(jointwave("doctor", "--json", code=1).out)
    blocks, rock = facts["self_check"]
    assert not facts["well"] and blocks["holds"] and not rock["holds"]
    assert rock["misfit"] is None and "libdolfinx.so" in rock["reason"]
    lines = {part["part"]: part for part in facts["parts"]}
    assert {lines[name]["state"] for name in ("obspy", "gmsh", "dolfinx")} == {"broken"}
    assert "exit code -6" in lines["gmsh"]["found"] and "apt" in lines["dolfinx"]["hint"]
    assert lines["numba"]["state"] == "found"


def test_rigid_blocks_alone_are_well(monkeypatch):
    """Without FEniCSx the table says how to get it, and its engine is not checked."""
    monkeypatch.setattr(doctor, "PARTS", {"numba": "", "no_dolfinx_here": "pip install it"})
    monkeypatch.setattr(doctor, "PAIRS", {BLOCKS: "numba", ROCK: "no_dolfinx_here"})
    found = doctor.examine()
    (one,), missing = found["self_check"], found["parts"][1]
    assert one["pair"] == BLOCKS and one["holds"] and found["well"]
    assert (missing["state"], missing["hint"]) == ("missing", "pip install it")
    assert missing["found"] == "No module named 'no_dolfinx_here'"


def test_a_compiler_or_launcher_is_named_and_one_that_fails_too(tmp_path, monkeypatch):
    """dolfinx needs a compiler with Python's headers: a module is compiled as forms are."""
    found = look("C compiler")
    assert found["state"] == "found" and "cc" in found["found"].lower()
    monkeypatch.setenv("CC", "no-compiler-here")
    part = look("C compiler")
    assert part["state"] == "broken" and "no-compiler-here" in part["found"]
    assert "gcc" in part["hint"]
    monkeypatch.setenv("PATH", str(tmp_path))
    assert look("mpiexec")["state"] == "missing"
    launcher = tmp_path / "mpiexec"
    launcher.write_text("#!/bin/sh\necho no slots >&2\nexit 3\n")
    launcher.chmod(0o755)
    part = look("mpiexec")
    assert part["state"] == "broken" and "no slots (exit code 3)" in part["found"]
