"""The same steps with the stiffness of all blocks as one scipy matrix."""

import numpy as np
import plain_dolfinx
import ufl
from plain_dolfinx import Pillar, Steps
from scipy.sparse import csr_matrix

from jointwave.continuum.space import dolfinx_export
from jointwave.continuum.space.operator import without_round_off


def stiffness(pillar: Pillar) -> csr_matrix:
    """Return the stiffness of all blocks as dolfinx assembles it, N/m."""
    space = plain_dolfinx.vector_space(pillar)
    return dolfinx_export.matrix(
        plain_dolfinx.internal_work(pillar, space, ufl.TrialFunction(space))
    )


def without_zeros(pillar: Pillar) -> csr_matrix:
    """Return the stiffness without the entries that quadrature makes zero, N/m."""
    return without_round_off(stiffness(pillar))


def multiplied(pillar: Pillar) -> Steps:
    """Return the steps that multiply."""
    matrix = -without_zeros(pillar)

    def internal(u: np.ndarray, force: np.ndarray) -> None:
        force[:] = matrix @ u

    return Steps(pillar, plain_dolfinx.vector_space(pillar), internal)
