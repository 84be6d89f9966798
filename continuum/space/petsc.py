"""PETSc, initialised without its handlers of signals and closed pipes."""

from importlib import import_module
from importlib.util import find_spec

if find_spec("dolfinx_solver") is not None:  # pip's wheel: its MPI must be loaded first
    import_module("dolfinx_solver")
import petsc4py

petsc4py.init(["jointwave", "-no_signal_handler"])
from petsc4py import PETSc  # noqa: E402

__all__ = ["PETSc"]
