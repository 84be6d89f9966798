"""The scene written by `jointwave new`: every key explained, and runnable unchanged."""

import re
from functools import cache, partial
from itertools import pairwise
from pathlib import Path

import pytest

from jointwave import cases
from jointwave.cases.errors import SceneError
from jointwave.cases.schema.keys import keys
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.cases.warnings import warnings
from jointwave.compare.cli.scene_files import starter, write_new
from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.scenes import SHIPPED

MODELS = {"pillar": Scene, "rock-mass": RockMass}
#: A key, in use or commented out to be chosen, and a heading of a table.
LINE = re.compile(r"(?:# )?(?:\[+(?P<table>[\w.]+)\]+|(?P<key>\w+) = (?P<value>.*?))(?:  #.*)?")


def choices(template):
    """Yield the lines of a template with the key that each has, in its table."""
    table = ""
    for line in starter("x.toml", template).split("[expect]")[0].splitlines():
        found = LINE.fullmatch(line)
        table = (found and found["table"]) or table
        yield line, f"{table}.{found['key']}".lstrip(".") if found and found["key"] else None


@pytest.mark.parametrize("template", MODELS)
def test_it_meets_its_own_expectations_without_a_warning(template):
    (path,) = write_new("mine/first", template=template)
    scenes = cases.load(path)
    assert path.name == "first.toml" and scenes[0].title == "first" and len(scenes) == 2
    for scene in scenes:
        assert warnings(scene) == [] and len(scene.expect) == 2
        solved = cache(partial(solve, scene=scene))
        for pair, bound in scene.expect.items():
            one, other = map(solved, pair.split(" ~ "))
            assert misfit(one, other) <= bound


@pytest.mark.parametrize("template", MODELS)
def test_its_keys_are_those_of_a_scene_each_with_its_meaning(template):
    """A comment stands beside a key or above it; lines fit a screen."""
    known, lines = {key for key, _ in keys(MODELS[template])}, list(choices(template))
    found = [key for _, key in lines if key]
    assert set(found) <= known and len(set(found)) == len(found) > 35
    for (before, _), (line, key) in pairwise(lines):
        assert key is None or "  # " in line or before.startswith("#   ")
        assert len(line) <= 100


#: What a choice may need beside itself, in words.
NEEDS = "p_speed|direction|ricker|must name other sets|has no meaning without|is required"
#: Templates, and the choices that are not understood alone.
CHOICES = {"pillar": 6, "rock-mass": 13}


@pytest.mark.parametrize(("template", "dependent"), CHOICES.items())
def test_each_choice_is_understood(template, dependent):
    """One key at a time: the scene has it, or names in one line what else it needs."""
    refused, path, lines = [], Path("x.toml"), list(choices(template))
    chosen = [(i, key) for i, (line, key) in enumerate(lines) if key and line.startswith("# ")]
    assert len(chosen) > 15
    for i, key in chosen:
        table = key.rpartition(".")[0]
        heads = {f"# [{table}]", f"# [[{table}]]"}
        scene = [one.removeprefix("# ") if one in heads else one for one, _ in lines]
        scene[i] = lines[i][0].removeprefix("# ")
        path.write_text("\n".join(scene))
        try:
            cases.load(path)
        except SceneError as error:
            assert re.search(NEEDS, str(error)), key
            refused.append(key)
    assert len(refused) == dependent, refused


def test_a_copy_keeps_its_comments_and_the_files_that_it_names():
    path, load = write_new("blast.toml", "beyond/blast-history")
    assert path.read_bytes() == (SHIPPED / "beyond" / "blast-history.toml").read_bytes()
    assert load == Path("blast-two-delays.csv")
    assert cases.load(path)[0].load.history is not None


BLAST = "beyond/blast-history"


@pytest.mark.parametrize(
    ("source", "taken"), [(None, "a.toml"), (BLAST, "a.toml"), (BLAST, "blast-two-delays.csv")]
)
def test_nothing_is_replaced(source, taken):
    """Neither a file nor the target of a link; and nothing is written beside it."""
    Path("own").write_text("mine")
    Path(taken).symlink_to("own")
    with pytest.raises(SceneError, match="exists already"):
        write_new("a", source)
    assert Path("own").read_text() == "mine"
    assert {path.name for path in Path().iterdir()} == {"own", taken}


@pytest.mark.parametrize("name", ["", ".toml", ".hidden", "a\nb", "folder/"])
def test_a_name_that_is_none_is_refused(name):
    with pytest.raises(SceneError, match="must be a file name"):
        write_new(name)
    assert not list(Path().iterdir())


def test_the_command_says_what_it_wrote(jointwave):
    """A name that a shell or TOML would read otherwise is quoted."""
    assert jointwave("new", "mine") == ("wrote mine.toml\n", "")
    assert jointwave("new", "mine", code=2).err.count("\n") == 1
    assert jointwave("new", 'a "b"', "--rock-mass") == ('wrote a "b".toml\n', "")
    (path,) = Path().glob("a *.toml")
    assert cases.load(path)[0].title == 'a "b"'
    assert "--out 'a \"b\"'" in path.read_text()
