"""A rock mass on the command line: its blocks explained, its solutions run, compared and drawn."""

import json
from pathlib import Path

import pandas as pd
import pytest
import xarray as xr

import jointwave as jw
from jointwave.compare.runs.comparison import solved
from jointwave.compare.solvers.record import Answer

SCENE = """
title = "A tunnel in brickwork"
rock = { density = 2600.0, intact_modulus = 5.0e10 }
domain = { size = [10.0, 6.0], openings = [[[4, 2], [6, 2], [6, 4], [4, 4]]] }
joint_sets = [
    { name = "rows", dip = 0, spacing = 1, normal_stiffness = 1e10, shear_stiffness = 4e9 },
    { name = "cross", dip = 90, spacing = 2, ends_at = ["rows"], normal_stiffness = 1e10, \
shear_stiffness = 4e9 },
]
time = { duration = 0.1 }
record = { points = [[1.0, 3.5]] }
[[variants]]
name = "bonded"
joint_sets = []
domain.openings = []
[[variants]]
name = "shifted"
domain.openings = [[[3.0, 2.0], [6.0, 2.0], [6.0, 4.0], [3.0, 4.0]]]
domain.non_convex = "cut"
"""
ONE_JOINT = {
    "domain": {"size": [40.0, 40.0]},
    "record": {"points": [[20.0, 10.0], [20.0, 30.0]], "joints": [[20.0, 20.0]], "interval": 1e-4},
}
COARSE = "--set numerics.continuum.size=4"


@pytest.fixture
def says(one_joint, in_toml, jointwave):
    """Return a function that runs a command beside the scenes: what it prints."""
    Path("mass.toml").write_text(SCENE)
    scene = one_joint(**ONE_JOINT)
    scene["joint_sets"][0]["through"] = [20.0, 20.0]
    Path("joint.toml").write_text(in_toml(scene))
    return lambda command, code=0: jointwave(*command.split(), code=code)


@pytest.fixture
def explains(says):
    return lambda options: json.loads(says(f"explain {options} --json").out)


def test_a_scene_is_run_and_its_file_says_where_its_receivers_are(says):
    """Its cost is told before; one of its waveforms is asked for by its place."""
    exact, file = "run joint.toml --engine exact", "results/exact-oblique-joint.nc"
    (run,) = json.loads(says(f"{exact} --dry-run --json").out)["runs"]
    assert run["engine"] == "oblique-joint" and run["bytes"] > 0
    assert "oblique-joint" in says(f"{exact} --out results").out
    with xr.open_dataset(file) as found:
        assert found.velocity.point_x.values.tolist() == [20.0, 20.0]
        assert found.velocity.point_y.values.tolist() == [10.0, 30.0]
        assert found.traction.joint_point_y.values.tolist() == [20.0]
        assert json.loads(found.effects) == ["incident waves", "quiet sides", "energy ledger"]
    says(f"{exact} --out results --resume")
    compare = f"compare joint.toml {COARSE} --with {file}"
    (facts,) = json.loads(says(f"{compare}:velocity_x@[20,30] --json").out)
    (row,) = (
        one
        for one in facts["rows"]
        if (one["other"], one["kind"]) == ("oblique-joint", "given curves")
    )
    assert row["quantity"] == "velocity x"
    said = says(f"{compare}:velocity_x@[20,31]", code=2)
    assert "velocity_x@[20,31] must be one of them" in said.err


@pytest.mark.parametrize(
    ("scene", "place", "words"),
    [
        ("joint.toml", "velocity_x@20", "velocity_x@20: is not a receiver of a rock mass"),
        ("joint.toml", "velocity_x@[1,2]", "at a receiver of the scene: points at [20, 10] m, ["),
        ("guo-li-2002/fig-03", "gap@[1,2]", "gap@[1,2]: is not a receiver of a pillar"),
    ],
)
def test_a_place_that_the_scene_has_not_is_refused(says, scene, place, words):
    Path("curve.csv").write_text("0,1\n0.01,2\n0.02,3\n")
    assert words in says(f"compare {scene} --with curve.csv:{place}", code=2).err


def test_a_sweep_has_a_row_a_receiver(says):
    """Of half the amplitude half the peak, at every receiver."""
    said = says("run joint.toml --engine exact --sweep waves.0.amplitude=1e6,5e5 --out swept")
    assert "velocity at [20, 30] m" in said.out
    rows = pd.read_csv("swept/sweep.csv")
    peaks = rows.pivot_table("peak", ["quantity", "x", "y"], "waves.0.amplitude")
    assert len(peaks) == 5 and (2 * peaks[5e5]).to_numpy() == pytest.approx(peaks[1e6].to_numpy())


def test_tables_and_panels_name_places(says):
    """A header of a table is a solution and a place in words; a figure has a panel a component."""
    assert "joint at an angle, exact" in says(f"compare joint.toml {COARSE} --out found").out
    header = Path("found/comparison.csv").read_text().splitlines()[0]
    assert "wrote joint.svg" in says(f"figure joint.toml {COARSE} --out joint.svg").out
    drawn = Path("joint.svg").read_text()
    for place in ("velocity x at [20, 10] m", "traction s at [20, 20] m"):
        assert f"oblique-joint | {place}" in header and place in drawn


def test_explain_says_what_its_blocks_are(explains):
    """30 bricks of 2 m2 less the two that the tunnel takes out, whole."""
    facts = explains("mass.toml")
    assert (facts["blocks"], facts["area"]) == (28, 56.0)
    assert facts["smallest"]["area"] == facts["largest"]["area"] == 2.0
    assert facts["joint_sets"]["rows"] == {"contacts": 5 * 5 - 3, "length": 44.0}
    assert facts["joint_sets"]["cross"] == {"contacts": 6 * 4 - 4, "length": 20.0}
    assert facts["cuts_through_rock"]["contacts"] == 0
    assert facts["boundary"] == {"left": 6, "right": 6, "bottom": 5, "top": 5, "opening 0": 6}
    assert 0 < facts["bytes"] < facts["bytes_at_most"]
    # C_12 = mu of a stiffness of 3 mu, 3 mu and, in shear, 2 mu: what two sets across each other
    # cannot have of rock with a Poisson's ratio of 1/4.
    assert facts["rigid_blocks_lack"] == pytest.approx((2 / 24) ** 0.5, rel=1e-6)
    bonded = explains("mass.toml --variant bonded")
    assert (bonded["blocks"], bonded["area"], bonded["joint_sets"]) == (1, 60.0, {})


WORDS = ["A tunnel in brickwork", "blocks: 28", "area (m²): 56", "rows", "memory of the blocks"]
WORDS += ["smallest block: area (m²) 2; width (m) 1; centroid (m)"]
WORDS += ["rigid blocks cannot represent: 0.2887"]
WORDS += ["--engine dem", " other effects are not active; which, and why: --all"]


def test_explain_in_words(says):
    out = says("explain mass.toml").out
    assert not [words for words in WORDS if words not in out]
    assert "oblique-joint" not in out and "no damping_ratio" not in out
    out = says("explain mass.toml --all").out
    assert "--model oblique-joint " in out and "no damping_ratio" in out
    assert "jointed-bar" not in out  # of a pillar
    out = says("explain joint.toml --set numerics.dem={}").out
    assert "not by rigid blocks: numerics.dem.block is required (m): waves pass rigid" in out


def test_explain_counts_cuts_through_rock(says, explains):
    """A tunnel that ends in the middle of bricks: those are cut along its faces."""
    facts = explains("mass.toml --variant shifted")
    assert facts["area"] == 54.0 and facts["variant"] == "shifted"
    assert facts["cuts_through_rock"]["contacts"] == 0
    triangle = "mass.toml --set domain.openings=[[[3.0,2.5],[6.0,2.5],[5.0,3.5]]]"
    assert explains(f"{triangle} --variant shifted")["cuts_through_rock"]["contacts"] > 0
    said = says(f"explain {triangle}", code=2)
    assert said.out == "" and said.err.count("\n") == 1
    assert said.err.startswith("jointwave: mass.toml: domain: a block is not convex")


def test_what_nothing_solves_says_why(says):
    answers = {"one": Answer("the joints slip"), "other": Answer("it has two waves")}
    said = r"joint\.toml: nothing solves it: one: the joints slip; other: it has two waves"
    with pytest.raises(jw.SceneError, match=said):
        solved(jw.load("joint.toml"), answers)


def test_explain_counts_the_blocks_that_are_run(explains):
    """With half a block left at every quiet side there are five lines 8 m apart, the joint one of
    them, and four across it 10 m apart: 6 rows of 5 blocks."""
    square = "--set joint_sets.0.dip=0 --set rock.intact_poisson=0 --set numerics.dem.block=10"
    facts = explains(f"joint.toml {square}")
    assert (facts["blocks"], facts["rigid_blocks"]) == (2, 30)
    assert facts["area"] == pytest.approx(1600.0, rel=1e-12)
