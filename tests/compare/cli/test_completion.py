"""Shell completion, by the same call as in the shell's script; and what each command imports."""

import os
import subprocess
import sys

import pytest

from jointwave.compare.cli.program import main
from jointwave.compare.scenes import shipped_files

SCENE = "guo-li-2002/fig-03"


def asked(line):
    """Return what bash sets for the last word of a line, empty after a space."""
    place = str(len(line.split(" ")) - 1)
    return {"_JOINTWAVE_COMPLETE": "complete_bash", "COMP_WORDS": line, "COMP_CWORD": place}


@pytest.fixture
def complete(monkeypatch, capsys):
    """Return a function that gives what bash is offered for the last word of a line."""

    def offered(line):
        with monkeypatch.context() as here, pytest.raises(SystemExit) as end:
            for name, value in asked(line).items():
                here.setenv(name, value)
            here.setattr(sys, "argv", ["jointwave"])
            here.setattr(sys.modules["__main__"], "__package__", "")  # or its name were pytest's
            main()
        said = capsys.readouterr()
        assert said.err == "" and not end.value.code
        return [word for word in said.out.split("\n") if word]

    return offered


def test_commands_options_scenes_and_engines_are_completed(complete):
    assert complete("jointwave com") == ["compare"]
    assert {"--set", "--sweep", "--dry-run"} <= set(complete("jointwave run --"))
    names = [f"{path.parent.name}/{path.stem}" for path in shipped_files()]
    assert complete("jointwave run ") == names
    assert SCENE in complete("jointwave explain guo")
    assert complete("jointwave new x --from nothing") == []
    assert complete(f"jointwave run {SCENE} --engine ") == ["dem", "continuum", "exact"]


#: What draws, and what else validates scenes and computes.
DRAWN = {"matplotlib", "pyvista", "imageio_ffmpeg", "PIL", "jinja2"}
ROCK = {"dolfinx", "petsc4py", "gmsh", "obspy", "shapely", "jointwave.continuum"}
HEAVY = DRAWN | ROCK | {"numpy", "scipy", "numba", "xarray", "pandas", "jointwave.dem"}
HEAVY |= {"jointwave.cases.schema", "jointwave.cases.read", "rich", "pydantic"}
#: `typer` may import some of it by itself.
IMPORTED = """
import sys, typer
before = set(sys.modules)
from jointwave.compare.cli.program import main
sys.argv = ["jointwave", *sys.argv[1:]]
try:
    main()
except SystemExit as end:
    assert not end.code
    print(*sorted(set(sys.modules) - before), file=sys.stderr)
"""


@pytest.mark.parametrize(
    ("arguments", "line", "heavy"),
    [
        (("--help",), "", HEAVY),
        (("animate", "--help"), "", DRAWN | {"xarray", "dolfinx", "numba"}),
        # Newer typer converts the words before the last by pydantic.
        ((), f"jointwave run {SCENE} --engine d", HEAVY - {"pydantic"}),
        (("run", SCENE, "--variant", ""), "", DRAWN - {"PIL"} | ROCK),
    ],
)
def test_a_command_imports_nothing_that_it_does_not_use(arguments, line, heavy, tmp_path):
    """Neither help nor completion what carries commands out, nor blocks what draws or runs rock."""
    environment = os.environ | (asked(line) if line else {})
    out = ("--out", str(tmp_path)) if "run" in arguments else ()
    done = subprocess.run(
        [sys.executable, "-c", IMPORTED, *arguments, *out],
        capture_output=True,
        text=True,
        check=True,
        env=environment,
    )
    assert done.stdout and heavy & set(done.stderr.split()) == set()
