"""Commands read what an earlier one has computed, and nothing else."""

import json
import re

import pytest

from jointwave.compare.runs.checkpoint import signature

SCENE = "guo-li-2002/fig-03"
SHORT = ("--variant", "", "--set", "time.duration=0.01", "--set", "pillar.length=10")
AT = ("--set", "record.stress=[5]", "--set", "record.velocity=[]")
BOTH = ("--engine", "dem", "--engine", "continuum", "--model", "jointed")


@pytest.fixture
def lines(jointwave, monkeypatch, tmp_path, without_warnings):
    """Return a function that runs a command on a short scene, whose results are in its `folder`,
    and gives what it says of them. Its `facts` are those of --json."""
    monkeypatch.setenv("JOINTWAVE_PROGRESS", "1000")
    folder = tmp_path / "results"

    def call(command, *options):
        where = ("--out" if command == "run" else "--results", folder)
        return jointwave(command, SCENE, *SHORT, *AT, *where, *options)

    def run(command, *options):
        said = without_warnings(call(command, *options).err)
        told = [line for line in said if "compiling" not in line]
        return [line.replace(f"{folder}/", "") for line in told]

    run.folder, run.facts = folder, lambda *asked: json.loads(call(*asked, "--json").out)
    return run


def stamps(folder):
    return {path.name: path.stat().st_mtime_ns for path in folder.glob("*.nc")}


def test_second_command_solves_nothing(lines):
    """Of `run`, `compare` and `figure`; what they answer is the same, misfit by misfit. What would
    be read is foretold; --fresh computes anew."""
    assert lines("run", *BOTH) == []
    before = stamps(lines.folder)
    assert set(before) == {"dem.nc", "continuum-jointed.nc"}
    first, second = lines("run", *BOTH)
    assert first.startswith("jointwave: reads dem.nc, computed on 20")
    assert first.endswith(" s; --fresh computes anew") and "reads continuum-jointed.nc" in second
    foretold = lines.facts("compare", "--dry-run")
    assert foretold["read"] == 2
    assert not {"dem", "continuum-jointed"} & {run["engine"] for run in foretold["runs"]}
    (line,) = lines("compare", "--all")
    assert "reads dem.nc, continuum-jointed.nc, computed on" in line
    full = stamps(lines.folder)
    assert full.items() >= before.items() and "exact-jointed-bar.nc" in full
    figure = ("--engine", "dem", "--out", lines.folder / "a.svg")
    assert "reads dem.nc, computed" in lines("figure", *figure)[0]
    assert stamps(lines.folder) == full
    computed = lines.facts("compare", "--fresh")
    assert lines.facts("compare") == computed
    assert min(stamps(lines.folder)[name] - full[name] for name in before) > 0


@pytest.mark.parametrize(
    ("change", "why"),
    [
        ("load.amplitude=2e6", "is from another scene"),
        ("numerics.dem.step_fraction=0.04", "is from another scene"),
        ("record.energy=false", "is from another [record] table"),
        ("numerics.continuum.order=1", ""),
        ("numerics.dem.threads=2", ""),
    ],
)
def test_what_decides_numbers_decides_whether_a_result_is_read(change, why, lines):
    lines("run")
    before = stamps(lines.folder)
    (line,) = lines("run", "--set", change)
    if why:
        assert line.startswith(f"jointwave: computes dem.nc anew: it {why}; others for this")
    else:
        assert "reads dem.nc" in line
    assert (stamps(lines.folder) == before) == (not why)


def test_another_program_computes_anew(lines, monkeypatch):
    """Said once of two results, by two engines."""
    lines("run", *BOTH)
    for command, program in ((("run", *BOTH), "other"), (("compare",), "a third")):
        monkeypatch.setattr(signature, "program", lambda program=program: program)
        (line,) = lines(*command)
        assert "computes dem.nc anew: it is from another program; others" in line


@pytest.mark.parametrize(
    "damage, why",
    [
        (lambda whole: whole[:-4000] + bytes([whole[-4000] ^ 1]) + whole[-3999:], "is damaged"),
        (lambda whole: whole[:-4000], "is damaged"),
        (lambda whole: whole.replace(b"signature", b"signaturf"), "does not say what computed it"),
    ],
)
def test_damaged_result_is_computed_anew(damage, why, lines):
    """A bit in the middle of the samples too: NetCDF has no checksum."""
    lines("run")
    path = lines.folder / "dem.nc"
    path.write_bytes(damage(path.read_bytes()))
    assert f"computes dem.nc anew: it {why}; others" in lines("compare")[0]
    assert "reads dem.nc" in lines("run")[0]


def test_film_and_view_share_their_snapshots(lines):
    """By default both have 201 instants; a scene's own snapshots serve for both."""
    film = ("--out", lines.folder / "a.gif", "--frames", 11)
    options = ("--set", "record.fields=1e-3")
    assert lines("animate", *film) == []
    assert "reads dem-snapshots.nc, continuum-jointed-snapshots.nc" in lines("animate", *film)[0]
    lines("run", *BOTH, *options)
    film = ("--out", lines.folder / "a.gif")
    for command in (("animate", *film), ("view", "--out", lines.folder / "a.png")):
        assert "reads dem.nc, continuum-jointed.nc" in lines(*command, *options)[0]


def test_folder_that_cannot_be_written_costs_the_reuse_alone(lines, jointwave):
    lines.folder.write_text("a file")
    assert lines("compare") == [f"jointwave: results are not stored: {lines.folder}: File exists"]
    said = jointwave("run", SCENE, "--fresh", "--resume", code=2).err
    assert said.endswith("what --resume would continue: give one of them\n")


@pytest.mark.parametrize("command", ["run", "compare"])
def test_a_sweep_is_computed_anew_on_request_alone(command, jointwave, tmp_path):
    """And what it then stores is read by the next one."""
    sweep = (command, SCENE, *SHORT, *AT, "--sweep", "joints.damping_ratio=0.1,0.2")
    sweep += ("--workers", 1, "--out", tmp_path)
    written = []
    for options in ((), (), ("--fresh",), ()):
        jointwave(*sweep, *options)
        written.append([path.stat().st_mtime_ns for path in sorted(tmp_path.glob("*/dem.nc"))])
    first, again, fresh, last = written
    assert len(first) == 2 and first == again and fresh == last
    assert all(new > old for new, old in zip(fresh, first, strict=True))


OWN = """
title = "a short pillar of rigid blocks"
pillar = { length = 5.0, side = 0.5, block = 0.5 }
rock = { density = 2400.0, p_speed = 2200.0, s_speed = 800.0 }
load = { shape = "ricker", amplitude = 1e6, period = 0.01 }
time = { duration = 0.03 }
record = { stress = [2.0] }
"""


def test_a_report_says_what_it_reads(jointwave, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("JOINTWAVE_PROGRESS", "1000")
    (tmp_path / "own.toml").write_text(OWN)
    assert "jointwave: reads" not in jointwave("report", "own.toml").err
    said = jointwave("report", "own.toml").err
    (line,) = [line for line in said.splitlines() if line.startswith("jointwave: reads")]
    assert re.fullmatch(r"jointwave: reads \d+ results of own, computed in .* s; --fresh .*", line)
