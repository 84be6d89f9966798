"""`jointwave doctor`: what is installed, how to get what is missing, and whether both engines are
right on this machine.

Each library is imported in a process of its own, so that one that crashes is a line of the table.
"""

import os
import platform
import subprocess
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from importlib.metadata import version
from math import nan
from typing import Any

from jointwave import cases
from jointwave.cases.gmsh_file import INSTALL as GMSH
from jointwave.compare.cli.terminal import print_json, say, show_facts
from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.scenes import SHIPPED
from jointwave.compare.solvers.continuum import INSTALL
from jointwave.numerics import jit

SCENE = SHIPPED / "guo-li-2002" / "fig-03.toml"
#: The self-checks: pairs of an engine and its exact solution, with the library that each needs.
PAIRS = {"dem ~ lattice": "numba", "continuum-jointed ~ jointed-bar": "basix"}
#: The modules that are looked for, and how to get each.
MODULES = {
    **{
        name: f"pip install {name}"
        for name in ("numpy", "scipy", "numba", "pandas", "xarray", "matplotlib", "obspy")
    },
    "basix": f"for the continuum: {INSTALL}",
    "gmsh": f"for triangles and tetrahedra: {GMSH}",
    "mpi4py.MPI": "for mpiexec: comes with dolfinx; or pip install mpi4py",
    "petsc4py.PETSc": "for implicit steps and static states: comes with dolfinx",
    "dolfinx": "to compare with plain dolfinx: apt install python3-dolfinx",
    "pyvista": "for jointwave view: pip install 'jointwave[view]'",
    "imageio_ffmpeg": "for jointwave animate: pip install imageio-ffmpeg",
}
#: Imports a module and prints a version, with the MPI of pip's dolfinx where its libraries need it.
PROGRAM = """
from contextlib import suppress
with suppress(ImportError): import dolfinx_solver
import {0}
print({1}.__version__)
"""
SEEN = "from mpi4py.MPI import COMM_WORLD as c; c.rank or print(c.size, 'processes in one job')"
LAUNCHER = ["mpiexec", "-n", str(min(2, os.cpu_count() or 1)), sys.executable, "-c", SEEN]
LAUNCH = "apt install openmpi-bin; as root set OMPI_ALLOW_RUN_AS_ROOT=1 and "
LAUNCH += "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1"

Facts = dict[str, Any]


def examine(progress: Callable[[float], None]) -> Facts:
    """Look for every part, then check the engines whose library is there."""
    commands = {
        name: [sys.executable, "-c", PROGRAM.format(name, name.partition(".")[0])]
        for name in MODULES
    } | {"mpiexec": LAUNCHER}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        parts = list(pool.map(look, commands, commands.values()))
    by_name, checks = {one["part"]: one for one in parts}, list[Facts]()
    for pair, needed in PAIRS.items():
        progress(0.3 + 0.35 * len(checks))
        if (part := by_name[needed])["state"] != "missing":
            checks.append(check(pair, part))
    well, cache = all(one["holds"] for one in checks), str(jit.DIRECTORY.parent)
    return {"parts": parts, "kernel_cache": cache, "self_check": checks, "well": well}


def look(name: str, command: list[str]) -> Facts:
    """Return whether a part is found, missing or broken: what its command prints, or how it ends,
    with what to do about it."""
    facts = {"part": name, "state": "broken", "hint": (MODULES | {"mpiexec": LAUNCH})[name]}
    try:
        done = subprocess.run(command, input="", capture_output=True, text=True)
    except FileNotFoundError:
        return facts | {"state": "missing", "found": "is not on the PATH"}
    if done.returncode == 0:
        return {"part": name, "state": "found", "found": done.stdout.strip(), "hint": ""}
    why = [line for line in done.stderr.splitlines() if any(map(str.isalnum, line))]
    last = why[-1 if "Traceback" in done.stderr else 0] if why else "no message"
    if last.startswith("ModuleNotFoundError"):
        return facts | {"state": "missing", "found": last.partition(": ")[2]}
    return facts | {"found": f"{last[:300]} (exit code {done.returncode})"}


def check(pair: str, needed: Facts) -> Facts:
    """Return how far an engine is from its exact solution on the paper's free pillar, whose own
    [expect] is the bound; not a number where the part that it needs is broken."""
    scene, far, reason = cases.load_variant(SCENE), nan, f"{needed['part']}: {needed['found']}"
    if needed["state"] == "found":
        try:
            far, reason = misfit(*(solve(name, scene) for name in pair.split(" ~ "))), ""
        except Exception as error:
            reason = f"{type(error).__name__}: {error}"
    bound = scene.expect[pair]
    return {"pair": pair, "misfit": far, "bound": bound, "reason": reason, "holds": far <= bound}


def show_health(found: Facts, as_json: bool) -> None:
    """Print every part, and what the engines' checks came to."""
    if as_json:
        print_json(found)
        return
    say(f"jointwave {version('jointwave')}, Python {platform.python_version()} ({sys.executable})")
    show_facts(found)
