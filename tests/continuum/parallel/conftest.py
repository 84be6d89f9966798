"""What the tests of several processes share: real ones, started by mpiexec."""

import os
import shutil
import subprocess
import sys

import pytest

#: Open MPI refuses root and more processes than processors unless told otherwise, binds all jobs
#: to the same processors, spins while it waits, and may complain of the network, which nothing here
#: uses; others ignore these.
OPEN_MPI = {
    "OMPI_MCA_btl": "^tcp",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "PRTE_ALLOW_RUN_AS_ROOT": "1",
    "PRTE_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "PRTE_MCA_hwloc_default_binding_policy": "none",
}


@pytest.fixture
def under_mpi():
    """Return a function that runs Python with these arguments in `count` processes.

    It gives back the finished process, having checked its exit status.
    """
    mpiexec = shutil.which("mpiexec")
    if mpiexec is None:
        pytest.skip("no mpiexec here")

    def run(count, *arguments, code=0):
        command = [mpiexec, "-n", str(count), sys.executable, *map(str, arguments)]
        environment = {**os.environ, **OPEN_MPI}
        done = subprocess.run(
            command, capture_output=True, text=True, env=environment, timeout=1800
        )
        assert done.returncode == code, done.stderr
        return done

    return run


@pytest.fixture
def jointwave(under_mpi):
    """Return a function that runs the command in `count` processes."""
    return lambda count, *arguments, code=0: under_mpi(
        count, "-m", "compare", *arguments, code=code
    )
