"""dolfinx, loaded after PETSc without its handlers, and with the root logger left as it was."""

import logging

from jointwave.continuum.space import petsc as _  # noqa: F401  before dolfinx starts it

root = logging.getLogger()
handlers, level = list(root.handlers), root.level
import dolfinx.fem.petsc  # noqa: E402
import dolfinx.graph  # noqa: E402
import dolfinx.jit  # noqa: E402
from mpi4py import MPI  # noqa: E402

root.handlers[:] = handlers
root.setLevel(level)

__all__ = ["MPI", "dolfinx"]
