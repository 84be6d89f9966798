"""Shell completion, tested by the same call as in the shell's script."""

import os
import subprocess
import sys

import pytest

from jointwave.cases.schema.keys import keys
from jointwave.compare.cli.program import main
from jointwave.compare.scenes import shipped_files

SCENE = "guo-li-2002/fig-03"


@pytest.fixture
def complete(monkeypatch, capsys):
    """Return a function that gives what bash is offered for the last word of a line, empty after a
    space."""

    def offered(line, cwd=None):
        asked = {"COMP_WORDS": line, "COMP_CWORD": str(len(line.split(" ")) - 1)}
        with monkeypatch.context() as here, pytest.raises(SystemExit) as end:
            for name, value in {"_JOINTWAVE_COMPLETE": "complete_bash", **asked}.items():
                here.setenv(name, value)
            here.setattr(sys, "argv", ["jointwave"])
            here.setattr(sys.modules["__main__"], "__package__", "")  # or its name were pytest's
            if cwd is not None:
                here.chdir(cwd)
            main()
        said = capsys.readouterr()
        assert said.err == "" and not end.value.code
        return [word for word in said.out.split("\n") if word]

    return offered


def test_commands_and_options(complete):
    assert complete("jointwave com") == ["compare"]
    assert {"--set", "--sweep", "--dry-run"} <= set(complete("jointwave run --"))


def test_scenes_by_name(complete):
    names = [f"{path.parent.name}/{path.stem}" for path in shipped_files()]
    assert complete("jointwave run ") == names
    assert SCENE in complete("jointwave explain guo")
    assert complete("jointwave new x --from nothing") == []


def test_engines_models_and_studies(complete):
    assert complete(f"jointwave run {SCENE} --engine ") == ["dem", "continuum", "exact"]
    assert complete(f"jointwave run {SCENE} --model joi") == ["jointed", "jointed-bar"]
    assert {"free-pillar", "stability"} <= set(complete("jointwave study "))


def test_variants_of_the_scene_that_is_named(complete):
    """A name of two words as bash takes it for one; of no scene, none."""
    assert complete(f"jointwave run {SCENE} --variant ")[0] == "zeta\\ 0.02"
    assert complete("jointwave run nothing.toml --variant ") == []


@pytest.mark.parametrize("option", ["--set", "--sweep"])
def test_keys(option, complete):
    line = f"jointwave run {SCENE} {option} "
    wanted = [f"{key}=" for key, _ in keys() if not key.startswith(("soft_layers.", "segments."))]
    assert complete(line) == wanted and len(wanted) > 40
    assert complete(f"{line}joints.damp") == ["joints.damping_ratio="]


BROKEN = ["[pillar\n", "variants = 3\n"]
BROKEN += ['variants = [1, { name = 2 }, { name = "\\u001b[2J" }]\n']


@pytest.mark.parametrize("text", BROKEN)
def test_a_broken_scene_is_no_message(tmp_path, text, complete):
    """Nor does a name reach the terminal that moves its cursor."""
    (tmp_path / "broken.toml").write_text(text)
    assert complete("jointwave run broken.toml --variant ", cwd=tmp_path) == []


#: What validates scenes, computes and draws; `typer` may bring the last two by itself.
HEAVY = {
    "jointwave.cases.schema",
    "jointwave.cases.read",
    "numpy",
    "scipy",
    "numba",
    "xarray",
    "pandas",
    "matplotlib",
}
HEAVY |= {"shapely", "obspy", "dolfinx", "dem", "continuum", "rich", "pydantic"}
IMPORTED = """
import sys, typer
before = set(sys.modules)
from jointwave.compare.cli.program import main
sys.argv = ["jointwave", *sys.argv[1:]]
try:
    main()
except SystemExit:
    print(*sorted(set(sys.modules) - before), file=sys.stderr)
"""


def imported(*arguments, **environment):
    """Return the modules of HEAVY that a command imports."""
    done = subprocess.run(
        [sys.executable, "-c", IMPORTED, *arguments],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, **environment},
    )
    assert done.stdout
    return HEAVY & set(done.stderr.split())


@pytest.mark.parametrize("option", ["--help", "--version"])
def test_commands_are_listed_without_what_carries_them_out(option):
    assert imported(option) == set()


LINES = ["jointwave com", "jointwave run --model j", "jointwave study f"]
LINES += [f"jointwave run {SCENE} --variant ", f"jointwave run {SCENE} --set joints.damp"]


@pytest.mark.parametrize("line", LINES)
def test_words_are_completed_without_what_validates_and_computes(line):
    """Newer typer converts the words before the last by pydantic; keys are those of the models."""
    place = str(len(line.split(" ")) - 1)
    asked = {"_JOINTWAVE_COMPLETE": "complete_bash", "COMP_WORDS": line, "COMP_CWORD": place}
    models = {"jointwave.cases.schema"} if "--set" in line else set()
    assert imported(**asked) <= {"pydantic"} | models
