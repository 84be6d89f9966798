"""`jointwave doctor`: packages present, missing or broken, and whether the engines are correct."""

import json
import os
import sys
from math import isnan, nan

import pytest

from jointwave.compare.cli import doctor
from jointwave.compare.cli.doctor import PAIRS, PARTS, Check, Part, check, show_health

BLOCKS, ROCK = PAIRS
FOUND = Part("numba", "found", "0.61")


@pytest.fixture
def broken(tmp_path, monkeypatch):
    """Return a function that puts a module of some source before all others of its name."""

    def put(name, source):
        (tmp_path / f"{name}.py").write_text(source)
        monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)

    return put


def test_everything_is_a_line_and_all_is_well_here(jointwave):
    """Every part that is looked at, both checks with their numbers, exit 0."""
    facts = json.loads(jointwave("doctor", "--json").out)
    assert facts["well"] and facts["kernel_cache"]
    assert [part["part"] for part in facts["parts"]] == [*PARTS, "mpiexec"]
    for part in facts["parts"]:
        assert part["state"] in ("found", "missing", "broken") and part["found"]
        assert bool(part["hint"]) == (part["state"] != "found")
    assert [one["pair"] for one in facts["self_check"]] == [BLOCKS, ROCK]
    for one in facts["self_check"]:
        assert 0 < one["misfit"] <= one["bound"] and one["holds"]


def test_a_check_measures_the_pair_that_it_names():
    """The lattice is 0.1 % from the blocks, the jointed bar 4 %: not within the same bound."""
    right = check(BLOCKS, FOUND)
    assert right.holds and right.misfit == pytest.approx(1e-3, rel=0.1)
    assert not right._replace(misfit=2 * right.bound).holds
    assert not right._replace(misfit=nan).holds


def test_what_breaks_is_a_line_and_fails_the_check_that_needs_it_alone(broken, jointwave):
    """An error, and an end of the process; the check of the rock fails with the reason, exit 1, and
    the blocks are right."""
    broken("obspy", "raise RuntimeError('first line\\nsecond line')")
    broken("gmsh", "import os; os.abort()")
    broken("basix", "raise ImportError('libbasix.so: cannot open shared object file')")
    facts = json.loads(jointwave("doctor", "--json", code=1).out)
    blocks, rock = facts["self_check"]
    assert not facts["well"] and blocks["holds"] and not rock["holds"]
    assert rock["misfit"] is None and "libbasix.so" in rock["reason"]
    lines = {part["part"]: part for part in facts["parts"]}
    assert {lines[name]["state"] for name in ("obspy", "gmsh", "basix")} == {"broken"}
    assert "exit code -6" in lines["gmsh"]["found"] and "apt" in lines["basix"]["hint"]
    assert lines["numpy"]["state"] == "found"


def test_rigid_blocks_alone_are_well(monkeypatch):
    """Without FEniCSx the table says how to get it, and its engine is not checked."""
    parts = {"numba": PARTS["numba"], "basix": ("no_basix_here", "1", "pip install it")}
    monkeypatch.setattr(doctor, "PARTS", parts)
    found, (one,) = doctor.examine(lambda fraction: None)
    assert one.pair == BLOCKS and one.holds
    assert found[1] == Part("basix", "missing", "No module named 'no_basix_here'", "pip install it")


def test_no_launcher_and_one_that_starts_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr(doctor, "PARTS", {name: PARTS[name] for name in ("numba", "basix")})
    monkeypatch.setattr(doctor, "PAIRS", {})
    assert doctor.examine(print)[0][-1].state == "missing"
    launcher = tmp_path / "mpiexec"
    launcher.write_text("#!/bin/sh\necho no slots >&2\nexit 3\n")
    launcher.chmod(0o755)
    part = doctor.examine(print)[0][-1]
    assert part.state == "broken" and "no slots (exit code 3)" in part.found


def test_what_takes_too_long_is_broken(monkeypatch):
    monkeypatch.setattr(doctor, "PATIENCE", 0.2)
    monkeypatch.setitem(PARTS, "numpy", ("time", "module.sleep(9)", "wait"))
    assert doctor.look("numpy") == Part("numpy", "broken", "took more than 0.2 s", "wait")


def test_it_is_shown_in_words(capsys):
    """Every part with its hint, and the verdict with its numbers or its reason."""
    parts = [Part("ffmpeg", "missing", "is not on the PATH", "apt install ffmpeg")]
    wrong = check(ROCK, Part("basix", "broken", "it broke"))
    assert isnan(wrong.misfit)
    show_health(parts, [Check("a ~ b", 1e-3, 2e-3, 1.0), wrong], False)
    said = capsys.readouterr().out
    assert sys.executable in said and "is not on the PATH; apt install ffmpeg" in said
    assert "a ~ b: holds, misfit 0.001, at most 0.002" in said
    assert f"{ROCK}: FAILS, basix: it broke" in said and "a check fails" in said
