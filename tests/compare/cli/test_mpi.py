"""The command in several processes: what goes wrong is said once, and ends all of them."""

import json
import os
import re
import subprocess
import sys

import pytest

#: Runs commands in turn in the same processes; after each, the first says how it has ended.
IN_TURN = """
import json, sys
from mpi4py import MPI
from jointwave.compare.cli import program

ours = sys.stdout, sys.stderr
for arguments in json.loads(sys.argv[1]):
    sys.stdout, sys.stderr = ours
    sys.argv = ["jointwave", *arguments]
    try:
        program.main()
    except SystemExit as end:
        code = end.code
    MPI.COMM_WORLD.Barrier()
    if MPI.COMM_WORLD.rank == 0:
        for stream in ours:
            print("ended", code, file=stream, flush=True)
"""

SCENE = ("guo-li-2002/fig-03", "--variant", "")
RUN = ("run", *SCENE, "--engine", "continuum", "--model", "jointed")
SHORT = (
    *("--set", "pillar.length=3.0", "--set", "record.stress=[1.0]", "--set", "time.duration=2e-3"),
    *("--set", "numerics.continuum.elements_per_block=1"),
    *("--set", "numerics.continuum.scheme='explicit'"),
)
BLOCKS = ("run", *SCENE, "--engine", "dem", "--engine", "exact", "--model", "lattice", *SHORT)
FRACTION = "numerics.continuum.step_fraction"
LOST = (
    *("--set", "time.duration=0.02", "--set", f"{FRACTION}=1.2"),
    *("--set", "numerics.continuum.allow_unstable=true"),
)
ABOVE = ("--set", f"{FRACTION}=1.5")
TINY = ("--set", "pillar.length=1.0", "--set", "record.stress=[0.5]")
TOO_MANY = "jointwave: mpiexec: -n = 3: is too many for a mesh of so few cells: 2"

#: What all processes are asked, one command after the other; its exit code and words of its line.
MISTAKES = {
    "a bad value": ((*RUN, "--set", "pillar.length=-1"), 2, "length = -1"),
    "a comparison": (("compare", *SCENE), 2, "mpiexec: jointwave compare runs in one process"),
    "a step above the critical": ((*RUN, *SHORT, *ABOVE), 2, "above the critical step"),
    "a run that is lost": ((*RUN, *SHORT, *LOST), 3, "the continuum diverged"),
    "more processes than cells": ((*RUN, *SHORT, *TINY), 2, TOO_MANY),
    "a folder that cannot be": (("run", *SCENE, *SHORT), 2, "Not a directory"),
}


@pytest.fixture(scope="module")
def under_mpi(mpiexec):
    """Return a function that gives Python as it has run in some processes, to an exit status."""
    launcher, environment = mpiexec

    def run(*arguments, code=0, count=3):
        command = [*launcher, "-n", str(count), sys.executable, *map(str, arguments)]
        done = subprocess.run(
            command, capture_output=True, text=True, env=environment, timeout=1800
        )
        assert done.returncode == code, done.stderr
        return done

    return run


def said(stderr):
    """Return the lines that the command itself has printed as errors."""
    assert "Traceback" not in stderr
    lines = [line for line in stderr.splitlines() if line.startswith("jointwave: ")]
    return [line for line in lines if not line.startswith("jointwave: warning: ")]


@pytest.fixture(scope="module")
def told(under_mpi, tmp_path_factory):
    """Return what three processes say of each mistake, its exit code and its folder, by name; and
    what a run of rigid blocks after all of them prints, in the same processes, and its folder."""
    place = tmp_path_factory.mktemp("mistakes")
    (place / "file").write_text("")
    folders = {name: place / str(i) for i, name in enumerate([*MISTAKES, "blocks"])}
    folders["a folder that cannot be"] = place / "file" / "folder"
    asked = {name: arguments for name, (arguments, *_) in MISTAKES.items()}
    asked["blocks"] = (*BLOCKS, "--json")
    commands = [[*one, "--out", str(folders[name])] for name, one in asked.items()]
    done = under_mpi("-c", IN_TURN, json.dumps(commands))
    *out, rest = re.split(r"^ended (\d+)\n", done.stdout, flags=re.MULTILINE)
    *errors, _ = re.split(r"^ended \d+\n", done.stderr, flags=re.MULTILINE)
    assert len(errors) == len(commands) and rest == ""
    codes, printed = map(int, out[1::2]), out[::2]
    ends = zip(map(said, errors), codes, printed, folders.values(), strict=True)
    return dict(zip(folders, ends, strict=True))


@pytest.mark.parametrize("name", MISTAKES)
def test_what_goes_wrong_is_one_line_of_one_process(name, told):
    (line,), code, _, folder = told[name]
    assert code == MISTAKES[name][1] and MISTAKES[name][2] in line
    left = {path.name for path in folder.rglob("*.nc")} if folder.is_dir() else set()
    assert left == ({"continuum-jointed.stopped.nc"} if code == 3 else set())


def test_rigid_blocks_run_once_in_the_first_process(told):
    """Only the continuum is shared out; results, and what is said of them, are those of one."""
    errors, code, printed, folder = told["blocks"]
    assert code == 0 and errors == []
    assert [fact["engine"] for fact in json.loads(printed)] == ["dem", "lattice"]
    assert {path.name for path in folder.iterdir()} == {"dem.nc", "exact-lattice.nc"}


STUDY = """
title = "Elements"
scene = "guo-li-2002/fig-03"
finest = "jointed-bar"
changes = { "pillar.length" = 3.0, "record.stress" = [1.0], "time.duration" = 2e-3 }
[[curves]]
label = "jointed rock"
method = "continuum-jointed"
own = "jointed-bar"
vary = { "numerics.continuum.elements_per_block" = [1, 2] }
"""


def test_a_study_of_deformable_rock_ends(under_mpi, tmp_path):
    """PETSc, which points of a study import, starts in all processes together or waits for ever."""
    path, out = tmp_path / "study.toml", tmp_path / "out"
    path.write_text(STUDY)
    start = "from jointwave.compare.cli import program; program.main()"
    under_mpi("-c", start, "study", path, "--out", out, count=2)
    assert (out / "study.csv").is_file()


#: One process fails where the others wait for it, which is told at once: they never arrive.
SERIAL = """
import sys
from mpi4py import MPI
from jointwave.compare.cli import program
from jointwave.compare.runs import processes
from jointwave.continuum import problem
from jointwave.continuum.processes import leapfrog as shared

def broken(*arguments, **named):
    raise {error}

processes.PATIENCE = 0.1  # s
if MPI.COMM_WORLD.rank == {rank}:
    {function} = broken
sys.argv = ["jointwave", *sys.argv[1:]]
program.main()
"""


@pytest.mark.parametrize(
    ("rank", "function", "error", "code", "words"),
    [
        (0, "shared.share_of", "MemoryError('of one')", 2, ["not enough memory: of one"]),
        (1, "problem.weight_of", "KeyError('bug')", 1, ["internal error, KeyError", "'bug'"]),
    ],
)
def test_a_process_that_fails_alone_ends_all(
    rank, function, error, code, words, under_mpi, tmp_path
):
    """Others wait for what it would have sent them; its line is the only one, of a mistake of the
    program too."""
    program = SERIAL.format(error=error, rank=rank, function=function)
    done = under_mpi("-c", program, *RUN, *SHORT, "--out", tmp_path, code=code, count=2)
    (line,) = said(done.stderr)
    assert all(word in line for word in words)


def test_an_mpiexec_of_another_mpi_is_refused():
    """Its processes would not know of each other, and all write the same file."""
    environment = {**os.environ, "MV2_COMM_WORLD_SIZE": "4"}
    command = [sys.executable, "-m", "jointwave", "run", *SCENE]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    (line,) = said(done.stderr)
    assert done.returncode == 2 and line.startswith("jointwave: mpiexec: -n = 4: ")
    assert line.endswith("belongs to another MPI than mpi4py, which sees one process")
