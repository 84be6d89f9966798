"""`jointwave picture`, `animate` and `view`: scenes as they are drawn, maps of results that `run`
has written, films and pictures of both engines."""

import re
from pathlib import Path

import pytest
import xarray as xr
from imageio_ffmpeg import count_frames_and_secs
from PIL import Image

from jointwave.compare.scenes import SHIPPED

SCENE, LAYER = "guo-li-2002/fig-03", "guo-li-2002/fig-07"
SMALL = ("--set", "pillar.length=10", "--set", "record.stress=[5]", "--set", "time.duration=0.01")


@pytest.fixture
def folder(jointwave):
    engines = ("--engine", "dem", "--engine", "continuum", "--model", "jointed")
    fields = ("--variant", "", "--set", "record.fields=1e-3", "--out", "short")
    jointwave("run", LAYER, *SMALL, *fields, *engines)
    return "short"


def colours(file):
    """Return the colours of a picture of 1280 by 720, of which there are many."""
    with Image.open(file) as image:
        assert image.size == (1280, 720)
        found = image.getcolors(1_000_000)
    assert len(found) > 100
    return found


def test_a_scene_is_drawn_with_its_variants(jointwave, words_of):
    assert jointwave("picture", LAYER, "--out", "a.svg").out == "wrote a.svg\n"
    words = "\n".join(words_of("a.svg"))
    assert "100 blocks of 0.5 m" in words and "layer at y = 20 m, 875 MPa/m" in words
    jointwave("picture", LAYER, "--variant", "", "--out", "b.svg")
    assert "layer at" not in "\n".join(words_of("b.svg"))
    assert jointwave("picture", "rock-mass/tunnel").out == "wrote tunnel.png\n"
    with Image.open("tunnel.png") as file:
        assert file.width == 1760


def test_results_are_drawn_side_by_side_with_their_difference(jointwave, folder, words_of):
    assert jointwave("picture", folder, "--map", "stress", "--out", "c.svg").out == "wrote c.svg\n"
    assert {
        *("rigid blocks", "jointed rock", "jointed rock − rigid blocks"),
        *("axial stress (MPa), compression positive", "difference (MPa)"),
    } <= set(words_of("c.svg"))
    assert jointwave("picture", folder).out == "wrote short-ppv.png\n"  # not as its scene
    assert jointwave("picture", f"{folder}/dem.nc", "--map", "speed").out == "wrote dem-speed.png\n"
    done = jointwave("picture", folder, "--variant", "soft layer", code=2)
    assert "are of a scene, not of a folder" in done.err and not done.out
    stronger = ("--set", "load.amplitude=3e6", "--set", "record.fields=1e-3", "--out", folder)
    jointwave("run", LAYER, *SMALL, "--variant", "", *stronger)
    said, why = jointwave("picture", folder, code=2).err, "has results of two scenes, by load"
    assert said == f"jointwave: {folder}: {why}: name one of the files\n"
    for content in (b"", b"CDF", xr.Dataset({"a": 1.0}).to_netcdf()):
        Path(folder, "dem.nc").write_bytes(content)
        said = jointwave("picture", folder, code=2).err
        assert said == f"jointwave: {folder}/dem.nc: is damaged, or no result of `run`\n"


def test_animate_writes_a_film_of_both_engines(jointwave):
    options = ("--frames", 12, "--seconds", 1.5, "--out", "wave.mp4")
    said = jointwave("animate", SCENE, *SMALL, *options).out
    assert said.startswith("wave.mp4: rigid blocks and jointed rock, displacements × ")
    assert count_frames_and_secs("wave.mp4") == (12, 1.5)
    options = ("--variant", "zeta 0.02", "--frames", 3, "--scale", 500)
    said = jointwave("animate", SCENE, *SMALL, *options).out
    name = "fig-03-zeta-0.02.mp4"
    assert said == f"{name}: rigid blocks and jointed rock, displacements × 500\n"
    assert Path(name).is_file()


def test_animate_shows_one_engine_where_the_other_does_not_apply(jointwave):
    """Joints without tension: no intact rock is given, and a homogenised bar has no joints."""
    text = (SHIPPED / "guo-li-2002" / "fig-09.toml").read_text()
    Path("own.toml").write_text(re.sub("(?m)^intact_.*", "", text))
    options = ("--variant", "no tension", "--frames", 3, "--out", "wave.gif")
    said = jointwave("animate", "own.toml", *SMALL, *options).out
    assert "jointed rock is not shown: the jointed rock needs" in said
    with Image.open("wave.gif") as file:
        assert file.n_frames == 3 and file.size == (1280, 720)


def test_view_without_a_display_writes_a_picture(jointwave):
    """Another one of another quantity, from the results that the first has left."""
    done = jointwave("view", SCENE, *SMALL, "--time", "0.008")
    assert done.err == ""
    assert done.out.startswith("fig-03.png: rigid blocks and jointed rock, displacements × ")
    done = jointwave("view", SCENE, *SMALL, "--time", "0.008", "--map", "speed", "--out", "b.png")
    assert done.out.startswith("b.png: rigid blocks and jointed rock")
    assert colours("fig-03.png") != colours("b.png")


def test_view_of_a_rock_mass_shows_its_speed(jointwave):
    coarse = ("time.duration=0.01", "numerics.dem.block=4", "numerics.continuum.size=4")
    coarse = [part for one in coarse for part in ("--set", one)]
    said = jointwave("view", "rock-mass/one-joint", *coarse, "--variant", "", "--out", "mass.png")
    assert said.out.startswith("mass.png: rigid blocks")
    colours("mass.png")
