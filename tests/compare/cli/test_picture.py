"""`jointwave picture`: a scene as it is drawn, and maps of results that `run` has written."""

import re
from pathlib import Path

import pytest
from PIL import Image

SCENE = "guo-li-2002/fig-07"
SHORT = ("--set", "pillar.length=10.0", "--set", "record.stress=[5.0]")
FIELDS = ("--set", "time.duration=0.01", "--set", "record.fields=1e-3", "--variant", "")


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def folder(jointwave):
    """Return a folder with results of both engines."""
    engines = ("--engine", "dem", "--engine", "continuum", "--model", "jointed")
    jointwave("run", SCENE, *SHORT, *FIELDS, *engines, "--out", "short")
    return "short"


def words_of(svg):
    return re.findall(r">([^<>]+)</text>", Path(svg).read_text(encoding="utf-8"))


def test_a_scene_is_drawn_with_its_variants(jointwave):
    assert jointwave("picture", SCENE, "--out", "a.svg").out == "wrote a.svg\n"
    words = words_of("a.svg")
    assert any("100 blocks of 0.5 m" in word for word in words)
    assert any("layer at y = 20 m, 875 MPa/m" in word for word in words)
    jointwave("picture", SCENE, "--variant", "", "--out", "b.svg")
    assert not any("layer at" in word for word in words_of("b.svg"))


def test_the_picture_is_called_as_the_scene_is(jointwave):
    assert jointwave("picture", "rock-mass/tunnel").out == "wrote tunnel.png\n"
    with Image.open("tunnel.png") as file:
        assert file.width == 1760


def test_results_are_drawn_side_by_side_with_their_difference(jointwave, folder):
    assert jointwave("picture", folder, "--map", "stress", "--out", "c.svg").out == "wrote c.svg\n"
    words = words_of("c.svg")
    assert {"rigid blocks", "jointed rock", "jointed rock − rigid blocks"} <= set(words)
    assert "axial stress (MPa), compression positive" in words and "difference (MPa)" in words
    assert jointwave("picture", folder).out == "wrote short-ppv.png\n"  # not as its scene
    assert jointwave("picture", f"{folder}/dem.nc", "--map", "speed").out == "wrote dem-speed.png\n"


def test_a_mistake_is_one_line(jointwave, folder):
    for arguments, said in (
        ((SCENE, "--map", "ppv"), "--map: is of results: `jointwave run guo-li-2002/fig-07 --set"),
        ((SCENE, "--out", "a.gif"), "--out: a.gif: must end in .pdf or .svg or .png"),
        (("xyz",), "xyz: is neither a file nor a shipped scene"),
        ((".",), ".: has no result of an engine, such as dem.nc"),
        ((folder, "--variant", "soft layer"), "are of a scene, not of a folder"),
        ((folder, "--map", "heat"), "map = 'heat': must be one of ppv, speed, stress, slip"),
        ((folder, "--map", "speed", "--time", "1"), "time = 1.0: must be from 0 to 0.01 s"),
    ):
        done = jointwave("picture", *arguments, code=2)
        assert said in done.err and done.err.count("\n") == 1 and not done.out
    assert not list(Path().glob("*.png"))
