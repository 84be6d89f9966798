"""What the tests of several processes share: real ones, started by mpiexec."""

import json
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


@pytest.fixture(scope="session")
def under_mpi(mpiexec):
    """Return a function that runs Python with these arguments in `count` processes.

    It gives back the finished process, having checked its exit status.
    """
    launcher, environment = mpiexec

    def run(count, *arguments, code=0):
        command = [*launcher, "-n", str(count), sys.executable, *map(str, arguments)]
        done = subprocess.run(
            command, capture_output=True, text=True, env=environment, timeout=1800
        )
        assert done.returncode == code, done.stderr
        return done

    return run


@pytest.fixture(scope="session")
def in_turn(under_mpi, without_warnings):
    """Return a function that runs commands one after the other in the same `count` processes.

    It gives for each its exit code, its output and the lines of its errors.
    """

    def run(count, *commands):
        asked = json.dumps([[*map(str, arguments)] for arguments in commands])
        done = under_mpi(count, "-c", IN_TURN, asked)
        assert "Traceback" not in done.stderr
        *out, rest = re.split(r"^ended (\d+)\n", done.stdout, flags=re.MULTILINE)
        *said, _ = re.split(r"^ended \d+\n", done.stderr, flags=re.MULTILINE)
        assert len(said) == len(commands) and rest == ""
        lines = map(without_warnings, said)
        return list(zip(map(int, out[1::2]), out[::2], lines, strict=True))

    return run
