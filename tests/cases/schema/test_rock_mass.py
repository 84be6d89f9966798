"""Scenes of rock masses: what a file may say, and what its variants make of it."""

import pickle
import subprocess
import sys

import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.read import load, load_variant
from jointwave.cases.scene_type import pillar_of
from jointwave.cases.schema.rock_mass import RockMass
from tests.cases.schema.test_mistakes import PLANE

S_WAVE = {"kind": "S", "direction": [0.0, 1.0], "shape": "table", "amplitude": 1e6}
VARIANT = {"name": "S", "waves": [S_WAVE | {"file": "pulse.csv"}]}


@pytest.fixture
def written(tmp_path, in_toml):
    """Return a function that writes a scene with more tables, and the history that one names."""
    (tmp_path / "pulse.csv").write_text("0.0, 0.0\n0.01, 1.0\n0.02, 0.0\n")

    def write(*variants, **tables):
        path = tmp_path / "mass.toml"
        every = PLANE | {"variants": [VARIANT, *variants]} | tables
        path.write_text(in_toml({key: one for key, one in every.items() if one is not None}))
        return path

    return write


def test_the_good_scene_is_good(written):
    one, other = load(written())
    assert isinstance(one, RockMass) and (one.name, other.name) == ("", "S")
    assert one.where.endswith("mass.toml") and other.where.endswith("mass.toml [S]")
    assert [s.name for s in one.joint_sets] == ["bedding", "cross"]
    assert one.interval == 0.01 / 200 and other.interval == 0.1 / 2000
    assert other.waves[0].history.stress.tolist() == [0.0, 1.0, 0.0]
    assert one.boundaries.top == "free" and one.gravity.direction == [0.0, -1.0]
    assert one.joint_sets[1].offset == 0.5 and one.joint_sets[1].point_rule == "vertices"


def test_a_history_is_beside_the_scene_unless_it_is_asked_for(written, tmp_path):
    path = written()
    elsewhere = tmp_path / "far" / "pulse.csv"
    elsewhere.parent.mkdir()
    elsewhere.write_text("0.0, 0.0\n0.01, 2.0\n")
    with pytest.raises(SceneError, match=r"waves\[0\].file = '../pulse.csv': is outside the"):
        load_variant(path, "S", {"waves.0.file": "../pulse.csv"}, asked=False)
    found = load_variant(path, "S", {"waves.0.file": str(elsewhere)})
    assert found.waves[0].history.stress.tolist() == [0.0, 2.0]
    with pytest.raises(SceneError, match=r"waves\[0\].file = 'none.csv': cannot be read"):
        load_variant(path, "S", {"waves.0.file": "none.csv"})


def test_sides_of_a_slope(written):
    """Left, right, bottom and top of an outline where it follows its bounding box; a wave from
    below meets no free surface, one from the left does."""
    slope = [[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [45.0, 40.0], [20.0, 14.0], [0.0, 14.0]]
    changes = {"domain": {"outline": slope}, "record.joints": [], "loads": []}
    path = written()
    assert load_variant(path, "", {**changes, "boundaries.outline": "free"}).boundaries
    with pytest.raises(SceneError, match=r"boundaries\.outline = 'free': must be 'quiet': waves"):
        load_variant(path, "", {**changes, "waves.0.direction": [1.0, 0.0]})


def test_both_kinds_are_read_and_told_apart(written, pillar):
    """A command for one kind of scene only says so in one line, with the file; the error crosses
    processes whole."""
    path = written()
    mass, column = load(path)[0], pillar()
    assert (mass.kind, column.kind) == ("rock mass", "pillar")
    assert pillar_of(column) is column
    with pytest.raises(SceneError, match="is a rock mass; a fit accepts pillars only") as error:
        pillar_of(mass, "a fit")
    assert str(error.value).startswith(f"{path}: domain: ")
    back = pickle.loads(pickle.dumps(error.value))
    assert type(back) is SceneError and str(back) == str(error.value)
    assert (back.where, back.key, back.value) == (str(path), "domain", error.value.value)


def test_a_pillar_imports_nothing_of_rock_masses_or_of_constant_q():
    """Neither shapely nor what cuts, nor the fit of a quality factor."""
    code = (
        "import sys; from jointwave import cases; from jointwave.compare.scenes import find\n"
        "from jointwave.compare.engines import solve\n"
        "solve('jointed-bar', cases.load_variant(find('guo-li-2002/fig-03'), ''))\n"
        "never = 'shapely', 'partition.scene', 'scipy.optimize'\n"
        "print(*(m for m in sys.modules if any(name in m for name in never)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


def test_an_empty_table_of_a_variant_has_its_defaults_unless_it_is_there(written):
    variant = {"name": "heavy", "gravity": {}, "boundaries": {}}
    first, *_, heavy = load(written(variant, gravity=None))
    assert first.gravity is None and heavy.gravity.acceleration == 9.81
    assert heavy.boundaries == first.boundaries


def test_a_variant_changes_one_of_a_list_of_tables(written):
    steep = {"name": "steep", "joint_sets": {"1": {"dip": 80.0}}}
    first, *_, steep = load(written(steep))
    assert [s.dip for s in steep.joint_sets] == [first.joint_sets[0].dip, 80.0]
    assert steep.joint_sets[1].model_dump() == {**first.joint_sets[1].model_dump(), "dip": 80.0}
    allowed = r"variants\[1\].joint_sets.7.dip = 80.0: 7 must be .*of the list, 0 to 1"
    with pytest.raises(SceneError, match=allowed):
        load(written({"name": "none", "joint_sets": {"7": {"dip": 80.0}}}))
