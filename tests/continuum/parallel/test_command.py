"""The command in several processes: what goes wrong is said once, and ends all of them."""

import json
import os
import subprocess
import sys

import pytest

SCENE = ("guo-li-2002/fig-03", "--variant", "")
CONTINUUM = ("--engine", "continuum", "--model", "jointed")
SHORT = (
    *("--set", "pillar.length=3.0", "--set", "record.stress=[1.0]", "--set", "time.duration=2e-3"),
    *("--set", "numerics.continuum.elements_per_block=1"),
    *("--set", "numerics.continuum.scheme='explicit'"),
)


@pytest.fixture
def said(without_warnings):
    """Return a function that gives the lines that the command itself has printed as errors."""

    def errors(done):
        assert "Traceback" not in done.stderr
        lines = without_warnings(done.stderr)
        return [line for line in lines if line.startswith("jointwave: ")]

    return errors


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (("run", *SCENE, *CONTINUUM, "--set", "pillar.length=-1"), 2, "pillar.length = -1"),
        (("run", "no-such.toml", *CONTINUUM), 2, "no-such.toml"),
        (("compare", *SCENE), 2, "mpiexec: jointwave compare works in one process"),
        (("explain", *SCENE), 2, "mpiexec: jointwave explain works in one process"),
        (
            ("run", *SCENE, *CONTINUUM, *SHORT, "--set", "numerics.continuum.step_fraction=1.5"),
            2,
            "above the critical step",
        ),
        (
            (
                *("run", *SCENE, *CONTINUUM, *SHORT, "--set", "time.duration=0.02"),
                *("--set", "numerics.continuum.step_fraction=1.2"),
                *("--set", "numerics.continuum.allow_unstable=true"),
            ),
            3,
            "the continuum ran away",
        ),
    ],
)
def test_what_goes_wrong_is_one_line_of_one_process(
    arguments, code, words, jointwave, said, tmp_path
):
    """All processes meet the same mistake: one says so, all leave with the same status."""
    where = ("--out", tmp_path) if arguments[0] != "explain" else ()
    (line,) = said(jointwave(2, *arguments, *where, code=code))
    assert words in line
    left = {path.name for path in tmp_path.rglob("*.nc")}
    assert left == ({"continuum-jointed.stopped.nc"} if code == 3 else set())


def test_more_processes_than_cells_are_refused(jointwave, said, tmp_path):
    """There is nothing that some of them could do."""
    two_cells = ("--set", "pillar.length=1.0", "--set", "record.stress=[0.5]")
    arguments = ("run", *SCENE, *CONTINUUM, *SHORT, *two_cells, "--out", tmp_path)
    (line,) = said(jointwave(3, *arguments, code=2))
    assert line == "jointwave: mpiexec: -n = 3: must be at most 2, the cells of the mesh"


#: One process fails where the others wait for it.
SERIAL = """
import sys
from mpi4py import MPI
from compare.cli import program
from continuum import build
from continuum.parallel import body

def broken(*arguments):
    raise {error}

if MPI.COMM_WORLD.rank == {rank}:
    {function} = broken
sys.argv = ["jointwave", *sys.argv[1:]]
program.main()
"""


@pytest.mark.parametrize(
    ("function", "rank"), [("body.restrict", 0), ("body.held_share", 2), ("build.weight_of", 2)]
)
def test_a_process_that_fails_alone_ends_all(rank, function, under_mpi, said, tmp_path):
    """Others wait for what it would have sent them; its line is the only one."""
    program = SERIAL.format(error="MemoryError('of one')", rank=rank, function=function)
    arguments = ("run", *SCENE, *CONTINUUM, *SHORT, "--out", tmp_path)
    done = under_mpi(3, "-c", program, *arguments, code=2)
    assert said(done) == ["jointwave: not enough memory: of one"]


def test_a_mistake_of_the_program_on_one_process_ends_all(under_mpi, said, tmp_path):
    """Its line says where the bug is, and no processes are left waiting."""
    program = SERIAL.format(error="KeyError('bug')", rank=1, function="build.weight_of")
    arguments = ("run", *SCENE, *CONTINUUM, *SHORT, "--out", tmp_path)
    done = under_mpi(3, "-c", program, *arguments, code=1)
    (line,) = said(done)
    assert "a fault of the program, KeyError" in line and "'bug'" in line


def test_rigid_blocks_run_once_in_the_first_process(jointwave, tmp_path):
    """Only the continuum is shared out; results, and what is said of them, are those of one."""
    engines = ("--engine", "dem", "--engine", "exact", "--model", "lattice")
    done = jointwave(2, "run", *SCENE, *engines, *SHORT, "--out", tmp_path, "--json")
    facts = json.loads(done.stdout)
    assert [fact["engine"] for fact in facts] == ["dem", "lattice"]
    assert {path.name for path in tmp_path.iterdir()} == {"dem.nc", "exact-lattice.nc"}


def test_a_mistake_of_the_first_process_reaches_the_others(said, jointwave, tmp_path):
    """Rigid blocks that go unstable, or a folder that cannot be written, end all at once."""
    blocked = tmp_path / "file"
    blocked.write_text("")
    (line,) = said(jointwave(2, "run", *SCENE, *SHORT, "--out", blocked / "folder", code=2))
    assert "Not a directory" in line


def test_an_mpiexec_of_another_mpi_is_refused(
    said,
):
    """Its processes would not know of each other, and all write the same file."""
    environment = {**os.environ, "MV2_COMM_WORLD_SIZE": "4"}
    command = [sys.executable, "-m", "compare", "run", *SCENE]
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    assert done.returncode == 2
    assert said(done) == [
        "jointwave: mpiexec: -n = 4: belongs to another MPI than mpi4py, which sees one process"
    ]
