"""Shell completion, tested by the same call as in the shell's script."""

import os
import subprocess
import sys

import pytest

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


def test_engines(complete):
    assert complete(f"jointwave run {SCENE} --engine ") == ["dem", "continuum", "exact"]


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


LINES = ["jointwave com", "jointwave run guo", f"jointwave run {SCENE} --engine d"]


@pytest.mark.parametrize("line", LINES)
def test_words_are_completed_without_what_validates_and_computes(line):
    """Newer typer converts the words before the last by pydantic."""
    place = str(len(line.split(" ")) - 1)
    asked = {"_JOINTWAVE_COMPLETE": "complete_bash", "COMP_WORDS": line, "COMP_CWORD": place}
    assert imported(**asked) <= {"pydantic"}
