"""The command as a user meets it: its files, its messages, its exit status."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from jointwave.compare.cli.explain import explanation
from jointwave.compare.cli.scene_files import starter

SCENE = "guo-li-2002/fig-03"
SHORT = ("--set", "time.duration=0.02")
BASE = (SCENE, "--variant", "")


@pytest.fixture
def facts(jointwave):
    return lambda *arguments: json.loads(jointwave(*arguments, "--json").out)


def test_scenes_and_studies_are_listed(jointwave, facts):
    scenes = {f["scene"]: f for f in facts("list")}
    assert scenes[SCENE]["variants"] and len(scenes) >= 9
    studies = {one["study"]: one for one in facts("study")}
    assert studies["free-pillar"]["scene"] == SCENE and studies["stability"]["title"]
    assert "Work and precision on the free pillar" in jointwave("study").out


def test_run_writes_one_file_for_each_variant_and_model(jointwave):
    """DIR/[variant/]ENGINE[-MODEL].nc, each readable and labelled."""
    engines = [part for name in ("dem", "continuum", "exact") for part in ("--engine", name)]
    jointwave("run", SCENE, *engines, "--model", "lattice", *SHORT, "--out", "out")
    names = {"dem.nc", "continuum-jointed.nc", "continuum-equivalent.nc", "exact-lattice.nc"}
    assert {p.name for p in Path("out").iterdir() if p.is_file()} == names
    assert {p.name for p in Path("out/zeta 0.02").iterdir()} == names
    result = xr.load_dataset("out/zeta 0.02/dem.nc")
    assert result.attrs["variant"] == "zeta 0.02" and result.sizes["time"] == 401


def test_run_reports_the_same_as_json():
    """--json gives a machine the table, and nothing else on the standard output of its process."""
    options = ("run", *BASE, *SHORT, "--out", "out", "--json")
    done = subprocess.run((sys.executable, "-m", "jointwave", *options), capture_output=True)
    (fact,) = json.loads(done.stdout)
    assert done.returncode == 0 and not done.stderr
    assert fact["engine"] == "dem" and fact["steps"] == 1200 and fact["energy_residual"] < 1e-10


def test_a_file_may_have_a_name_that_is_no_text():
    """Bytes that are no UTF-8, as of an old disk; dolfinx looks at the arguments of its process."""
    name = os.fsdecode(b"caf\xe9.toml")
    Path(name).write_text(starter("x.toml"))
    done = subprocess.run((sys.executable, "-m", "jointwave", "explain", name), capture_output=True)
    assert (done.returncode, done.stderr) == (0, b"")


def test_run_leaves_out_variants_that_an_engine_cannot_solve(jointwave):
    """Rigid blocks have no rock of a quality factor: a warning for each, an error for all."""
    scene = "beyond/constant-q"
    shown = jointwave("run", scene, "--set", "time.duration=1e-3", "--out", "out")
    (said,) = (line for line in shown.err.splitlines() if "constant Q:" in line)
    assert said.startswith("jointwave: warning: constant Q: no dem: rock.quality_factor")
    folders = {path.parent.name for path in Path("out").rglob("dem.nc")}
    assert folders == {"out", "dashpots", "dashpots, 1 kHz"}
    refused = jointwave("run", scene, "--variant", "constant Q", "--out", "out", code=2)
    assert "rock.quality_factor is not supported by rigid blocks" in refused.err


def test_explain_says_what_is_left_out_and_why(facts):
    found = facts("explain", SCENE)
    assert not found["effects"]["dashpots"]["active"]
    assert found["solutions"]["lattice"]["applies"]
    assert "tension" in found["solutions"]["no-tension-chain"]["why_not"]
    reference = {"name": "jointed-bar", "reason": "deformable rock with every joint, exact"}
    assert found["references"]["dem"] == reference
    engines = ["dem", "continuum-jointed", "continuum-equivalent"]
    assert [step["engine"] for step in found["steps"]] == engines


def test_explain_names_the_block_that_limits_the_step(pillar, facts):
    said = facts("explain", "rock-mass/tunnel", "--variant", "no slip")
    found = {one["engine"]: one for one in said["limits_the_step"]}
    assert found["dem"]["at"] == pytest.approx([22.2, 14.13], abs=0.01)
    for one in found.values():
        assert one["longer_step"] > 2 and one["size"] < 1
    assert not explanation(pillar())["limits_the_step"]


def test_explain_says_what_segments_are_and_transmit(pillar):
    """A rock mass of wave speeds alone has joints, which take all of its compliance."""
    fast = {"y": [25.0, 50.0], "density": 2700.0, "p_speed": 4000.0, "s_speed": 2300.0}
    slow, quick = explanation(pillar(rock__intact_modulus=None, segments=[fast]))["segments"]
    assert slow["has_joints"] and quick["has_joints"]
    rho, p, s = np.transpose([(2400.0, 2200.0, 800.0), (2700.0, 4000.0, 2300.0)])
    # E = mu (3 lambda + 2 mu) / (lambda + mu), by the squares of the speeds
    moduli = rho * s**2 * (3 * p**2 - 4 * s**2) / (p**2 - s**2)
    assert [one["joint_stiffness"] for one in (slow, quick)] == pytest.approx(moduli / 0.5)
    z, other = np.sqrt(rho * moduli)
    assert quick["transmission"] == pytest.approx(2 * other / (z + other))


def test_a_result_holds_what_was_warned_of(jointwave):
    """Each variant its own; a line that several say is printed once, on standard error, and one of
    a later variant alone behind its name."""
    late = ("--set", "load.period=0.03", "--set", "joints.damping_ratio=0.02", *SHORT)
    (line,) = jointwave("run", "guo-li-2002/fig-09", *late, "--out", "out").err.splitlines()
    for folder in ("out", "out/no tension"):
        (kept,) = json.loads(xr.load_dataset(f"{folder}/dem.nc").attrs["warnings"])
        assert line == f"jointwave: warning: {kept}" and kept.startswith("load.period = 0.03 s")
    jointwave("new", "two", "--from", "guo-li-2002/fig-09")
    with Path("two.toml").open("a") as file:
        file.write('\n[[variants]]\nname = "late"\nload.period = 0.04\n')
    said = jointwave("run", "two.toml", "--dry-run", *SHORT).err
    assert "jointwave: warning: late: load.period = 0.04 s" in said


def test_run_tells_what_broke(jointwave, facts):
    options = ("run", "beyond/spall", "--out", "out", "--variant", "")
    (fact,) = facts(*options)
    count = len(fact["fragments"]) - 1
    assert count > 2 and f"{count} joints broke" in jointwave(*options).out


def test_instability_is_caught_with_exit_3_and_old_results_stay(jointwave, caplog):
    """A forced step that diverges leaves the earlier file unchanged, beside the valid part."""
    run, old = ("run", *BASE, "--out", "out"), Path("out/dem.nc")
    jointwave(*run, *SHORT)
    before = old.read_bytes()
    forced = ("numerics.dem.step_fraction=1.5", "numerics.dem.allow_unstable=true")
    forced += ("record.interval=1e-3", "load.period=0.02", "time.duration=3.0")
    changes = [part for one in forced for part in ("--set", one)]
    done = jointwave(*run, *changes, code=3)
    assert done.err.count("\n") == 1 and "critical" in done.err
    assert old.read_bytes() == before
    assert {path.name for path in Path("out").iterdir()} == {"dem.nc", "dem.stopped.nc"}
    changes += ("--set", 'expect."dem ~ lattice"=1')  # as in a file
    done = jointwave("compare", *BASE, *changes)
    assert caplog.text.count("warning: dem is left out: ") == 1 and "jointed rock" in done.out


def test_compare_writes_figure_curves_and_distances(jointwave):
    jointwave("compare", *BASE, *SHORT, "--no-spectral", "--out", "out")
    written = [*Path("out").iterdir()]
    assert {path.suffix for path in written} == {".svg", ".pdf", ".png", ".csv", ".nc"}
    assert all(path.stat().st_size > 1000 for path in written)
    stems = {path.stem for path in written if path.suffix != ".nc"}
    assert stems == {"comparison", "comparison-misfits"}


def test_help_begins_with_what_one_does_first(jointwave):
    """First steps, then the commands in that order, each in one line. No argument asks for it."""
    out = jointwave("--help").out
    assert jointwave("--version").out.startswith("jointwave 0.") and jointwave().out == out
    steps, _, commands = out.partition("\nCommands:\n")
    assert "First steps:\n    jointwave new my-scene" in steps and "..." not in commands
    names = [line.split()[0] for line in commands.splitlines()]
    assert names[:2] == ["new", "list"] and names[-1] == "doctor"
    assert {"run", "explain", "compare", "report"} < set(names)
    assert "--json" in jointwave("report", "--help").out
