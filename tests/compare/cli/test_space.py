"""Commands on scenes in space: run by rigid blocks, refused in one line by all else that solves."""

import json
import re
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from PIL import Image

import jointwave as jw
from jointwave.cases.errors import SceneError
from jointwave.compare.figures.drawing import space

WALL = "rock-mass/masonry-wall"
SAID = "is of a scene in space: rigid blocks alone solve these yet, by jointwave run --engine dem"
SOLVING = {
    "run": ("--engine", "continuum"),
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


@pytest.mark.parametrize("solve", [jw.compare, jw.solvers])
def test_so_does_the_python_interface(solve):
    with pytest.raises(SceneError, match="rigid blocks alone solve these yet"):
        solve(WALL)


def test_rigid_blocks_run_the_wall(jointwave, tmp_path):
    """It stands under its weight; the pulse of the ground, 0.1 m/s, reaches its top, where friction
    has let blocks slide, and the ledger closes but for joints that open."""
    jointwave("run", WALL, "--engine", "dem", "--out", "out")
    with xr.open_dataset(tmp_path / "out" / "dem.nc") as found:
        assert found.attrs["blocks"] == 210 and list(found.axis.values) == ["x", "y", "z"]
        top = found.velocity.sel(point=0)
        assert 0.03 < abs(top.sel(axis="x")).max() < 0.2
        assert 0.04 < abs(top.sel(axis="y")).max() < 0.2
        energy = found.energy - found.energy.isel(time=0)
        assert energy.sel(term="friction")[-1] > 0
        left = energy.sum("term") - 2 * energy.sel(term="work")
        assert abs(left).max() < 1e-3 * energy.sel(term="work").max()


def test_waves_whose_field_is_not_known_are_refused(jointwave):
    free = "a side that sends them back, top, beside quiet ones"
    one = jointwave(
        "run", "rock-mass/cavern", "--engine", "dem", "--set", "boundaries.top=free", code=2
    )
    assert one.err.endswith(f"meet {free}: their field is not known in space yet\n")
    assert one.err.count("\n") == 1


def test_rigid_blocks_run_the_cavern(jointwave, tmp_path):
    """From the state after excavation, and by the wave in the medium of three joint sets: of half
    its amplitude over the impedance below, where it has not met the cavern."""
    jointwave("run", "rock-mass/cavern", "--engine", "dem", "--out", "out")
    with xr.open_dataset(tmp_path / "out" / "dem.nc") as found:
        assert found.attrs["blocks"] > 700 and found.attrs["static_out_of_balance"] < 1e-8
        below = found.velocity.sel(point=0)
        speed = abs(below.sel(axis="z")).max().item()
        assert 1e6 / (2650 * 6000) < speed < 2e6 / (2650 * 2000)
        assert abs(below.sel(axis=["x", "y"])).max() < 0.6 * speed
        energy = found.energy - found.energy.isel(time=0)
        left = energy.sum("term") - 2 * energy.sel(term="work")
        assert abs(left).max() < 1e-6 * energy.sel(term="work").max()


def test_a_report_leaves_it_out(jointwave):
    found = jointwave("report", WALL, "rock-mass/one-joint", "--dry-run")
    assert (
        found.err
        == f"jointwave: warning: {WALL} is left out, in space: rigid blocks alone solve these yet\n"
    )
    assert "12 would run" in found.out


def test_it_is_listed_with_a_remark(jointwave):
    facts = json.loads(jointwave("list", "--json").out)
    said = {
        one["scene"]
        for one in facts
        if one.get("remark") == "in space: rigid blocks alone solve these yet"
    }
    assert said == {"rock-mass/cavern", WALL}
    words = jointwave("list").out
    assert words.count("    in space: rigid blocks alone solve these yet\n") == 2


def test_explain_counts_its_blocks(jointwave):
    """10 courses of 10 and of 11 blocks, in two leaves; the smallest are half blocks."""
    words = jointwave("explain", WALL).out
    assert "blocks: 210\ncontacts: 655\nvolume (m³): 10.8\n" in words
    assert "smallest block: volume (m³) 0.027; width (m) 0.3" in words
    assert "in space: rigid blocks alone solve these yet" in words
    facts = json.loads(jointwave("explain", WALL, "--json").out)
    assert facts["joint_sets"]["bed"] == {"contacts": 360, "area": pytest.approx(9 * 3.6)}
    assert facts["effects"]["gravity"]["active"] and "steps" not in facts


OWN = """
title = "two bricks on one"
domain = { blocks = "bricks.obj" }
rock = { density = 2600.0, intact_modulus = 5e10 }
boundaries = { bottom = "fixed" }
gravity = {}
time = { duration = 6e-3 }
record = { points = [[0.5, 0.5, 1.5]] }

[[joint_sets]]
name = "bed"
dip = 0.0
normal_stiffness = 2e10
shear_stiffness = 8e9
"""


def test_so_are_blocks_of_a_file(jointwave, tmp_path):
    """Counted, drawn and run by rigid blocks; bricks of 1 and 2 m, 1 m deep."""
    lines, count = [], 0
    faces = ("1 4 3 2", "5 6 7 8", "1 2 6 5", "2 3 7 6", "3 4 8 7", "4 1 5 8")
    for left, right, low in ((0.0, 2.0, 0.0), (0.0, 1.0, 1.0), (1.0, 2.0, 1.0)):
        lines.append(f"o {count}")
        for z in (low, low + 1):
            for x, y in ((left, 0.0), (right, 0.0), (right, 1.0), (left, 1.0)):
                lines.append(f"v {x} {y} {z}")
        lines += ["f " + " ".join(str(count + int(k)) for k in face.split()) for face in faces]
        count += 8
    (tmp_path / "bricks.obj").write_text("\n".join(lines))
    (tmp_path / "own.toml").write_text(OWN)
    words = jointwave("explain", "own.toml").out
    assert "blocks: 3\ncontacts: 3\nvolume (m³): 4\n" in words
    assert "left 2; right 2; front 3; back 3; bottom 1; top 2" in words
    jointwave("picture", "own.toml", "--out", "own.svg")
    assert "2 × 1 × 2 m, 3 blocks" in words_of("own.svg")
    jointwave("run", "own.toml", "--engine", "dem", "--out", "out")
    with xr.open_dataset("out/dem.nc") as found:
        assert found.attrs["blocks"] == 3
    error = jointwave("compare", "own.toml", code=2).err
    assert error.endswith(f"own.toml: domain.blocks = 'bricks.obj': {SAID}\n")


def test_it_is_drawn(jointwave):
    """With the names of what is seen: joints where blocks are apart or cut open."""
    assert jointwave("picture", WALL, "--out", "a.svg").out == "wrote a.svg\n"
    words = words_of("a.svg")
    assert {"6 × 0.6 × 3 m, 210 blocks", "9.81 m/s²", "point"} <= words and "bed" not in words
    jointwave("picture", WALL, "--explode", "0.2", "--out", "b.svg")
    apart = "6 × 0.6 × 3 m, 210 blocks, moved apart by 0.2 of their distance"
    assert {"bed", "head", "collar", apart} <= words_of("b.svg")
    jointwave("picture", "rock-mass/cavern", "--out", "c.svg")
    assert {"opening", "cut open through the middle of the openings"} <= words_of("c.svg")


@pytest.mark.skipif(find_spec("pyvista") is None, reason="PyVista is not installed")
def test_it_looks_the_same_without_pyvista(jointwave, monkeypatch):
    """But for the edges of blocks, which are a tenth of their colour in 16 by 16 pixels."""
    jointwave("picture", WALL, "--explode", "0.2", "--out", "a.png")
    monkeypatch.setattr(space, "find_spec", lambda name: None)
    jointwave("picture", WALL, "--explode", "0.2", "--out", "b.png")
    pictures = (Image.open(name).convert("RGB").reduce(16) for name in ("a.png", "b.png"))
    one, other = (np.asarray(picture, float) for picture in pictures)
    assert one.shape == other.shape and np.ptp(one) > 100
    assert abs(one - other).max() < 40


def test_blocks_of_the_plane_are_not_moved_apart(jointwave):
    error = jointwave("picture", "rock-mass/tunnel", "--explode", "0.2", code=2).err
    assert error == "jointwave: --explode: is of a scene in space, not of rock-mass/tunnel\n"
    error = jointwave("picture", ".", "--explode", "0.2", code=2).err
    assert error == "jointwave: --explode: is of a scene in space, not of a folder\n"


def words_of(svg):
    return set(re.findall(r">([^<>]+)</text>", Path(svg).read_text(encoding="utf-8")))
