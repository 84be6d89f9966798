"""What the README shows is true: its scene runs, meets its own bounds, and its Python works."""

import os
import re
import shlex
from pathlib import Path

import pytest

from jointwave import cases
from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.studies.findings import judged, orders
from jointwave.compare.studies.study import load
from jointwave.compare.studies.work_precision import experiment

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text(encoding="utf-8")
STUDY = (ROOT / "docs" / "how-to" / "study.md").read_text(encoding="utf-8")


def blocks(language, text=README):
    """Return the code blocks of this language."""
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


@pytest.fixture
def scene_file(tmp_path):
    """Return the README's scene as a file."""
    path = tmp_path / "my-scene.toml"
    path.write_text(blocks("toml")[0], encoding="utf-8")
    return path


def test_scene_meets_its_own_expectations(scene_file):
    """Every variant and pair of the README's scene."""
    scenes = cases.load(scene_file)
    assert [scene.name for scene in scenes] == ["", "no layer"]
    for scene in scenes:
        for pair, bound in scene.expect.items():
            one, other = (solve(name, scene) for name in pair.split(" ~ "))
            assert misfit(one, other) <= bound


def test_study_runs_on_its_scene(scene_file):
    """That of the guide to studies: every point is done, at the order that it says."""
    path = scene_file.with_name("my-study.toml")
    path.write_text(blocks("toml", STUDY)[0], encoding="utf-8")
    study = load(str(path))
    rows = experiment(study, scene_file.parent / "points").rows()
    assert [row["state"] for row in rows] == ["done"] * 3
    (order,) = orders(study, judged(rows))
    assert order.measured == pytest.approx(order.theory, abs=0.1)


def test_python_prints_what_it_says(scene_file, capsys, monkeypatch):
    """The snippet, run where the scene is."""
    monkeypatch.chdir(scene_file.parent)
    exec(compile(blocks("python")[0], "README.md", "exec"), {})
    said = capsys.readouterr().out
    assert 0 < float(said.split()[0]) < 0.02
    assert (scene_file.parent / "waveforms.png").stat().st_size > 10_000


def test_numbers_of_the_free_pillar(pillar):
    """The table: 0.1, 4.0 and 17.9 %, to the digits given."""
    scene = pillar()
    dem = solve("dem", scene)
    for name, percent in (("lattice", 0.1), ("jointed-bar", 4.0), ("equivalent-bar", 17.9)):
        assert f"`{name}`" in README and f"{percent} %" in README
        assert 100 * misfit(dem, solve(name, scene)) == pytest.approx(percent, abs=0.05)


def test_commands_exist(modules_of):
    """Every line that begins with the program's name, with its options."""
    commands = modules_of(ROOT / "tools" / "docs")("commands")
    known, lines = commands.all_commands(), re.findall(r"^    jointwave (.*)$", README, re.M)
    assert len(lines) > 5
    for line in lines:
        name, *rest = shlex.split(line, comments=True)
        assert {word for word in rest if word[:2] == "--"} <= set(commands.options(known[name]))


@pytest.mark.slow
def test_the_first_picture_is_made_by_its_commands(jointwave, tmp_path, monkeypatch):
    """Both lines below it, run as they stand."""
    monkeypatch.chdir(tmp_path)
    for line in re.findall(r"^    jointwave ((?:run|picture) .*tunnel)$", README, re.M):
        jointwave(*shlex.split(line))
    assert (tmp_path / "tunnel.png").stat().st_size > 50_000


def test_pictures_and_pages_that_it_links_are_there():
    """No dead link into the project."""
    for link in re.findall(r"\]\(([^)h][^)]*)\)", README):
        assert os.path.exists(ROOT / link), link


def test_it_is_read_in_one_go():
    assert README.count("\n") <= 120
