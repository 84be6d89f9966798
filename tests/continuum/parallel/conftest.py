"""What the tests of several processes share: real ones, started by mpiexec."""

import subprocess
import sys

import pytest


@pytest.fixture(scope="session")
def under_mpi(mpiexec):
    """Return a function that runs Python with these arguments in `count` processes.

    It gives back the finished process, having checked its exit status.
    """
    launcher, environment = mpiexec

    def run(count, *arguments, code=0):
        command = [launcher, "-n", str(count), sys.executable, *map(str, arguments)]
        done = subprocess.run(
            command, capture_output=True, text=True, env=environment, timeout=1800
        )
        assert done.returncode == code, done.stderr
        return done

    return run


@pytest.fixture(scope="session")
def jointwave(under_mpi):
    """Return a function that runs the command in `count` processes."""
    return lambda count, *arguments, code=0: under_mpi(
        count, "-m", "compare", *arguments, code=code
    )
