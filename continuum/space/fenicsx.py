"""PETSc, initialised without its handlers of signals and closed pipes, and then dolfinx, with the
root logger left as it was."""

import logging
from importlib import import_module
from importlib.util import find_spec
from typing import Any

if find_spec("dolfinx_solver") is not None:  # pip's wheel: its MPI must be loaded first
    import_module("dolfinx_solver")
import petsc4py

petsc4py.init(["jointwave", "-no_signal_handler"])
from petsc4py import PETSc  # noqa: E402

root = logging.getLogger()
handlers, level = list(root.handlers), root.level
import dolfinx.fem.petsc  # noqa: E402
import dolfinx.graph  # noqa: E402
import dolfinx.jit  # noqa: E402
from mpi4py import MPI  # noqa: E402

root.handlers[:] = handlers
root.setLevel(level)

__all__ = ["MPI", "PETSc", "dolfinx", "shared_by"]

_SHARED: list[tuple[Any, Any]] = []  # communicators cannot be hashed


def shared_by(comm: Any) -> Any:
    """Return PETSc's own communicator of the processes of mpi4py's, for all objects that they
    share; all call this alike.

    It is kept. PETSc frees its own with its last object, which Python deletes earlier in one
    process than in another; the next object would then wait for ever for a new one.
    """
    for known, own in _SHARED:
        if known == comm:
            return own
    _SHARED.append((comm, PETSc.Comm(comm).duplicate()))
    return _SHARED[-1][1]
