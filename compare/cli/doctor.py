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
from time import perf_counter
from typing import NamedTuple

from jointwave import cases
from jointwave.cases.gmsh_file import INSTALL as GMSH
from jointwave.compare.cli.terminal import print_json, say, show_table
from jointwave.compare.engines import solve
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.scenes import SHIPPED
from jointwave.compare.solvers.continuum import INSTALL
from jointwave.numerics import jit

SCENE = SHIPPED / "guo-li-2002" / "fig-03.toml"
#: The self-checks: pairs of an engine and its exact solution, with the library that each needs.
PAIRS = {"dem ~ lattice": "numba", "continuum-jointed ~ jointed-bar": "basix"}
PATIENCE = 120.0  # s, for one library
VIEW = "for jointwave view: pip install 'jointwave[view]'"
COLOURS = {"missing": "yellow", "broken": "bold red"}

#: Imports a module and prints a version, with the MPI of pip's dolfinx where its libraries need it.
PROGRAM = """
from contextlib import suppress
with suppress(ImportError): import dolfinx_solver
import {0} as module
print({1})
"""
OWN = "module.__version__"
#: What is looked for: module, version, and how to get it.
PARTS = {
    name: (name, OWN, f"pip install {name}")
    for name in ("numpy", "scipy", "numba", "pandas", "xarray", "matplotlib", "obspy")
} | {
    "basix": ("basix", OWN, f"for the continuum: {INSTALL}"),
    "gmsh": ("gmsh", OWN, f"for triangles and tetrahedra: {GMSH}"),
    "MPI": (
        "mpi4py.MPI",
        "module.Get_library_version().split(', package')[0]",
        "for mpiexec: comes with dolfinx; or pip install mpi4py",
    ),
    "PETSc": (
        "petsc4py.PETSc",
        "'.'.join(map(str, module.Sys.getVersion())), module.ScalarType.__name__",
        "for implicit steps and static states: comes with dolfinx",
    ),
    "dolfinx": ("dolfinx", OWN, "for --vtx: apt install python3-dolfinx"),
    "VTK": ("vtkmodules.all", "module.VTK_VERSION", VIEW),
    "pyvista": ("pyvista", OWN, VIEW),
    "ffmpeg": (
        "imageio_ffmpeg",
        "module.get_ffmpeg_version()",
        "for jointwave animate: pip install imageio-ffmpeg",
    ),
}
RANKS = str(min(2, os.cpu_count() or 1))
SEEN = "from mpi4py.MPI import COMM_WORLD as c; c.rank or print(c.size, 'processes in one job')"
LAUNCHER = "apt install openmpi-bin; as root set OMPI_ALLOW_RUN_AS_ROOT=1 and "
LAUNCHER += "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1"


class Part(NamedTuple):
    """A line of the table: state is "found", "missing" or "broken"; found is the version, or what
    went wrong; hint says how to get it."""

    part: str
    state: str
    found: str
    hint: str = ""


class Check(NamedTuple):
    """A pair, its relative L2 misfit and the bound on it; nan and a reason where not measured."""

    pair: str
    misfit: float
    bound: float
    seconds: float = nan
    reason: str = ""

    @property
    def holds(self) -> bool:
        """Whether the misfit is within the bound."""
        return self.misfit <= self.bound


def examine(progress: Callable[[float], None]) -> tuple[list[Part], list[Check]]:
    """Look for every part, then check the engines that are installed."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        parts = list(pool.map(look, PARTS))
    launcher = ["mpiexec", "-n", RANKS, sys.executable, "-c", SEEN]
    parts.append(_part("mpiexec", launcher, LAUNCHER))
    by_name, checks = {part.part: part for part in parts}, list[Check]()
    for pair, needed in PAIRS.items():
        progress(0.3 + 0.35 * len(checks))
        if by_name[needed].state != "missing":
            checks.append(check(pair, by_name[needed]))
    return parts, checks


def look(name: str) -> Part:
    """Return the state of one of PARTS."""
    *module, hint = PARTS[name]
    return _part(name, [sys.executable, "-c", PROGRAM.format(*module)], hint)


def check(pair: str, needed: Part) -> Check:
    """Return how far an engine is from its exact solution on the paper's free pillar, whose own
    [expect] is the bound."""
    scene, began = cases.load_variant(SCENE), perf_counter()
    bound = scene.expect[pair]
    if needed.state == "broken":
        return Check(pair, nan, bound, reason=f"{needed.part}: {needed.found}")
    try:
        one, other = (solve(name, scene) for name in pair.split(" ~ "))
    except Exception as error:
        return Check(pair, nan, bound, reason=f"{type(error).__name__}: {error}")
    return Check(pair, misfit(one, other), bound, perf_counter() - began)


def _part(name: str, command: list[str], hint: str) -> Part:
    """Return what a command prints, or how it ends."""
    try:
        done = subprocess.run(command, input="", capture_output=True, text=True, timeout=PATIENCE)
    except FileNotFoundError:
        return Part(name, "missing", "is not on the PATH", hint)
    except subprocess.TimeoutExpired:
        return Part(name, "broken", f"took more than {PATIENCE:g} s", hint)
    if done.returncode == 0:
        return Part(name, "found", " ".join(done.stdout.replace("\0", "").split()))
    said = [line for line in done.stderr.splitlines() if any(map(str.isalnum, line))]
    why = (said or ["no message"])[-1 if "Traceback" in done.stderr else 0][:300]
    if why.startswith("ModuleNotFoundError"):
        return Part(name, "missing", why.partition(": ")[2], hint)
    return Part(name, "broken", f"{why} (exit code {done.returncode})", hint)


def show_health(parts: list[Part], checks: list[Check], as_json: bool) -> None:
    """Print every part, and what the engines' checks came to."""
    well, cache = all(one.holds for one in checks), str(jit.DIRECTORY.parent)
    if as_json:
        facts = [{**one._asdict(), "holds": one.holds} for one in checks]
        own = {"parts": [one._asdict() for one in parts], "kernel_cache": cache}
        print_json({**own, "self_check": facts, "well": well})
        return
    say(f"jointwave {version('jointwave')}, Python {platform.python_version()} ({sys.executable})")
    rows = [[one.part, one.state, "; ".join(filter(None, one[2:]))] for one in parts]
    show_table(["part", "state", ""], rows, [COLOURS.get(one.state, "") for one in parts])
    say(f"compiled kernels: {cache}")
    for one in checks:
        verdict = f"self-check {one.pair}: {'holds' if one.holds else 'FAILS'}"
        found = f"misfit {one.misfit:.3g}, at most {one.bound:g}, in {one.seconds:.1f} s"
        say(f"{verdict}, {one.reason or found}", "green" if one.holds else "bold red")
    say("all checks pass" if well else "a check fails: see the self-check above")
