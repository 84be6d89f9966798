"""Import of PETSc, without its signal handlers, and then of dolfinx, with the root logger kept."""

import logging
import sys
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from jointwave.numerics.cache import cache_home

if find_spec("dolfinx_solver") is not None:  # pip's wheel: load its MPI first
    import_module("dolfinx_solver")
import petsc4py

petsc4py.init(["jointwave", "-no_signal_handler"])
from petsc4py import PETSc  # noqa: E402

cache_home()
root, given = logging.getLogger(), sys.argv
handlers, level = list(root.handlers), root.level
sys.argv = ["jointwave"]  # dolfinx takes options there, and fails at names that are no UTF-8
import dolfinx.fem.petsc  # noqa: E402
import dolfinx.graph  # noqa: E402
import dolfinx.jit  # noqa: E402
from mpi4py import MPI  # noqa: E402

root.handlers[:] = handlers
root.setLevel(level)
sys.argv = given

__all__ = ["MPI", "PETSc", "dolfinx", "shared_by"]

_SHARED: list[tuple[Any, Any]] = []  # communicators cannot be hashed


def shared_by(comm: Any) -> Any:
    """Return a PETSc communicator for the processes of an mpi4py communicator; collective.

    It is kept for later calls. PETSc frees its own communicator with the last object, which Python
    deletes at different times in different processes; creating the next object would then hang.
    """
    for known, own in _SHARED:
        if known == comm:
            return own
    _SHARED.append((comm, PETSc.Comm(comm).duplicate()))
    return _SHARED[-1][1]
