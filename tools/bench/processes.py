"""Rates of whole runs of the continuum under mpiexec: two processes over one.

usage: mpiexec -n N python tools/bench/processes.py CASE (prints freedoms x steps a second)
"""

import os
import shutil
import subprocess
import sys

from mpi4py import MPI
from rock import scene_of
from timing import in_words

from jointwave.continuum import simulate
from jointwave.continuum.plan import plan_of

ROUNDS = 5
#: By case: steps of a run of some seconds, and size of the elements, m.
CASES = {"hexahedra of order 3": (2000, 1.0), "triangles of order 2": (500, 0.2)}

#: Open MPI runs as root, as in a container, only if both variables are set.
AS_ROOT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def compared(case: str) -> None:
    """Print the rates of two processes and of one, measured in turn, and their ratio."""
    if shutil.which("mpiexec") is None:
        print("  two processes: no mpiexec here")
        return
    pairs = [(_under_mpi(case, 2), _under_mpi(case, 1)) for _ in range(ROUNDS)]
    print(f"  two processes over one, whole runs: {in_words(pairs)}", flush=True)


def _under_mpi(case: str, count: int) -> float:
    command = ("mpiexec", "-n", str(count), sys.executable, __file__, case)
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, env=AS_ROOT)
    return float(done.stdout)


def one_run(case: str) -> None:
    """Run a case in all processes, and print its rate."""
    steps, size = CASES[case]
    dt = plan_of(scene_of(case, size)).choice.time.dt
    scene = scene_of(case, size, steps * dt)
    about = simulate(scene, comm=MPI.COMM_WORLD).attrs
    if MPI.COMM_WORLD.rank == 0:
        print(about["degrees_of_freedom"] * about["steps"] / about["seconds_stepping"])


if __name__ == "__main__":
    one_run(sys.argv[1])
