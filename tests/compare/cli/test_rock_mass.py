"""A rock mass on the command line: its blocks explained, and every other command refused."""

import io
import json
import sys
from contextlib import redirect_stderr, redirect_stdout
from unittest.mock import patch

import pytest

import jointwave
from compare.cli import completion
from compare.cli.program import main
from compare.experiments.study.study import shipped

SCENE = """\
title = "A tunnel in brickwork"
[domain]
size = [10.0, 6.0]
openings = [[[4.0, 2.0], [6.0, 2.0], [6.0, 4.0], [4.0, 4.0]]]
[rock]
density = 2600.0
intact_modulus = 5.0e10
[[joint_sets]]
name = "rows"
dip = 0.0
spacing = 1.0
normal_stiffness = 1.0e10
shear_stiffness = 4.0e9
[[joint_sets]]
name = "cross"
dip = 90.0
spacing = 2.0
ends_at = ["rows"]
normal_stiffness = 1.0e10
shear_stiffness = 4.0e9
[time]
duration = 0.1
[record]
points = [[1.0, 3.5]]
[expect]
"dem ~ lattice" = 1e-3
[[variants]]
name = "bonded"
joint_sets = []
domain.openings = []
[[variants]]
name = "shifted"
domain.openings = [[[3.0, 2.0], [6.0, 2.0], [6.0, 4.0], [3.0, 4.0]]]
domain.non_convex = "cut"
"""

COMMANDS = [
    "run mass.toml",
    "run mass.toml --dry-run",
    "run mass.toml --variant bonded",
    "run mass.toml --sweep domain.least_angle=1,2",
    "compare mass.toml",
    "compare mass.toml --sweep domain.least_angle=1,2",
    "figure mass.toml --out mass.svg",
    "fit mass.toml --free rock.density --with curve.csv",
    "plan mass.toml --misfit 0.01",
    "effects mass.toml",
    "report mass.toml --out page",
    "animate mass.toml",
    "view mass.toml",
    "new other --from mass.toml",
]


@pytest.fixture
def jointwave_says(tmp_path, monkeypatch):
    """Return a function that runs a command beside the scene: its exit code, output and errors."""
    (tmp_path / "mass.toml").write_text(SCENE)
    monkeypatch.chdir(tmp_path)

    def says(command):
        out, err = io.StringIO(), io.StringIO()
        with (
            patch.object(sys, "argv", ["jointwave", *command.split()]),
            redirect_stdout(out),
            redirect_stderr(err),
            pytest.raises(SystemExit) as end,
        ):
            main()
        return end.value.code, out.getvalue(), err.getvalue()

    return says


@pytest.mark.parametrize("command", COMMANDS)
def test_every_other_command_refuses_it_in_one_line(jointwave_says, tmp_path, command):
    code, out, err = jointwave_says(command)
    assert code == 2 and out == ""
    assert err.startswith("jointwave: mass.toml") and len(err.splitlines()) == 1
    assert "domain: is a rock mass, which no engine solves yet" in err
    assert [path.name for path in tmp_path.iterdir()] == ["mass.toml"]


def test_explain_says_what_its_blocks_are(jointwave_says):
    """30 bricks of 2 m2 less the two that the tunnel takes out, whole."""
    code, out, err = jointwave_says("explain mass.toml --json")
    assert code == 0 and err == ""
    facts = json.loads(out)
    assert (facts["blocks"], facts["area"]) == (28, 56.0)
    assert facts["smallest"]["area"] == facts["largest"]["area"] == 2.0
    assert facts["joint_sets"]["rows"] == {"contacts": 5 * 5 - 3, "length": 44.0}
    assert facts["joint_sets"]["cross"] == {"contacts": 6 * 4 - 4, "length": 20.0}
    assert facts["cuts_through_rock"]["contacts"] == 0
    assert facts["boundary"] == {"left": 6, "right": 6, "bottom": 5, "top": 5, "opening 0": 6}
    assert 0 < facts["bytes"] < facts["bytes_at_most"]


def test_explain_in_words(jointwave_says):
    code, out, err = jointwave_says("explain mass.toml")
    assert code == 0 and err == ""
    for words in (
        "A tunnel in brickwork",
        "28 blocks, 56 m2",
        "smallest block: 2 m2",
        "rows",
        "MB",
    ):
        assert words in out
    assert out.splitlines()[-1] == "no engine solves rock masses yet"


def test_explain_counts_cuts_through_rock(jointwave_says):
    """A tunnel that ends in the middle of bricks: those are cut along its faces."""
    _, out, _ = jointwave_says("explain mass.toml --variant shifted --json")
    facts = json.loads(out)
    assert facts["area"] == 54.0 and facts["variant"] == "shifted"
    assert "(cuts in rock)" not in jointwave_says("explain mass.toml --variant shifted")[1]
    triangle = "--set domain.openings=[[[3.0,2.5],[6.0,2.5],[5.0,3.5]]]"
    found = jointwave_says(f"explain mass.toml --variant shifted {triangle}")[1]
    assert "(cuts in rock)" in found


def test_explain_refuses_what_cannot_be_cut_in_one_line(jointwave_says):
    opening = "domain.openings=[[[3.0,2.5],[6.0,2.5],[5.0,3.5]]]"
    code, out, err = jointwave_says(f"explain mass.toml --set {opening}")
    assert code == 2 and out == "" and len(err.splitlines()) == 1
    assert err.startswith("jointwave: mass.toml: domain: a block is not convex")


def test_intact_rock_is_one_block(jointwave_says):
    _, out, _ = jointwave_says("explain mass.toml --variant bonded --json")
    facts = json.loads(out)
    assert (facts["blocks"], facts["area"], facts["joint_sets"]) == (1, 60.0, {})


def test_a_study_of_it_is_refused(jointwave_says, tmp_path):
    """The shipped study on a pillar with the scene exchanged."""
    lines = shipped()["damped"].read_text(encoding="utf-8").splitlines()
    changed = ['scene = "mass.toml"' if one.startswith("scene =") else one for one in lines]
    (tmp_path / "study.toml").write_text("\n".join(changed))
    code, out, err = jointwave_says("study study.toml")
    assert code == 2 and out == "" and len(err.splitlines()) == 1
    assert err.startswith("jointwave: mass.toml: domain: is a rock mass")


def test_the_python_interface_refuses_it(jointwave_says):
    with pytest.raises(jointwave.SceneError, match=r"mass\.toml: domain: is a rock mass"):
        jointwave.load("mass.toml")
    with pytest.raises(jointwave.SceneError, match=r"mass\.toml: domain: is a rock mass"):
        jointwave.load_variants("mass.toml")


def test_variants_are_completed(jointwave_says):
    class Asked:
        args, params = (), {"scene": "mass.toml"}

    assert completion.variants(Asked, "b") == ["bonded"]
