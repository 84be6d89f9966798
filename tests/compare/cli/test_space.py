"""Commands on scenes in space: shown by some, refused in one line by all that solve."""

import json

import pytest

import jointwave as jw
from jointwave.cases.errors import SceneError

WALL = "rock-mass/masonry-wall"
SAID = "is of a scene in space: no engine solves these yet; jointwave explain and picture show it"
SOLVING = {
    "run": (),
    "run in a sweep": ("--sweep", "rock.density=2000,2500"),
    "compare": (),
    "figure": ("--out", "a.png"),
    "view": (),
    "animate": (),
    "report": (),
    "plan": ("--misfit", "0.1"),
    "effects": (),
    "fit": ("--with", "a.csv", "--free", "rock.density"),
}


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("command", SOLVING)
def test_what_solves_refuses_a_scene_in_space(jointwave, tmp_path, command):
    """In one line, before anything is computed or written."""
    error = jointwave(command.split()[0], WALL, *SOLVING[command], code=2).err
    assert error.endswith(f"masonry-wall.toml: domain.size = [6.0, 0.6, 3.0]: {SAID}\n")
    assert error.count("\n") == 1 and not list(tmp_path.iterdir())


@pytest.mark.parametrize("solve", [jw.simulate, jw.compare, jw.solvers])
def test_so_does_the_python_interface(solve):
    with pytest.raises(SceneError, match="no engine solves these yet"):
        solve(WALL)


def test_a_report_leaves_it_out(jointwave):
    found = jointwave("report", WALL, "rock-mass/one-joint", "--dry-run")
    assert (
        found.err
        == f"jointwave: warning: {WALL} is left out, in space: no engine solves these yet\n"
    )
    assert "12 would run" in found.out


def test_it_is_listed_with_a_remark(jointwave):
    facts = json.loads(jointwave("list", "--json").out)
    said = {
        one["scene"] for one in facts if one.get("remark") == "in space: no engine solves these yet"
    }
    assert said == {"rock-mass/cavern", WALL}


def test_explain_counts_its_blocks(jointwave):
    """10 courses of 10 and of 11 blocks, in two leaves; the smallest are half blocks."""
    words = jointwave("explain", WALL).out
    assert "blocks: 210\ncontacts: 655\nvolume (m³): 10.8\n" in words
    assert "smallest block: volume (m³) 0.027; width (m) 0.3" in words
    assert "in space: no engine solves these yet" in words
    facts = json.loads(jointwave("explain", WALL, "--json").out)
    assert facts["joint_sets"]["bed"] == {"contacts": 360, "area": pytest.approx(9 * 3.6)}
    assert facts["effects"]["gravity"]["active"] and "steps" not in facts
