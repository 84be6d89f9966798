"""Scenes of rock masses: what a file may say, and every contradiction as one line.

A mistake is a change to a good scene: (what is replaced, by what, words that the line must hold).
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

PRESSURE = 'kind = "pressure"\nopening = 0'
SHAPE = 'shape = "step"\namplitude = 1.0e5'

BED = '[[joint_sets]]\nname = "bed'
REGION = '[[regions]]\nname = "upper"\nthrough = [0.0, 25.0]\ndensity = 2300.0\n\n' + BED
OVER = REGION.replace(
    "[[joint_sets]]", '[[regions]]\nname = "over"\nthrough = [0.0, {}]\n\n[[joint_sets]]'
)

OUTLINED = REGION.replace("through = [0.0, 25.0]", "outline = [[40.0, 10.0], [50.0, 10.0]]")
THROUGH = "through = [0.0, 25.0]\noutline"

MISTAKES = {
    "region of no shape": (
        BED,
        REGION.replace("through = [0.0, 25.0]", ""),
        ["regions[0].through"],
    ),
    "region of two shapes": (
        BED,
        OUTLINED.replace("outline", THROUGH),
        ["give through or outline"],
    ),
    "region of two corners": (BED, OUTLINED, ["regions[0].outline = 2", "must be a polygon"]),
    "region on a side": (
        BED,
        OUTLINED.replace("10.0]]", "10.0], [50.0, 0.0]]"),
        ["regions[0].outline = 3", "inside the domain"],
    ),
    "unknown key of a region": (BED, REGION.replace("density", "densty"), ["regions[0].densty"]),
    "region named rock": (BED, REGION.replace("upper", "rock"), ["regions[0].name = 'rock'"]),
    "region twice": (BED, OVER.format("30.0").replace("over", "upper"), ["regions[1].name"]),
    "region outside": (
        BED,
        REGION.replace("25.0", "45.0"),
        ["regions[0].through", "region empty"],
    ),
    "region covered": (BED, OVER.format("20.0"), ["regions[0].through", "later regions"]),
    "region everywhere": (BED, REGION.replace("25.0", "-1.0"), ["leave part of the domain"]),
    "set of no region": ("dip = -55.0", 'dip = -55.0\nregions = ["low"]', ["name regions: rock"]),
    "damped in two rocks": (
        BED,
        REGION.replace('name = "bed', 'damping_ratio = 0.02\nname = "bed'),
        ["joint_sets[0].damping_ratio = 0.02", "of one density"],
    ),
    "unknown table": ("[time]", "[tme]\n[time]", ["tme", "unknown key", "did you mean time"]),
    "unknown key of the domain": ("size =", "sise = 1\nsize =", ["domain.sise = 1", "mean size"]),
    "unknown key of a set": ("dip = -55.0", "dip = -55.0\nspace = 3", ["joint_sets[1].space = 3"]),
    "name is a key of a set": (
        "dip = 35.0",
        "dip = 35.0\ndipp = 1",
        ["joint_sets[0].dipp", "name, dip"],
    ),
    "both kinds": ("[domain]", "[pillar]\n[domain]", ["pillar: give [pillar] or [domain]"]),
    "no shape": ("size = [60.0, 40.0]", "", ["domain: give exactly one of domain.size"]),
    "two shapes": ("size =", "outline = [[0.0, 0.0]]\nsize =", ["give exactly one of domain.size"]),
    "size of one number": ("[60.0, 40.0]", "[60.0]", ["domain.size = [60.0]", "have 2 numbers"]),
    "negative size": (
        "[60.0, 40.0]",
        "[60.0, -40.0]",
        ["domain.size[1] = -40.0", "greater than 0"],
    ),
    "NaN": ("size = [60.0, 40.0]", "size = [60.0, nan]", ["domain.size[1] = nan", "finite"]),
    "crossing outline": (
        "size = [60.0, 40.0]",
        "outline = [[0.0, 0.0], [60.0, 40.0], [60.0, 0.0], [0.0, 40.0]]",
        ["domain.outline", "does not cross itself", "Self-intersection[30 20]"],
    ),
    "outline of two points": (
        "size = [60.0, 40.0]",
        "outline = [[0.0, 0.0], [60.0, 40.0]]",
        ["domain.outline", "it has no area"],
    ),
    "opening outside": (
        "[35.0, 15.0]",
        "[95.0, 15.0]",
        ["domain.openings[0]", "lie in the domain"],
    ),
    "flat opening": (
        "[35.0, 22.0], [25.0, 22.0]]",
        "[30.0, 15.0]]",
        ["domain.openings[0]", "must be a polygon"],
    ),
    "openings that overlap": (
        "[25.0, 22.0]]]",
        "[25.0, 22.0]], [[30.0, 20.0], [50.0, 20.0], [50.0, 30.0]]]",
        ["domain.openings[1]", "must not overlap openings[0]"],
    ),
    "no rock left": (
        "openings = [[[25.0, 15.0], [35.0, 15.0], [35.0, 22.0], [25.0, 22.0]]]",
        "openings = [[[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [0.0, 40.0]]]",
        ["domain.openings[0]", "must leave rock"],
    ),
    "no density": ("density = 2600.0", "", ["rock.density", "is required"]),
    "speeds of a pillar": ("[rock]", "[rock]\np_speed = 2e3", ["rock.p_speed", "unknown key"]),
    "Poisson's ratio": ("0.25", "0.5", ["rock.intact_poisson = 0.5", "less than 0.5"]),
    "dip beyond a turn": (
        "dip = 35.0",
        "dip = 200.0",
        ["joint_sets[0].dip = 200.0", "at most 180"],
    ),
    "same name": ('name = "cross"', 'name = "bedding"', ["joint_sets[1].name", "must be unique"]),
    "ends at nothing": ('["bedding"]', '["fault"]', ["joint_sets[1].ends_at = 'fault'", "bedding"]),
    "ends at itself": ('["bedding"]', '["cross"]', ["joint_sets[1].ends_at = 'cross'", "bedding"]),
    "ends twice": ('["bedding"]', '["bedding", "bedding"]', ["ends_at", "not repeat a set"]),
    "ends at each other": (
        "scatter = 0.2",
        'scatter = 0.2\nends_at = ["cross"]',
        ["joint_sets", "sets end at each other: bedding, cross"],
    ),
    "offset of through-going joints": (
        'ends_at = ["bedding"]',
        "",
        ["joint_sets[1].offset = 0.5", "without joint_sets[1].ends_at"],
    ),
    "neither spacing nor point": ("spacing = 3.0", "", ["joint_sets[1].spacing", "or through"]),
    "scatter of one joint": ("spacing = 2.0", "", ["joint_sets[0].scatter = 0.2", "no meaning"]),
    "scatter without seed": ("seed = 1", "", ["joint_sets[0].seed", "is required with"]),
    "seed without scatter": ("scatter = 0.2", "", ["joint_sets[0].seed = 1", "no meaning without"]),
    "too much scatter": ("scatter = 0.2", "scatter = 0.6", ["scatter = 0.6", "at most 0.5"]),
    "no stiffness": ("shear_stiffness = 4.0e9", "", ["joint_sets[0].shear_stiffness", "required"]),
    "strength without energy": (
        "friction_angle = 30.0",
        "tensile_strength = 1e5",
        ["joint_sets[1].fracture_energy", "is required with"],
    ),
    "snap-back": (
        "friction_angle = 30.0",
        "tensile_strength = 1e5\nfracture_energy = 0.1",
        ["joint_sets[1].fracture_energy = 0.1", "at least 0.2501 J/m2"],
    ),
    "two dashpots": (
        "friction_angle = 30.0",
        "damping_ratio = 0.1\n[damping.rayleigh]\nfrequencies = [1.0, 9.0]\nratios = [0.1, 0.1]",
        ["joint_sets[1].damping_ratio = 0.1", "damping.rayleigh"],
    ),
    "receiver outside": ("[[40.0, 30.0]]", "[[40.0, 41.0]]", ["record.points[0] = [40.0, 41.0]"]),
    "receiver in an opening": (
        "[[40.0, 30.0]]",
        "[[1.0, 1.0], [30.0, 20.0]]",
        ["record.points[1] = [30.0, 20.0]", "outside its openings"],
    ),
    "joint receiver in an opening": ("[[31.0, 10.5]]", "[[31.0, 20.0]]", ["record.joints[0]"]),
    "receiver twice": (
        "[[40.0, 30.0]]",
        "[[40.0, 30.0], [40.0, 30.0]]",
        ["record.points[1]", "must not repeat a position"],
    ),
    "three coordinates": ("[[40.0, 30.0]]", "[[4.0, 3.0, 1.0]]", ["record.points[0]", "2 numbers"]),
    "nothing recorded": (
        "points = [[40.0, 30.0]]\njoints = [[31.0, 10.5]]",
        "",
        ["record: give at least one of record.points"],
    ),
    "interval too long": ("[record]", "[record]\ninterval = 1.0", ["record.interval = 1.0"]),
    "fields too rare": ("[record]", "[record]\nfields = 1.0", ["record.fields = 1.0"]),
    "wave through a fixed side": (
        'bottom = "quiet"',
        'bottom = "fixed"',
        ["boundaries.bottom = 'fixed'", "waves[0]"],
    ),
    "wave without direction": (
        'direction = [0.0, 1.0]\nshape = "ricker"',
        'shape = "ricker"',
        ["waves[0].direction", "is required"],
    ),
    "no unit vector": (
        'direction = [0.0, 1.0]\nshape = "ricker"',
        'direction = [1.0, 1.0]\nshape = "ricker"',
        ["waves[0].direction = [1.0, 1.0]", "unit vector"],
    ),
    "wave without period": ("period = 0.01", "", ["waves[0].period", "waves[0].shape = 'ricker'"]),
    "wave with cycles": (
        "period = 0.01",
        "period = 0.01\ncycles = 2",
        ["waves[0].cycles = 2", "no meaning for shape 'ricker'"],
    ),
    "unknown kind of wave": (
        'kind = "P"',
        'kind = "R"',
        ["waves[0].kind = 'R'", "'P', 'S' or 'SV'"],
    ),
    "opening that is none": ("opening = 0", "opening = 1", ["loads[0].opening = 1", "of the 1 "]),
    "pressure on nothing": (
        "opening = 0",
        "",
        ["loads[0].side", "exactly one of side and opening"],
    ),
    "pressure on two": ("opening = 0", 'opening = 0\nside = "top"', ["exactly one of side and"]),
    "part that is elsewhere": (
        "opening = 0",
        'side = "top"\nbetween = [[10.0, 40.0], [20.0, 39.0]]',
        ["loads[0].between = [20.0, 39.0]", "must lie on top"],
    ),
    "force without a place": (
        PRESSURE,
        'kind = "force"',
        ["loads[0].at", "loads[0].kind = 'force'"],
    ),
    "force in an opening": (
        f"{PRESSURE}\n{SHAPE}",
        'kind = "force"\nquantity = "force"\nat = [30.0, 20.0]\ndirection = [0.0, -1.0]\n' + SHAPE,
        ["loads[0].at = [30.0, 20.0]", "outside its openings"],
    ),
    "force with a pressure's unit": (
        f"{PRESSURE}\n{SHAPE}",
        'kind = "force"\nat = [30.0, 10.0]\ndirection = [0.0, -1.0]\n' + SHAPE,
        ["loads[0].quantity = 'stress'", "must be 'force' here"],
    ),
    "base that is not held": (
        f"{PRESSURE}\n{SHAPE}",
        'kind = "base"\nside = "top"\nquantity = "velocity"\ndirection = [1.0, 0.0]\n' + SHAPE,
        ["loads[0].side = 'top'", "needs boundaries.top = 'fixed' or 'quiet', not 'free'"],
    ),
    "pressure on an outline that is none": (
        "opening = 0",
        'side = "outline"',
        ["loads[0].side = 'outline'", "which has left, right, bottom, top"],
    ),
    "unknown side": ("[boundaries]", '[boundaries]\nfront = "fixed"', ["boundaries.front"]),
    "side that is none": (
        "[boundaries]",
        '[boundaries]\noutline = "fixed"',
        ["boundaries.outline = 'fixed'", "is not a side of this domain"],
    ),
    "one periodic side": (
        'bottom = "quiet"\nleft = "quiet"',
        'bottom = "quiet"\nleft = "periodic"',
        ["boundaries.left = 'periodic'", "needs boundaries.right = 'periodic'"],
    ),
    "gravity on nothing": (
        "[gravity]\nstatic = false",
        "[gravity]\ndirection = [0.0, 1.0]",
        ["gravity.static = true", "needs a fixed side"],
    ),
    "gravity on nothing but dashpots": (
        "[gravity]\nstatic = false",
        "[gravity]\ndirection = [0.0, 1.0]\nstatic = false",
        ["boundaries.left = 'quiet'", "does not bear the weight", "needs a fixed side"],
    ),
    "prestress without yy": ("yy = 1.0e7", "", ["prestress.yy", "is required"]),
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


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_one_line(written, name):
    old, new, words = MISTAKES[name]
    assert GOOD.count(old), f"{old!r} is not in the good scene"
    path = written(GOOD.replace(old, new, 1))
    with pytest.raises(SceneError) as error:
        load(path)
    line = str(error.value)
    assert line.startswith(f"{path}") and "\n" not in line and len(line) < len(str(path)) + 550
    for word in words:
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
