"""The command as a user meets it: its files, its messages, its exit status."""

import json
import re
import subprocess
import sys

import pytest
import xarray as xr

from jointwave.compare.cli.explain import explanation
from jointwave.compare.cli.scene_files import starter

SCENE = "guo-li-2002/fig-03"
SHORT = ("--set", "time.duration=0.02")


def test_list_names_every_scene_with_its_variants(jointwave):
    """Shipped scenes can be used by the name that the list shows."""
    facts = {f["scene"]: f for f in json.loads(jointwave("list", "--json").out)}
    assert facts[SCENE]["variants"] and len(facts) >= 9


def test_run_writes_one_file_for_each_variant_and_model(jointwave, tmp_path):
    """DIR/[variant/]ENGINE[-MODEL].nc, each readable and labelled."""
    engines = (
        "--engine",
        "dem",
        "--engine",
        "continuum",
        "--engine",
        "exact",
        "--model",
        "lattice",
    )
    jointwave("run", SCENE, *engines, *SHORT, "--out", tmp_path)
    names = {"dem.nc", "continuum-jointed.nc", "continuum-equivalent.nc", "exact-lattice.nc"}
    assert {p.name for p in tmp_path.iterdir() if p.is_file()} == names
    assert {p.name for p in (tmp_path / "zeta 0.02").iterdir()} == names
    result = xr.load_dataset(tmp_path / "zeta 0.02" / "dem.nc")
    assert result.attrs["variant"] == "zeta 0.02" and result.sizes["time"] == 401


def test_run_reports_the_same_as_json(tmp_path):
    """--json gives a machine the table, and nothing else on the standard output of its process."""
    options = ("run", SCENE, "--variant", "", *SHORT, "--out", str(tmp_path), "--json")
    done = subprocess.run((sys.executable, "-m", "jointwave", *options), capture_output=True)
    (fact,) = json.loads(done.stdout)
    assert done.returncode == 0 and not done.stderr
    assert fact["engine"] == "dem" and fact["steps"] == 1200 and fact["energy_residual"] < 1e-10


def test_run_leaves_out_variants_that_an_engine_cannot_solve(jointwave, tmp_path):
    """Rigid blocks have no rock of a quality factor: a warning for each, an error for all."""
    scene = "beyond/constant-q"
    shown = jointwave("run", scene, "--set", "time.duration=1e-3", "--out", tmp_path)
    (said,) = (line for line in shown.err.splitlines() if "constant Q:" in line)
    assert said.startswith("jointwave: warning: constant Q: no dem: rock.quality_factor")
    assert {path.parent.name for path in tmp_path.rglob("dem.nc")} == {
        tmp_path.name,
        "dashpots",
        "dashpots, 1 kHz",
    }
    refused = jointwave("run", scene, "--variant", "constant Q", "--out", tmp_path, code=2)
    assert "rock.quality_factor is not supported by rigid blocks" in refused.err


def test_explain_says_what_is_left_out_and_why(jointwave):
    """Effects, critical steps and exact solutions, with the reason of each no."""
    facts = json.loads(jointwave("explain", SCENE, "--json").out)
    assert not facts["effects"]["dashpots"]["active"]
    assert facts["solutions"]["lattice"]["applies"]
    assert "tension" in facts["solutions"]["no-tension-chain"]["why_not"]
    reference = {"name": "jointed-bar", "reason": "deformable rock with every joint, exact"}
    assert facts["references"]["dem"] == reference
    assert {s["engine"] for s in facts["steps"]} == {
        "dem",
        "continuum-jointed",
        "continuum-equivalent",
    }


def test_explain_names_the_block_that_limits_the_step(pillar, jointwave):
    """The thinnest block of a tunnel's rock; none of a pillar whose blocks are alike."""
    said = jointwave("explain", "rock-mass/tunnel", "--variant", "no slip", "--json").out
    found = {one["engine"]: one for one in json.loads(said)["limits_the_step"]}
    assert found["dem"]["at"] == pytest.approx([22.2, 14.13], abs=0.01)
    for one in found.values():
        assert one["longer_step"] > 2 and one["size"] < 1
    assert not explanation(pillar())["limits_the_step"]


def test_explain_gives_the_critical_steps_of_motion_in_space(jointwave):
    """Of the blocks, and of the rock in the three dimensions that the blow asks for."""
    changes = ["--set", "pillar.length=4.0", "--set", "record.stress=[2.0]"]
    changes += ["--set", "record.velocity=[]", "--set", "numerics.continuum.elements_per_block=1"]
    facts = json.loads(jointwave("explain", "beyond/eccentric-blow", *changes, "--json").out)
    steps = {step["engine"]: step for step in facts["steps"]}
    assert steps.keys() == {"dem", "continuum-equivalent"}
    for step in steps.values():
        assert 0 < step["dt"] < step["critical"]
    assert facts["effects"]["spatial motion"]["active"]
    assert "intact_modulus" in facts["solutions"]["continuum-jointed"]["why_not"]
    assert facts["solutions"]["spatial-lattice"]["applies"]


def test_warning_is_a_line_on_standard_error(jointwave):
    """A questionable value gives one line of warning, and the answer is given nonetheless."""
    done = jointwave("explain", SCENE, "--set", "damping.local=0.3", "--json")
    assert done.err.count("\n") == 1
    assert done.err.startswith("jointwave: warning: damping.local")
    assert json.loads(done.out)["effects"]["local damping"]["active"]


def test_a_result_holds_what_was_warned_of(jointwave, tmp_path):
    """Each variant its own; a line that several say is printed once."""
    late = ("--set", "load.period=0.03", "--set", "joints.damping_ratio=0.02", *SHORT)
    (line,) = jointwave("run", "guo-li-2002/fig-09", *late, "--out", tmp_path).err.splitlines()
    for folder in (tmp_path, tmp_path / "no tension"):
        (kept,) = json.loads(xr.load_dataset(folder / "dem.nc").attrs["warnings"])
        assert line == f"jointwave: warning: {kept}" and kept.startswith("load.period = 0.03 s")


SLIPS = ("--set", "load.period=0.001", "--set", "rock.density=2.4")
STRICT = {
    "run": (SCENE,),
    "explain": (SCENE,),
    "compare": (SCENE,),
    "figure": (SCENE, "--out", "a.pdf"),
    "effects": (SCENE,),
    "plan": (SCENE, "--misfit", "0.1"),
    "animate": (SCENE,),
    "fit": (SCENE, "--with", "a.csv", "--free", "load.amplitude"),
    "picture": (SCENE, "--out", "a.png"),
    "view": (SCENE, "--out", "a.png"),
}


@pytest.mark.parametrize("command", STRICT)
def test_strict_refuses_what_is_warned_of(jointwave, command, tmp_path, monkeypatch):
    """Before anything is run or written, a line each."""
    monkeypatch.chdir(tmp_path)
    said = jointwave(command, *STRICT[command], *SLIPS, "--strict", code=2)
    first, second = said.err.splitlines()
    assert re.search(r"fig-03.toml: rock.density = 2.4 .*\(an error by --strict\)", first)
    assert "fig-03.toml: pillar.block" in second and "(an error by --strict)" in second
    assert said.out == "" and not list(tmp_path.iterdir())


def test_strict_refuses_a_sweep_and_a_page(jointwave, tmp_path):
    """The page takes only files; neither is run."""
    (tmp_path / "new.toml").write_text(starter("new.toml").replace("2400.0", "2.4"))
    for options in (
        ("run", SCENE, "--sweep", "load.period=0.01,0.001"),
        ("report", tmp_path / "new.toml"),
    ):
        assert "--strict" in jointwave(*options, "--strict", "--out", tmp_path / "out", code=2).err
        assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        (("explain", "fig-3"), "guo-li-2002/fig-03"),
        (("explain", "gou-li/fig-10"), "guo-li-2002/fig-10"),
        (("explain", "beyond/spal.toml"), "beyond/spall"),
        (("new", "a", "--from", "spall"), "beyond/spall"),
        (("explain", SCENE, "--set", "pillar.lenght=1"), "length"),
        (("explain", SCENE, "--set", "pilar.length=1"), "pillar"),
        (("explain", SCENE, "--variant", "zeta 0.2"), "zeta 0.02"),
        (("study", "dimension"), "dimensions"),
    ],
)
def test_a_name_that_is_unknown_is_told_the_nearest(jointwave, typed, meant):
    assert jointwave(*typed, code=2).err.endswith(f"; did you mean {meant}?\n")


def test_a_name_like_no_other_is_told_nothing(jointwave, tmp_path, monkeypatch):
    """But for a file of the folder that is called much the same."""
    monkeypatch.chdir(tmp_path)
    said = jointwave("explain", "nothing.toml", code=2).err
    assert "nothing.toml: cannot be read: No such file" in said
    (tmp_path / "pillar-of-mine.toml").touch()
    said = jointwave("explain", "pilar-of-mine.toml", code=2).err
    assert "did you mean pillar-of-mine.toml" in said


def test_run_tells_what_broke(jointwave, tmp_path):
    """How many joints broke and where the pieces fly, in words and as JSON."""
    options = ("beyond/spall", "--variant", "", "--out", tmp_path)
    (fact,) = json.loads(jointwave("run", *options, "--json").out)
    count = len(fact["fragments"]) - 1
    lines = jointwave("run", *options).out
    assert count > 2 and f"{count} joints broke" in lines
    strong = ("--variant", "strong joints", "--out", tmp_path)
    assert "no joints broke" in jointwave("run", "beyond/spall", *strong).out


def test_compare_tells_numerical_from_modelling_error(jointwave):
    """The chain is right as a chain, 4 % off the jointed bar and 18 % off the homogenised one."""
    done = jointwave("compare", SCENE, "--variant", "", "--json", "--no-spectral")
    (facts,) = json.loads(done.out)
    rows = facts["rows"]
    assert len(facts["energy_residual"]) == 3 and max(facts["energy_residual"].values()) < 1e-10
    found = {(r["one"], r["other"]): r for r in rows}
    assert found["dem", "lattice"]["misfit"] < 2e-3
    assert found["dem", "lattice"]["kind"] == "numerical error"
    assert found["dem", "jointed-bar"]["misfit"] == pytest.approx(0.040, abs=0.002)
    assert found["dem", "equivalent-bar"]["misfit"] == pytest.approx(0.179, abs=0.002)
    assert found["dem", "equivalent-bar"]["kind"] == "modelling error"


@pytest.mark.parametrize(
    "arguments, words",
    [
        (("run",), "Missing argument"),
        (("run", "nothing.toml"), "nothing.toml"),
        (("run", "fig-3"), "did you mean guo-li-2002/fig-03?"),
        (("run", SCENE, "--set", "pillar.length"), "key=value"),
        (("run", SCENE, "--set", "pillar.length=-1"), "pillar.length = -1"),
        (("run", SCENE, "--variant", "none"), "variants.name"),
        (("run", SCENE, "--engine", "fem"), "fem"),
        (("run", SCENE, "--model", "jointed"), "--model"),
        (("run", SCENE, "--engine", "exact", "--model", "no-tension-chain"), "tension"),
        (("run", SCENE, "--set", "numerics.dem.step_fraction=1.2"), "critical"),
        (("draw", SCENE), "draw"),
        (("explain", SCENE, "--bogus"), "--bogus"),
    ],
)
def test_mistake_is_one_line_and_exit_2(jointwave, arguments, words, tmp_path, monkeypatch):
    """No file is written, and no traceback is printed."""
    monkeypatch.chdir(tmp_path)
    done = jointwave(*arguments, code=2)
    assert done.err.count("\n") == 1 and words in done.err
    assert not list(tmp_path.iterdir())


def test_a_message_about_a_long_argument_is_short(jointwave, tmp_path):
    """Its beginning and its end are present, regardless of the text between them."""
    done = jointwave("run" + "x" * 50_000, SCENE, code=2)
    assert done.err.startswith("jointwave: No such command 'runxxx")
    assert done.err.count("\n") == 1 and len(done.err) < 1600 and " ... " in done.err


def test_instability_is_caught_with_exit_3_and_old_results_stay(jointwave, tmp_path):
    """A forced step that diverges leaves the earlier file unchanged, beside the valid part."""
    old = tmp_path / "dem.nc"
    jointwave("run", SCENE, "--variant", "", *SHORT, "--out", tmp_path)
    before = old.read_bytes()
    forced = [
        "numerics.dem.step_fraction=1.5",
        "numerics.dem.allow_unstable=true",
        "record.interval=1e-3",
        "time.duration=3.0",
    ]
    changes = [part for change in forced for part in ("--set", change)]
    done = jointwave("run", SCENE, "--variant", "", *changes, "--out", tmp_path, code=3)
    assert done.err.count("\n") == 1 and "critical" in done.err
    assert old.read_bytes() == before
    assert {path.name for path in tmp_path.iterdir()} == {"dem.nc", "dem.stopped.nc"}


def test_output_that_cannot_be_written_is_one_line(jointwave, tmp_path):
    """A file where the folder should be."""
    (tmp_path / "taken").write_text("x")
    done = jointwave("run", SCENE, *SHORT, "--out", tmp_path / "taken", code=2)
    assert done.err.count("\n") == 1 and "taken" in done.err


def test_run_reports_how_still_a_static_state_is(jointwave, tmp_path):
    """A pillar hangs within its tolerance; let go suddenly there is nothing to report."""
    held = ("--set", "gravity.direction=[0,1,0]", "--set", 'ends.end="fixed"', *SHORT, "--json")
    options = (SCENE, "--variant", "", "--out", tmp_path, *held)
    (hung,) = json.loads(jointwave("run", *options).out)
    (let_go,) = json.loads(jointwave("run", *options, "--set", "gravity.static=false").out)
    assert 0 <= hung["static_out_of_balance"] <= 1e-8
    assert let_go["static_out_of_balance"] is None


def test_rigid_block_run_imports_neither_dolfinx_nor_matplotlib(tmp_path):
    """A run of the rigid blocks pays for nothing that it does not use."""
    code = (
        "import sys; sys.argv = ['jointwave', 'run', %r, '--out', %r]\n"
        "from jointwave.compare.cli.program import main\n"
        "try: main()\n"
        "except SystemExit as end: assert end.code == 0, end.code\n"
        "heavy = {'dolfinx', 'matplotlib', 'petsc4py', 'gmsh', 'obspy', 'jinja2', 'shapely',\n"
        "         'jointwave.continuum'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    command = [sys.executable, "-c", code % (SCENE, str(tmp_path))]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_compare_writes_figure_curves_and_distances(jointwave, tmp_path):
    """The files named in the plugin's failure message: every curve, drawn and as numbers."""
    out = tmp_path / "out"
    jointwave("compare", SCENE, "--variant", "", *SHORT, "--no-spectral", "--out", out)
    assert {path.suffix for path in out.iterdir()} == {".svg", ".pdf", ".png", ".csv", ".nc"}
    assert all(path.stat().st_size > 1000 for path in out.iterdir())
    written = {path.stem for path in out.iterdir() if path.suffix != ".nc"}
    assert written == {"comparison", "comparison-misfits"}


def test_help_begins_with_what_one_does_first(jointwave):
    """First steps, then the commands in that order, each in one whole line."""
    out = jointwave("--help").out
    steps, _, commands = out.partition("\nCommands:\n")
    assert "First steps:\n    jointwave new my-scene" in steps
    names = [line.split()[0] for line in commands.splitlines()]
    assert names[:2] == ["new", "list"] and names[-1] == "doctor"
    assert "..." not in commands


def test_study_without_a_name_lists_them(jointwave):
    """With title and scene."""
    facts = {one["study"]: one for one in json.loads(jointwave("study", "--json").out)}
    assert facts["free-pillar"]["scene"] == SCENE and facts["stability"]["title"]
    assert "Work and precision on the free pillar" in jointwave("study").out


def test_help_and_version_go_to_standard_output(jointwave):
    """Every command has help, and no argument at all is a call for it."""
    assert jointwave("--version").out.startswith("jointwave 0.")
    assert jointwave().out == jointwave("--help").out
    for command in ("list", "run", "explain", "compare", "report"):
        assert command in jointwave("--help").out
        assert "--json" in jointwave(command, "--help").out
