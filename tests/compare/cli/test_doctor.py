"""`jointwave doctor`: packages present, missing or broken, and whether the engines are correct."""

import json
import os
import sys
from math import nan

import pytest

from compare.cli.diagnostics import doctor
from compare.cli.diagnostics.accuracy import PAIRS, Check, bound_of, check
from compare.cli.diagnostics.components import PROBES
from compare.cli.diagnostics.doctor import Component, Health


@pytest.fixture
def broken(tmp_path, monkeypatch):
    """Return a function that puts a module of some source before all others of its name."""

    def put(name, source):
        (tmp_path / f"{name}.py").write_text(source)
        old = os.environ.get("PYTHONPATH", "")
        monkeypatch.setenv("PYTHONPATH", f"{tmp_path}{os.pathsep}{old}")

    return put


def found(parts, name):
    (part,) = [part for part in parts if part.part == name]
    return part


def test_everything_is_a_line_and_all_is_well_here(jointwave):
    """Every part that is looked at, both checks with their numbers, exit 0."""
    facts = json.loads(jointwave("doctor", "--json").out)
    assert facts["well"]
    lines = {part["part"]: part for part in facts["parts"]}
    assert (
        PROBES.keys() | {"jointwave", "mpiexec", "cores", "memory", "kernel cache"} == lines.keys()
    )
    assert lines["basix"]["state"] == lines["threads"]["state"] == "found"
    assert "rm -r" in lines["kernel cache"]["found"]
    for part in facts["parts"]:
        assert part["state"] in ("found", "missing", "broken") and part["found"]
        assert part["hint"] or part["state"] == "found"
    assert [one["pair"] for one in facts["self_check"]] == list(PAIRS)
    for one in facts["self_check"]:
        assert 0 < one["misfit"] <= one["bound"] == bound_of(one["pair"]) and one["holds"]


def test_a_check_measures_the_pair_that_it_names():
    """The lattice is 0.1 % from the blocks, the jointed bar 4 %: not within the same bound."""
    right = check(PAIRS[0])
    assert right.holds and right.misfit == pytest.approx(1e-3, rel=0.1)
    assert not right._replace(misfit=2 * right.bound).holds
    assert not right._replace(misfit=nan).holds


def test_what_breaks_is_a_line_and_fails_the_check_that_needs_it_alone(broken, jointwave):
    """An error, and an end of the process: what comes after them is looked at all the same, the
    check of the rock fails with the reason, exit 1, and the blocks are right."""
    broken("obspy", "raise RuntimeError('first line\\nsecond line')")
    broken("gmsh", "import os; os.abort()")
    broken("basix", "raise ImportError('libbasix.so: cannot open shared object file')")
    broken("pyvista", "raise OSError('libGL.so.1: cannot open shared object file')")
    facts = json.loads(jointwave("doctor", "--json", code=1).out)
    assert not facts["well"]
    blocks, rock = facts["self_check"]
    assert blocks["holds"] and not rock["holds"]
    assert rock["misfit"] is None and "libbasix.so" in rock["reason"]
    lines = {part["part"]: part for part in facts["parts"]}
    states = {name: line["state"] for name, line in lines.items() if line["state"] == "broken"}
    assert {"obspy", "gmsh", "basix", "pyvista"} <= states.keys()
    assert lines["obspy"]["found"] == "RuntimeError: first line second line"
    assert "signal 6" in lines["gmsh"]["found"] and lines["gmsh"]["hint"]
    assert "apt" in lines["basix"]["hint"]
    assert lines["numpy"]["state"] == "found" and "chromium" in lines


def test_rigid_blocks_alone_are_well(monkeypatch):
    """Without FEniCSx the table says how to get it, and its engine is not checked."""
    hint = PROBES["basix"].hint
    absent = Component("continuum", "basix", "missing", "is not installed", hint)
    monkeypatch.setattr(doctor, "_libraries", lambda: [absent])
    health = doctor.examine(lambda fraction: None)
    assert [one.pair for one in health.checks] == [PAIRS[0]] and health.is_well
    assert found(health.parts, "basix") == absent and "pip install" in hint


def test_no_launcher_and_one_that_starts_nothing(tmp_path, monkeypatch):
    """Neither on the PATH nor beside this Python, where pip's MPI has one."""
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(sys, "executable", str(tmp_path / "python"))
    assert doctor._mpiexec().state == "missing"
    launcher = tmp_path / "mpiexec"
    launcher.write_text("#!/bin/sh\necho no slots >&2\nexit 3\n")
    launcher.chmod(0o755)
    part = doctor._mpiexec()
    assert part.state == "broken" and "no slots (exit code 3)" in part.found


def test_ranks_are_those_that_see_each_other(mpiexec, monkeypatch):
    """As many as there are cores; outside the MPI job that the tests themselves have joined."""
    for name in os.environ.keys() - mpiexec[1].keys():
        monkeypatch.delenv(name)
    for name, value in mpiexec[1].items():
        monkeypatch.setenv(name, value)
    part = doctor._mpiexec()
    assert part.state == "found" and f"{min(doctor._cores(), 16)} ranks on" in part.found


def test_a_cache_that_cannot_be_written_is_told(monkeypatch):
    monkeypatch.setattr(doctor.os, "access", lambda place, mode: False)
    part = doctor._cache()
    assert part.state == "broken" and "NUMBA_CACHE_DIR" in part.hint


def test_a_bound_on_memory_that_is_none_is_a_line(monkeypatch):
    monkeypatch.setenv("JOINTWAVE_MEMORY", "much")
    assert found(doctor._machine(), "memory").state == "broken"


def test_what_takes_too_long_is_broken():
    done = doctor._run([sys.executable, "-c", "import time; time.sleep(9)"], 0.2)
    assert doctor._end(done) == "took more than 0.2 s (exit code 1)"


def test_it_is_shown_in_words(capsys):
    """Every part with its hint, and the verdict with its numbers or its reason."""
    from compare.cli.diagnostics.doctor import show_health

    parts = [Component("optional", "ffmpeg", "missing", "is not on the PATH", "apt install ffmpeg")]
    right = Check("a ~ b", 1e-3, 2e-3, 1.0)
    show_health(Health(parts, [right, Check("c ~ d", nan, 1e-2, nan, "it broke")]), False)
    said = capsys.readouterr().out
    assert "ffmpeg" in said and "apt install ffmpeg" in said
    assert "a ~ b: holds, relative L2 misfit 0.001, at most 0.002" in said
    assert "c ~ d: FAILS, it broke" in said and "a check fails" in said
