"""Checks of `jointwave doctor`, one after the other, in a process that may crash.

`python -m compare.cli.diagnostics.components NAME ...` prints a line of JSON for each: what is
found, or why it is not. A library that ends the process takes only its own line with it, see
`compare.cli.diagnostics.doctor`.
"""

import json
import os
import shutil
import sys
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
from typing import NamedTuple

from cases.gmsh_file import INSTALL as GMSH
from compare.solvers.continuum import INSTALL

CHROMIUM = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")


class Missing(Exception):
    """A part that is not there, which is no fault of what is."""


def _imported(module: str) -> Callable[[], str]:
    def found() -> str:
        package = module.split(".")[0]
        if package not in sys.modules and find_spec(package) is None:
            raise Missing("is not installed")
        own = getattr(import_module(module), "__version__", None)
        return own or version(package)

    return found


def _threads() -> str:
    import numba
    from numba import threading_layer

    from numerics import jit as _  # noqa: F401  where kernels get their options

    @numba.njit(parallel=True)
    def count(n):
        found = 0
        for i in numba.prange(n):
            found += 1 if i >= 0 else 0
        return found

    assert count(100) == 100
    return f"{numba.get_num_threads()} (numba, {threading_layer()})"


def _of_fenicsx(module: str) -> Callable[[], str]:
    """Return what imports a module that may need the MPI of a wheel before it."""

    def found() -> str:
        if find_spec("basix") is not None:
            from continuum.space.compat import load_mpi

            load_mpi()
        return _imported(module)()

    return found


def _petsc() -> str:
    _of_fenicsx("petsc4py")()
    from continuum.parallel.petsc import PETSc

    return f"{'.'.join(map(str, PETSc.Sys.getVersion()))}, {PETSc.ScalarType.__name__}"


def _mpi() -> str:
    own = _imported("mpi4py.MPI")()
    from mpi4py import MPI

    library = MPI.Get_library_version().replace("\0", "").splitlines()[0].split(", package")[0]
    return f"{library}, mpi4py {own}"


def _adios() -> str:
    _of_fenicsx("dolfinx")()
    from continuum.space.forms import vtx_writer

    if vtx_writer() is None:
        raise Missing("dolfinx was built without it")
    return "available: snapshots can be written as VTX (--vtx)"


def _on_path(*programs: str) -> str:
    found = next((place for name in programs if (place := shutil.which(name))), None)
    if found is None:
        raise Missing("is not on the PATH")
    return found


def _ffmpeg() -> str:
    if shutil.which("ffmpeg") is None and find_spec("imageio_ffmpeg") is not None:
        return import_module("imageio_ffmpeg").get_ffmpeg_exe()
    return _on_path("ffmpeg")


def _font() -> str:
    from compare.figures.fonts import chinese_font

    font = chinese_font()
    if font is None:
        raise Missing("is not installed")
    return f"{font.name}, {font.fname}"


class Probe(NamedTuple):
    """A part that is looked for: its group in the report, what returns what is found (raises
    Missing or whatever goes wrong), and how to get it."""

    group: str
    look: Callable[[], str]
    hint: str = ""


LIBRARIES = ("numpy", "numba", "scipy", "pydantic", "xarray", "matplotlib", "obspy")
PROBES = {name: Probe("program", _imported(name)) for name in LIBRARIES} | {
    "basix": Probe("continuum", _imported("basix"), f"make setup; or {INSTALL}"),
    "PETSc": Probe(
        "continuum", _petsc, "comes with dolfinx; needed for implicit steps and static states"
    ),
    "gmsh": Probe(
        "continuum", _imported("gmsh"), f"{GMSH}; needed for triangles and tetrahedra only"
    ),
    "MPI": Probe("continuum", _mpi, "comes with dolfinx; or pip install mpi4py"),
    "dolfinx": Probe(
        "continuum",
        _of_fenicsx("dolfinx"),
        "apt install python3-dolfinx; needed for --vtx and the plain dolfinx loop only",
    ),
    "ADIOS2": Probe(
        "continuum", _adios, "needed for --vtx only; included in dolfinx of conda-forge"
    ),
    "threads": Probe("machine", _threads),
    "pyvista": Probe("optional", _imported("pyvista"), "pip install pyvista"),
    "ffmpeg": Probe("optional", _ffmpeg, "apt install ffmpeg; or pip install imageio-ffmpeg"),
    "Chinese font": Probe(
        "optional", _font, "apt install fonts-wqy-microhei (or fonts-noto-cjk, for SVG and PNG)"
    ),
    "chromium": Probe(
        "optional",
        lambda: _on_path(*CHROMIUM),
        "apt install chromium; needed for tests of the report page only",
    ),
}


def probe(name: str) -> dict[str, str]:
    """Return the state of a part, "found", "missing" or "broken", and what there is to say."""
    try:
        return {"part": name, "state": "found", "found": PROBES[name].look()}
    except Missing as reason:
        return {"part": name, "state": "missing", "found": str(reason)}
    except BaseException as error:
        text = " ".join(f"{type(error).__name__}: {error}".split())
        return {"part": name, "state": "broken", "found": text[:300]}


def main() -> None:
    """Print a line for each part that is named; what libraries print goes elsewhere."""
    lines = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    for name in sys.argv[1:]:
        print(json.dumps(probe(name)), file=lines, flush=True)
    lines.flush()
    os._exit(0)  # what breaks while libraries are taken down is of no interest


if __name__ == "__main__":
    main()
