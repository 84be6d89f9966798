"""`jointwave doctor`: what is installed, how to install the rest, and a check of both engines.

Each library is imported in a separate process, so that a crash becomes a line of the table.
"""

import os
import platform
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import version
from math import nan
from typing import Any

import typer

from jointwave.cases.gmsh_file import INSTALL as GMSH
from jointwave.compare.cli import terminal
from jointwave.compare.cli.commands import Doctor
from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.scenes import load
from jointwave.compare.solvers.continuum import INSTALL
from jointwave.numerics import jit

#: The self-checks: pairs of engine and exact solution, with the library that each needs.
PAIRS = {"dem ~ lattice": "numba", "continuum-jointed ~ jointed-bar": "dolfinx"}
LIBRARIES = "numpy", "scipy", "numba", "pandas", "xarray", "matplotlib", "obspy"
COMPILER = "C compiler"
#: The parts to look for, and how to install each.
PARTS = {name: f"pip install {name}" for name in LIBRARIES} | {
    "dolfinx": f"for the continuum: {INSTALL}",
    COMPILER: "for dolfinx's forms: apt install gcc python3-dev, or conda install c-compiler",
    "gmsh": f"for triangles and tetrahedra: {GMSH}",
    "mpi4py.MPI": "for mpiexec: comes with dolfinx; or pip install mpi4py",
    "petsc4py.PETSc": "for implicit steps and static states: comes with dolfinx",
    "pyvista": "for jointwave view: pip install 'jointwave[view]'",
    "imageio_ffmpeg": "for jointwave animate: pip install imageio-ffmpeg",
    "mpiexec": "apt install openmpi-bin; as root set OMPI_ALLOW_RUN_AS_ROOT=1 and "
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1",
}
#: Imports a module and prints its version; pip's dolfinx brings the MPI that other modules need.
IMPORT = """
from contextlib import suppress
with suppress(ImportError): import dolfinx_solver
import {0}
print({1}.__version__)
"""
#: Compiles a module as dolfinx compiles its forms, and prints the compiler.
COMPILE = """
import os, shlex, subprocess, sysconfig, tempfile
import cffi
source = cffi.FFI()
source.cdef("int one(void);")
source.set_source("one", "int one(void) { return 1; }")
with tempfile.TemporaryDirectory() as folder:
    source.compile(tmpdir=folder)
command = shlex.split(os.environ.get("CC") or sysconfig.get_config_var("CC"))[0]
print(subprocess.check_output([command, "--version"], text=True).splitlines()[0])
"""
SEEN = "from mpi4py.MPI import COMM_WORLD as c; c.rank or print(c.size, 'processes in one job')"

Facts = dict[str, Any]


def doctor(asked: Doctor) -> None:
    """Print what is installed, and exit with 0 if both engines pass their checks, else 1."""
    with terminal.progress("looking"):
        found = examine()
    (terminal.print_json if asked.as_json else terminal.show_facts)(found)
    raise typer.Exit(0 if found["well"] else 1)


def examine() -> Facts:
    """Return the state of every part, and the checks of the engines whose library is installed."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        parts = {one["part"]: one for one in pool.map(look, PARTS)}
    needed = {pair: parts[name] for pair, name in PAIRS.items()}
    checks = [check(pair, one) for pair, one in needed.items() if one["state"] != "missing"]
    return {
        "jointwave": version("jointwave"),
        "Python": f"{platform.python_version()} ({sys.executable})",
        "parts": list(parts.values()),
        "kernel_cache": str(jit.DIRECTORY.parent),
        "self_check": checks,
        "well": all(one["holds"] for one in checks),
    }


def look(part: str) -> Facts:
    """Return whether a part is found, missing or broken, and how to install it."""
    special = {"mpiexec": SEEN, COMPILER: COMPILE}
    program = special.get(part) or IMPORT.format(part, part.partition(".")[0])
    launcher = ["mpiexec", "-n", str(min(2, os.cpu_count() or 1))] if part == "mpiexec" else []
    facts = {"part": part, "state": "broken", "hint": PARTS[part]}
    command = [*launcher, sys.executable, "-c", program]
    try:
        done = subprocess.run(command, input="", capture_output=True, text=True)
    except FileNotFoundError:
        return facts | {"state": "missing", "found": "is not on the PATH"}
    if done.returncode == 0:
        return facts | {"state": "found", "found": done.stdout.strip(), "hint": ""}
    said = [line for line in done.stderr.splitlines() if any(map(str.isalnum, line))]
    why = said[-1 if "Traceback" in done.stderr else 0] if said else "no message"
    if why.startswith("ModuleNotFoundError"):
        return facts | {"state": "missing", "found": why.partition(": ")[2]}
    return facts | {"found": f"{why[:300]} (exit code {done.returncode})"}


def check(pair: str, needed: Facts) -> Facts:
    """Return the misfit of an engine from its exact solution on the paper's free pillar (nan if the
    needed part is broken), and its bound from the scene's [expect]."""
    scene, found, reason = load("guo-li-2002/fig-03"), nan, f"{needed['part']}: {needed['found']}"
    if needed["state"] == "found":
        try:
            found, reason = misfit(*(solve(name, scene) for name in pair.split(" ~ "))), ""
        except Exception as error:
            reason = f"{type(error).__name__}: {error}"
    bound = scene.expect[pair]
    return {
        "pair": pair,
        "misfit": found,
        "bound": bound,
        "reason": reason,
        "holds": found <= bound,
    }
