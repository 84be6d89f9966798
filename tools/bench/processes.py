"""Two processes over one: whole runs of the continuum under mpiexec.

usage: mpiexec -n N python tools/bench/processes.py CASE (prints freedoms x steps a second)
"""

import os
import shutil
import subprocess
import sys
from functools import partial

from mpi4py import MPI
from rock import network, scene_of
from timing import in_words

from jointwave.continuum import simulate
from jointwave.continuum.run import discrete_and_steps

ROUNDS = 5
STEPS = 4000  # some seconds
FEW = 1000  # the same of a rock mass

#: In a container one is root, which Open MPI does not run as unless told twice.
AS_ROOT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def compared(case: str) -> None:
    """Print the rates of two processes and of one, which take turns, and their ratio."""
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
    """Run a case in all processes there are, and print its rate."""
    masses = case == "rock mass"
    make, steps = (network, FEW) if masses else (partial(scene_of, case), STEPS)
    asked = "jointed", None if masses else 3
    time = discrete_and_steps(make(), *asked)[1].time
    scene = make(**{"time.duration": steps * time.dt})
    a = simulate(scene, *asked, comm=MPI.COMM_WORLD).attrs
    if MPI.COMM_WORLD.rank == 0:
        print(a["degrees_of_freedom"] * a["steps"] / a["seconds_stepping"])


if __name__ == "__main__":
    one_run(sys.argv[1])
