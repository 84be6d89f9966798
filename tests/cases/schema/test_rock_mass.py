"""Scenes of rock masses: what a file may say, and every contradiction as one line.

A mistake is a change to a good scene, with words that the line must hold.
"""

import subprocess
import sys

import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.read import load, load_variant
from jointwave.cases.scene_type import pillar_of
from jointwave.cases.schema.rock_mass import RockMass

GOOD = """\
title = "good"

[domain]
size = [60.0, 40.0]
openings = [[[25.0, 15.0], [35.0, 15.0], [35.0, 22.0], [25.0, 22.0]]]
non_convex = "cut"

[rock]
density = 2600.0
intact_modulus = 5.0e10
intact_poisson = 0.25

[[joint_sets]]
name = "bedding"
dip = 35.0
spacing = 2.0
through = [30.0, 20.0]
scatter = 0.2
seed = 1
normal_stiffness = 1.0e10
shear_stiffness = 4.0e9

[[joint_sets]]
name = "cross"
dip = -55.0
spacing = 3.0
ends_at = ["bedding"]
offset = 0.5
normal_stiffness = 2.0e10
shear_stiffness = 8.0e9
friction_angle = 30.0

[[waves]]
kind = "P"
direction = [0.0, 1.0]
shape = "ricker"
amplitude = 1.0e6
period = 0.01

[[loads]]
kind = "pressure"
opening = 0
shape = "step"
amplitude = 1.0e5

[boundaries]
bottom = "quiet"
left = "quiet"
right = "quiet"

[prestress]
xx = 5.0e6
yy = 1.0e7

[gravity]
static = false

[time]
duration = 0.1

[record]
points = [[40.0, 30.0]]
joints = [[31.0, 10.5]]

[expect]
"dem ~ continuum-jointed" = 1e-1

[[variants]]
name = "S"
[[variants.waves]]
kind = "S"
direction = [0.0, 1.0]
shape = "table"
file = "pulse.csv"
amplitude = 1.0e6
"""

MISTAKES = {
    "regions = [{ name = 'upper' }]": "regions[0].through",
    "regions = [{ name = 'upper', through = [0.0, 25.0], outline = [[4.0, 1.0], [5.0, 1.0]] }]": (
        "give through or outline"
    ),
    "regions = [{ name = 'upper', outline = [[40.0, 10.0], [50.0, 10.0]] }]": (
        "regions[0].outline = 2 ... must be a polygon"
    ),
    "regions = [{ name = 'upper', outline = [[40.0, 10.0], [50.0, 10.0], [50.0, 0.0]] }]": (
        "regions[0].outline = 3 ... inside the domain"
    ),
    "regions = [{ name = 'upper', through = [0.0, 25.0], densty = 2300.0 }]": "regions[0].densty",
    "regions = [{ name = 'rock', through = [0.0, 25.0] }]": "regions[0].name = 'rock'",
    "regions = [{ name = 'upper', through = [0.0, 25.0] }]; "
    "regions[1] = { name = 'upper', through = [0.0, 30.0] }": "regions[1].name",
    "regions = [{ name = 'upper', through = [0.0, 45.0] }]": "regions[0].through ... region empty",
    "regions = [{ name = 'upper', through = [0.0, 25.0] }]; "
    "regions[1] = { name = 'over', through = [0.0, 20.0] }": "regions[0].through ... later regions",
    "regions = [{ name = 'upper', through = [0.0, -1.0] }]": "leave part of the domain",
    "joint_sets[1].regions = ['low']": "name regions: rock",
    "regions = [{ name = 'upper', through = [0.0, 25.0], density = 2300.0 }]; "
    "joint_sets[0].damping_ratio = 0.02": "joint_sets[0].damping_ratio = 0.02 ... of one density",
    "tme = {}": "tme ... unknown key ... did you mean time",
    "domain.sise = 1": "domain.sise = 1 ... mean size",
    "joint_sets[1].space = 3": "joint_sets[1].space = 3",
    "joint_sets[0].dipp = 1": "joint_sets[0].dipp ... name, dip",
    "pillar = {}": "pillar: give [pillar] or [domain]",
    "no domain.size": "domain: give exactly one of domain.size",
    "domain.outline = [[0.0, 0.0]]": "give exactly one of domain.size",
    "domain.size = [60.0]": "domain.size = [60.0] ... have 2 numbers",
    "domain.size = [60.0, -40.0]": "domain.size[1] = -40.0 ... greater than 0",
    "domain.size = [60.0, nan]": "domain.size[1] = nan ... finite",
    "no domain.size; domain.outline = [[0.0, 0.0], [60.0, 40.0], [60.0, 0.0], [0.0, 40.0]]": (
        "domain.outline ... does not cross itself ... Self-intersection[30 20]"
    ),
    "no domain.size; domain.outline = [[0.0, 0.0], [60.0, 40.0]]": (
        "domain.outline ... it has no area"
    ),
    "domain.openings = [[[25.0, 15.0], [95.0, 15.0], [35.0, 22.0], [25.0, 22.0]]]": (
        "domain.openings[0] ... lie in the domain"
    ),
    "domain.openings = [[[25.0, 15.0], [35.0, 15.0], [30.0, 15.0]]]": (
        "domain.openings[0] ... must be a polygon"
    ),
    "domain.openings[1] = [[30.0, 20.0], [50.0, 20.0], [50.0, 30.0]]": (
        "domain.openings[1] ... must not overlap openings[0]"
    ),
    "domain.openings = [[[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [0.0, 40.0]]]": (
        "domain.openings[0] ... must leave rock"
    ),
    "no rock.density": "rock.density ... is required",
    "rock.p_speed = 2000.0": "rock.p_speed ... unknown key",
    "rock.intact_poisson = 0.5": "rock.intact_poisson = 0.5 ... less than 0.5",
    "joint_sets[0].dip = 200.0": "joint_sets[0].dip = 200.0 ... at most 180",
    "joint_sets[1].name = 'bedding'": "joint_sets[1].name ... must be unique",
    "joint_sets[1].ends_at = ['fault']": "joint_sets[1].ends_at = 'fault' ... bedding",
    "joint_sets[1].ends_at = ['cross']": "joint_sets[1].ends_at = 'cross' ... bedding",
    "joint_sets[1].ends_at = ['bedding', 'bedding']": "ends_at ... not repeat a set",
    "joint_sets[0].ends_at = ['cross']": "joint_sets ... sets end at each other: bedding, cross",
    "no joint_sets[1].ends_at": "joint_sets[1].offset = 0.5 ... without joint_sets[1].ends_at",
    "no joint_sets[1].spacing": "joint_sets[1].spacing ... or through",
    "no joint_sets[0].spacing": "joint_sets[0].scatter = 0.2 ... no meaning",
    "no joint_sets[0].seed": "joint_sets[0].seed ... is required with",
    "no joint_sets[0].scatter": "joint_sets[0].seed = 1 ... no meaning without",
    "joint_sets[0].scatter = 0.6": "scatter = 0.6 ... at most 0.5",
    "no joint_sets[0].shear_stiffness": "joint_sets[0].shear_stiffness ... required",
    "no joint_sets[1].friction_angle; joint_sets[1].tensile_strength = 100000.0": (
        "joint_sets[1].fracture_energy ... is required with"
    ),
    "no joint_sets[1].friction_angle; joint_sets[1].tensile_strength = 100000.0; "
    "joint_sets[1].fracture_energy = 0.1": (
        "joint_sets[1].fracture_energy = 0.1 ... at least 0.2501 J/m2"
    ),
    "no joint_sets[1].friction_angle; joint_sets[1].damping_ratio = 0.1; "
    "damping.rayleigh.frequencies = [1.0, 9.0]; damping.rayleigh.ratios = [0.1, 0.1]": (
        "joint_sets[1].damping_ratio = 0.1 ... damping.rayleigh"
    ),
    "record.points = [[40.0, 41.0]]": "record.points[0] = [40.0, 41.0]",
    "record.points = [[1.0, 1.0], [30.0, 20.0]]": (
        "record.points[1] = [30.0, 20.0] ... outside its openings"
    ),
    "record.joints = [[31.0, 20.0]]": "record.joints[0]",
    "record.points = [[40.0, 30.0], [40.0, 30.0]]": (
        "record.points[1] ... must not repeat a position"
    ),
    "record.points = [[4.0, 3.0, 1.0]]": "record.points[0] ... 2 numbers",
    "no record.points; no record.joints": "record: give at least one of record.points",
    "record.interval = 1.0": "record.interval = 1.0",
    "record.fields = 1.0": "record.fields = 1.0",
    "boundaries.bottom = 'fixed'": "boundaries.bottom = 'fixed' ... waves[0]",
    "no waves[0].direction": "waves[0].direction ... is required",
    "waves[0].direction = [1.0, 1.0]": "waves[0].direction = [1.0, 1.0] ... unit vector",
    "no waves[0].period": "waves[0].period ... waves[0].shape = 'ricker'",
    "waves[0].cycles = 2": "waves[0].cycles = 2 ... no meaning for shape 'ricker'",
    "waves[0].kind = 'R'": "waves[0].kind = 'R' ... 'P', 'S' or 'SV'",
    "loads[0].opening = 1": "loads[0].opening = 1 ... of the 1 ",
    "no loads[0].opening": "loads[0].side ... exactly one of side and opening",
    "loads[0].side = 'top'": "exactly one of side and",
    "no loads[0].opening; loads[0].side = 'top'; loads[0].between = [[10.0, 40.0], [20.0, 39.0]]": (
        "loads[0].between = [20.0, 39.0] ... must lie on top"
    ),
    "no loads[0].opening; loads[0].kind = 'force'": "loads[0].at ... loads[0].kind = 'force'",
    "no loads[0].opening; loads[0].kind = 'force'; loads[0].quantity = 'force'; "
    "loads[0].at = [30.0, 20.0]; loads[0].direction = [0.0, -1.0]": (
        "loads[0].at = [30.0, 20.0] ... outside its openings"
    ),
    "no loads[0].opening; loads[0].kind = 'force'; loads[0].at = [30.0, 10.0]; "
    "loads[0].direction = [0.0, -1.0]": "loads[0].quantity = 'stress' ... must be 'force' here",
    "no loads[0].opening; loads[0].kind = 'base'; loads[0].side = 'top'; "
    "loads[0].quantity = 'velocity'; loads[0].direction = [1.0, 0.0]": (
        "loads[0].side = 'top' ... needs boundaries.top = 'fixed' or 'quiet', not 'free'"
    ),
    "no loads[0].opening; loads[0].side = 'outline'": (
        "loads[0].side = 'outline' ... which has left, right, bottom, top"
    ),
    "boundaries.front = 'fixed'": "boundaries.front",
    "boundaries.outline = 'fixed'": "boundaries.outline = 'fixed' ... is not a side of this domain",
    "boundaries.left = 'periodic'": (
        "boundaries.left = 'periodic' ... needs boundaries.right = 'periodic'"
    ),
    "no gravity.static; gravity.direction = [0.0, 1.0]": (
        "gravity.static = true ... needs a fixed side"
    ),
    "gravity.direction = [0.0, 1.0]": (
        "boundaries.left = 'quiet' ... does not bear the weight ... needs a fixed side"
    ),
    "no prestress.yy": "prestress.yy ... is required",
}


@pytest.fixture
def written(tmp_path):
    """Return a function that writes a scene and the history that it names."""
    (tmp_path / "pulse.csv").write_text("0.0, 0.0\n0.01, 1.0\n0.02, 0.0\n")

    def write(text):
        path = tmp_path / "mass.toml"
        path.write_text(text)
        return path

    return write


def test_the_good_scene_is_good(written):
    one, other = load(written(GOOD))
    assert isinstance(one, RockMass) and (one.name, other.name) == ("", "S")
    assert one.where.endswith("mass.toml") and other.where.endswith("mass.toml [S]")
    assert [s.name for s in one.joint_sets] == ["bedding", "cross"]
    assert one.interval == 0.01 / 200 and other.interval == 0.1 / 2000
    assert other.waves[0].history.stress.tolist() == [0.0, 1.0, 0.0]
    assert one.boundaries.top == "free" and one.gravity.direction == [0.0, -1.0]
    assert one.joint_sets[1].friction_angle == 30.0 and one.joint_sets[1].point_rule == "vertices"


@pytest.mark.parametrize("changes", MISTAKES)
def test_a_mistake_is_one_line(written, changed, changes):
    path = written(changed(GOOD, changes))
    with pytest.raises(SceneError) as error:
        load(path)
    line = str(error.value)
    assert line.startswith(f"{path}") and "\n" not in line and len(line) < len(str(path)) + 550
    for word in MISTAKES[changes].split(" ... "):
        assert word in line


def test_a_history_is_beside_the_scene_unless_it_is_asked_for(written, tmp_path):
    path = written(GOOD)
    elsewhere = tmp_path / "far" / "pulse.csv"
    elsewhere.parent.mkdir()
    elsewhere.write_text("0.0, 0.0\n0.01, 2.0\n")
    with pytest.raises(SceneError, match=r"waves\[0\].file = '../pulse.csv': is outside the"):
        load_variant(path, "S", {"waves.0.file": "../pulse.csv"}, asked=False)
    found = load_variant(path, "S", {"waves.0.file": str(elsewhere)})
    assert found.waves[0].history.stress.tolist() == [0.0, 2.0]
    with pytest.raises(SceneError, match=r"waves\[0\].file = 'none.csv': cannot be read"):
        load_variant(path, "S", {"waves.0.file": "none.csv"})


@pytest.mark.parametrize(
    ("load", "boundaries"),
    [
        ({"kind": "force", "quantity": "force", "at": [3.0, 9.0], "direction": [1.0, 0.0]}, {}),
        ({"kind": "pressure", "side": "top", "between": [[1.0, 40.0], [9.0, 40.0]]}, {}),
        ({"kind": "pressure", "opening": 0, "between": [[25.0, 16.0], [25.0, 20.0]]}, {}),
        (
            {"kind": "base", "side": "top", "quantity": "acceleration", "direction": [1.0, 0.0]},
            {"boundaries.top": "fixed"},
        ),
    ],
)
def test_loads_of_every_kind(written, load, boundaries):
    changes = {"loads": [{"shape": "step", "amplitude": 1e5, **load}], **boundaries}
    found = load_variant(written(GOOD), "", changes)
    assert found.loads[0].kind == load["kind"]


def test_sides_of_a_slope(written):
    """Left, right, bottom and top of an outline where it follows its bounding box; a wave from
    below meets no free surface, one from the left does."""
    slope = [[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [45.0, 40.0], [20.0, 14.0], [0.0, 14.0]]
    changes = {"domain": {"outline": slope}, "loads": [], "record.joints": []}
    path = written(GOOD)
    assert load_variant(path, "", {**changes, "boundaries.outline": "free"}).boundaries
    with pytest.raises(SceneError, match=r"boundaries\.outline = 'free': must be 'quiet': waves"):
        load_variant(path, "", {**changes, "waves.0.direction": [1.0, 0.0]})


def test_both_kinds_are_read_and_told_apart(written, paper_folder):
    """A command for one kind of scene only says so in one line, with the file."""
    path = written(GOOD)
    mass, pillar = load(path)[0], load_variant(paper_folder / "fig-03.toml")
    assert (mass.kind, pillar.kind) == ("rock mass", "pillar")
    assert pillar_of(pillar) is pillar
    with pytest.raises(SceneError, match="is a rock mass; a fit accepts pillars only") as error:
        pillar_of(mass, "a fit")
    assert str(error.value).startswith(f"{path}: domain: ")


def test_everything_that_acts_in_time_decides_the_interval(written):
    """A 200th of the shortest period of waves and loads."""
    mass = load(written(GOOD))[0]
    periods = [one.period for one in (*mass.waves, *mass.loads) if one.period]
    assert mass.pulses == (*mass.waves, *mass.loads) and periods
    assert mass.interval == min(periods) / 200


def test_a_pillar_imports_nothing_of_rock_masses(tmp_path):
    """Neither shapely nor what cuts."""
    code = (
        "import sys; from jointwave import cases; from pathlib import Path\n"
        "cases.load(Path(cases.__file__).parent / 'guo-li-2002' / 'fig-03.toml')\n"
        "print(*(m for m in sys.modules if 'shapely' in m or 'partition.scene' in m))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_an_empty_table_of_a_variant_has_its_defaults_unless_it_is_there(written):
    text = '\n[[variants]]\nname = "heavy"\ngravity = {}\nboundaries = {}\n'
    first, *_, heavy = load(written(GOOD.replace("[gravity]\nstatic = false\n", "") + text))
    assert first.gravity is None and heavy.gravity.acceleration == 9.81
    assert heavy.boundaries == first.boundaries


def test_a_variant_changes_one_of_a_list_of_tables(written):
    path = written(GOOD + '\n[[variants]]\nname = "steep"\njoint_sets.1.dip = 80.0\n')
    first, *_, steep = load(path)
    assert [s.dip for s in steep.joint_sets] == [first.joint_sets[0].dip, 80.0]
    assert steep.joint_sets[1].model_dump() == {**first.joint_sets[1].model_dump(), "dip": 80.0}
    path = written(GOOD + '\n[[variants]]\nname = "none"\njoint_sets.7.dip = 80.0\n')
    allowed = r"variants\[1\].joint_sets.7.dip = 80.0: 7 must be .*of the list, 0 to 1"
    with pytest.raises(SceneError, match=allowed):
        load(path)
