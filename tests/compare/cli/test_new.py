"""The scene written by `jointwave new`: documented from the models, and runnable unchanged."""

import re
import tomllib

import pytest

import cases
from cases.errors import SceneError
from cases.schema.keys import field_comments, keys
from cases.schema.tables import Pillar
from cases.warnings import warnings
from compare.cli.new import WIDTH, starter, write_new
from compare.cli.templates import PILLAR, ROCK_MASS
from compare.engines import solve
from compare.misfit.metrics import misfit
from compare.scenes import SHIPPED

EXACT = "oblique-joint"
SET, OFFERED = PILLAR.given, PILLAR.offered

#: The other pair of constants of the rock, which the file has by its speeds.
INSTEAD = {"rock.equivalent_modulus", "rock.equivalent_poisson"}


def lines_of(text):
    """Yield (table, line) of a scene's text, the headings of tables that are choices included."""
    table = ""
    for line in text.splitlines():
        heading = re.fullmatch(r"(?:# )?\[+([\w.]+)\]+", line)
        table = heading[1] if heading else table
        yield table, line


def chosen(text, key):
    """Return a scene's text with one of its choices taken."""
    wanted, _, name = key.rpartition(".")
    found = [
        line[2:]
        if table == wanted and (line.startswith(f"# {name} = ") or line[2:] in headings(wanted))
        else line
        for table, line in lines_of(text)
    ]
    return "\n".join(found)


def headings(table):
    return {f"[{table}]", f"[[{table}]]"}


def test_it_is_loaded_and_meets_its_own_expectations(tmp_path):
    """Every variant, every pair."""
    (path,) = write_new(str(tmp_path / "mine" / "first"))
    assert path.name == "first.toml"
    scenes = cases.load(path)
    assert [scene.name for scene in scenes] == ["", "no layer"] and scenes[0].title == "first"
    for scene in scenes:
        for pair, bound in scene.expect.items():
            one, other = (solve(name, scene) for name in pair.split(" ~ "))
            assert misfit(one, other) <= bound
        assert warnings(scene) == []


def test_its_ends_let_waves_out(tmp_path):
    """As well as rigid blocks can, and it says so."""
    path = tmp_path / "x.toml"
    text = starter(path)
    path.write_text(text)
    assert {cases.load(path)[0].ends.start, cases.load(path)[0].ends.end} == {"matched"}
    assert "matched, a dashpot behind the end block's half-block spring, reflects least" in (
        " ".join(text.replace("\n#", "").split())
    )


def test_its_comments_are_those_of_the_models(tmp_path):
    """Meaning and bounds of a key, wherever the line breaks."""
    text = " ".join(starter(tmp_path / "x.toml").split())
    for name in ("length", "side", "block"):
        assert f"# {field_comments(Pillar)[name]}; number > 0" in text
    assert '"free", "quiet", "matched", "fixed"' in text and "whole number ≥ 1 and ≤ 4" in text


@pytest.mark.parametrize("template", [PILLAR, ROCK_MASS])
def test_it_has_every_table_that_a_scene_needs_and_no_key_that_is_none(tmp_path, template):
    known = {key for key, _ in keys(template.model)}
    given, offered = template.given, template.offered
    assert {*given, *offered} <= known and not {*given} & {*offered}
    text = starter(tmp_path / "x.toml", template)
    assert max(map(len, text.splitlines())) <= WIDTH
    for key in (*given, *offered):
        table, _, name = key.rpartition(".")
        shown = [line for where, line in lines_of(text) if where == table]
        assert any(re.match(rf"(# )?{name} = ", line) for line in shown), key


@pytest.mark.parametrize("key", [key for key in OFFERED if key not in INSTEAD])
def test_a_choice_that_is_taken_is_understood(tmp_path, key):
    """One key at a time: the scene has it, or names in one line what else it needs."""
    text = chosen(starter(tmp_path / "x.toml"), key)
    found = tomllib.loads(text)
    for part in key.split("."):
        found = found[part] if isinstance(found, dict) else found[0][part]
    path = tmp_path / "x.toml"
    path.write_text(text)
    needs = {
        "gravity.acceleration": "direction",
        "gravity.static": "direction",
        "load.cycles": "ricker",
        "load.file": "ricker",
    }
    if key in needs:
        with pytest.raises(SceneError, match=needs[key]):
            cases.load(path)
    else:
        assert cases.load(path)


def test_gravity_is_understood_as_a_whole(tmp_path):
    text = starter(tmp_path / "x.toml")
    for key in ("direction", "acceleration", "static"):
        text = chosen(text.replace("# [gravity]", "[gravity]"), f"gravity.{key}")
    path = tmp_path / "x.toml"
    path.write_text(text)
    gravity = cases.load(path)[0].gravity
    assert gravity is not None and not gravity.static


def test_the_other_pair_of_constants_is_understood(tmp_path):
    text = starter(tmp_path / "x.toml")
    for key in INSTEAD:
        text = chosen(text, key)
    path = tmp_path / "x.toml"
    path.write_text(re.sub(r"^[ps]_speed = ", r"# \g<0>", text, flags=re.MULTILINE))
    assert cases.load(path)[0].rock.equivalent_modulus


def test_a_rock_mass_is_loaded_and_meets_its_own_expectations(tmp_path):
    """The scene is runnable unchanged, and gives no warning."""
    (path,) = write_new(str(tmp_path / "mine"), template=ROCK_MASS)
    scenes = cases.load(path)
    assert [(scene.kind, scene.name) for scene in scenes] == [
        ("rock mass", ""),
        ("rock mass", "steeper"),
    ]
    assert warnings(scenes[0]) == warnings(scenes[1]) == []
    results = {name: solve(name, scenes[1]) for name in ("dem", "continuum-jointed", EXACT)}
    assert len(scenes[1].expect) == 2
    for pair, bound in scenes[1].expect.items():
        one, other = (results[name] for name in pair.split(" ~ "))
        assert bound / 10 < misfit(one, other) <= bound


#: What a choice needs beside itself, in words; all others are understood alone.
NEEDS = {
    "joint_sets.ends_at": "must name other sets",
    "joint_sets.scatter": "has no meaning without",
    "joint_sets.seed": "has no meaning without",
    "waves.cycles": "has no meaning for shape 'ricker'",
    "waves.file": "has no meaning for shape 'ricker'",
    **{
        f"loads.{key}": "is required" for key in ("shape", "amplitude", "period", "kind", "opening")
    },
    "prestress.xx": "is required",
    "prestress.yy": "is required",
    "prestress.xy": "is required",
}


@pytest.mark.parametrize("key", ROCK_MASS.offered)
def test_a_choice_in_a_rock_mass_is_understood(tmp_path, key):
    path = tmp_path / "x.toml"
    path.write_text(chosen(starter(path, ROCK_MASS), key))
    if key in NEEDS:
        with pytest.raises(SceneError, match=NEEDS[key]):
            cases.load(path)
    else:
        assert cases.load(path)


def test_a_copy_keeps_its_comments_and_the_files_that_it_names(tmp_path):
    path, load = write_new(str(tmp_path / "blast.toml"), "beyond/blast-history")
    shipped = SHIPPED / "beyond"
    assert path.read_bytes() == (shipped / "blast-history.toml").read_bytes()
    assert load == tmp_path / "blast-two-delays.csv"
    assert cases.load(path)[0].load.history is not None


@pytest.mark.parametrize("source", [None, "beyond/blast-history"])
@pytest.mark.parametrize("taken", ["a.toml", "blast-two-delays.csv"])
def test_nothing_is_replaced(tmp_path, source, taken):
    """Neither a file nor the target of a link; and nothing is written beside it."""
    (tmp_path / "own").write_text("mine")
    (tmp_path / taken).symlink_to(tmp_path / "own")
    if source is None and taken != "a.toml":
        return
    with pytest.raises(SceneError, match="exists already"):
        write_new(str(tmp_path / "a"), source)
    assert (tmp_path / "own").read_text() == "mine"
    assert {path.name for path in tmp_path.iterdir()} == {"own", taken}


@pytest.mark.parametrize("name", ["", ".toml", ".hidden", "a\nb", "folder/"])
def test_a_name_that_is_none_is_refused(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SceneError, match="must be a file name"):
        write_new(name)
    assert not list(tmp_path.iterdir())


def test_the_command_says_what_it_wrote(jointwave, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert jointwave("new", "mine") == ("wrote mine.toml\n", "")
    for arguments in (("mine",), ("x", "--from", "nothing")):
        assert jointwave("new", *arguments, code=2).err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["mine.toml"]
