"""PETSc, started so that it does not turn a closed pipe or an interrupt into a crash report."""

import petsc4py

petsc4py.init(["jointwave", "-no_signal_handler"])
from petsc4py import PETSc  # noqa: E402

__all__ = ["PETSc"]
