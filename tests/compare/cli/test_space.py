"""Commands on scenes in space, which both engines and the exact solutions of plane waves solve."""

import json
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from PIL import Image, ImageSequence

from jointwave.compare.figures.drawing import space
from jointwave.compare.report import sections
from jointwave.results.dataset import energy_residual

WALL = "rock-mass/masonry-wall"
ROCKS = ("--set", "loads.0.amplitude=0.1", "--set", "time.duration=0.4")
FIELDS = ("--set", "record.fields=3e-3")


@pytest.fixture(autouse=True)
def column(here, one_joint, in_toml):
    """A column of two blocks, 2 m high, that a P wave of 8 to 20 m goes through."""
    sides = dict.fromkeys(("left", "right", "front", "back"), "roller")
    tables = one_joint(
        domain={"size": [1.0, 1.0, 2.0]},
        rock={"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.2},
        boundaries=sides | {"bottom": "quiet", "top": "quiet"},
        time={"duration": 1.2e-2},
        numerics={"continuum": {"size": 1.0}},
        record={"points": [[0.3, 0.3, 0.5], [0.3, 0.3, 1.5]], "joints": [[0.5, 0.5, 1.0]]},
        expect={"continuum-jointed ~ oblique-joint": 0.01},
    )
    law = {"spacing": 1.0, "normal_stiffness": 2e10, "shear_stiffness": 8e9}
    tables["joint_sets"][0] |= law | {"dip": 0.0, "through": [0.0, 0.0, 1.0]}
    tables["waves"][0] |= {"direction": [0, 0, 1], "period": 6e-3}
    Path("column.toml").write_text(in_toml(tables))


def test_compare_judges_both_engines_by_the_exact_solution(jointwave):
    (found,) = json.loads(jointwave("compare", "column.toml", "--json").out)
    rock, blocks = (found["engines"][name] for name in ("continuum-jointed", "dem"))
    assert rock["against"] == blocks["against"] == "oblique-joint"
    assert rock["misfit"] < 5e-3 and rock["ppv_worst"] < 1e-3
    assert blocks["ppv_worst"] < 0.05


def test_explain_knows_steps_and_references(jointwave):
    facts = json.loads(jointwave("explain", "column.toml", "--json").out)
    engines = ["dem", "continuum-jointed", "continuum-equivalent"]
    assert [one["engine"] for one in facts["steps"]] == engines
    assert facts["references"]["continuum-jointed"]["name"] == "oblique-joint"
    why = {name: one["why_not"] for name, one in facts["solutions"].items()}
    assert why["line-force"] == "is for a rock mass in the plane, not for one in space"
    shear = 5e10 / 2.4
    for axis in "xz":
        _, slow, *_ = facts["speeds"]["continuum-equivalent"][f"long waves along {axis}"]
        assert slow == pytest.approx((2600 * (1 / shear + 1 / 8e9)) ** -0.5)


def test_it_is_shown_by_both_engines_and_its_waveforms_and_a_section_are_drawn(jointwave):
    said = jointwave("view", "column.toml", "--out", "a.png", *FIELDS).out
    assert said.startswith("a.png: rigid blocks and jointed rock")
    assert jointwave("figure", "column.toml", "--out", "a.svg").out == "wrote a.svg\n"
    jointwave("run", "column.toml", "--engine", "continuum", "--out", "out", *FIELDS)
    said = jointwave("picture", "out", "--map", "speed", "--section", "x=0.5").out
    assert said == "wrote out-speed.png\n"
    error = jointwave("picture", "column.toml", "--section", "x=0.5", code=2).err
    assert "--section: is of results: `jointwave run column.toml --set record.fields" in error
    assert "would run" in jointwave("report", "column.toml", "--dry-run").out


def test_the_film_of_the_page_has_all_instants_and_how_far_both_engines_are(monkeypatch):
    for name, value in (("SLIDE", "column.toml"), ("EXACT", "oblique-joint"), ("FRAMES", 5)):
        monkeypatch.setattr(sections, name, value)
    Path("figures").mkdir()
    found = sections.film(Path.cwd())["found"]
    assert [line.split(":")[0] for line in found.sentences] == ["rigid blocks", "jointed rock"]
    with Image.open(*found.files) as images:
        frames = [one.convert("RGB").copy() for one in ImageSequence.Iterator(images)]
    assert len(frames) == 5
    first, later = frames[0], frames[-1]
    assert first.size == later.size and first.tobytes() != later.tobytes()


def test_rigid_blocks_run_the_wall(jointwave):
    """It stands under its weight; the pulse of the ground, 0.1 m/s, reaches its top, where friction
    has let blocks slide, and the ledger closes but for joints that open."""
    jointwave("run", WALL, "--engine", "dem", *ROCKS, "--out", "out")
    with xr.open_dataset("out/dem.nc") as found:
        assert found.attrs["blocks"] == 54 and list(found.axis.values) == ["x", "y", "z"]
        top = found.velocity.sel(point=0)
        assert 0.03 < abs(top.sel(axis="x")).max() < 0.2
        assert 0.04 < abs(top.sel(axis="y")).max() < 0.2
        friction = found.energy.sel(term="friction")
        assert friction[-1] > friction[0] and energy_residual(found) < 1e-3


def test_waves_in_space_whose_field_is_not_known_are_refused(jointwave):
    run = ("run", "rock-mass/cavern", "--engine", "dem", "--out", "out")
    said = jointwave(*run, "--set", "boundaries.top=free", code=2).err
    free = "a side that sends them back, top, beside quiet ones"
    assert said.endswith(f"meet {free}: their field is not known in space yet\n")
    assert said.count("\n") == 1


def test_explain_counts_its_blocks(jointwave):
    """5 courses of 5 and of 6 blocks, in two leaves; the smallest are half blocks."""
    words = jointwave("explain", WALL).out
    assert "blocks: 54\ncontacts: 151\nvolume (m³): 10.8\n" in words
    assert "smallest block: volume (m³) 0.108; width (m) 0.3" in words
    facts = json.loads(jointwave("explain", WALL, "--json").out)
    assert facts["joint_sets"]["bed"] == {"contacts": 80, "area": pytest.approx(4 * 3.6)}
    assert facts["effects"]["gravity"]["active"]


def test_it_is_drawn(jointwave, words_of):
    """With the names of what is seen: joints where blocks are apart or cut open."""
    assert jointwave("picture", WALL, "--out", "a.svg").out == "wrote a.svg\n"
    words = set(words_of("a.svg"))
    assert {"6 × 0.6 × 3 m, 54 blocks", "9.81 m/s²", "point"} <= words and "bed" not in words
    jointwave("picture", WALL, "--explode", "0.2", "--out", "b.svg")
    apart = "6 × 0.6 × 3 m, 54 blocks, moved apart by 0.2 of their distance"
    assert {"bed", "head", "collar", apart} <= set(words_of("b.svg"))
    jointwave("picture", "rock-mass/cavern", "--out", "c.svg")
    cut = "cut open through the middle of the openings"
    assert {"opening", cut} <= set(words_of("c.svg"))


@pytest.mark.skipif(find_spec("pyvista") is None, reason="PyVista is not installed")
def test_it_looks_the_same_without_pyvista(jointwave, monkeypatch):
    """But for the edges of blocks, which are a tenth of their colour in 16 by 16 pixels."""
    jointwave("picture", WALL, "--explode", "0.2", "--out", "a.png")
    monkeypatch.setattr(space, "find_spec", lambda name: None)
    jointwave("picture", WALL, "--explode", "0.2", "--out", "b.png")
    one, other = (
        np.asarray(Image.open(name).convert("RGB").reduce(16), float) for name in ("a.png", "b.png")
    )
    assert one.shape == other.shape and np.ptp(one) > 100
    assert abs(one - other).max() < 40
