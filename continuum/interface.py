"""Joints as interfaces: where they are, the jump across them, and their law.

With the jump operator B (nodal values to the gap at interface quadrature points), the weights W
and the traction t (compression positive), the joints' internal force is -B^T W t(B u). Dimension
and order show in B alone.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from cases.calibrate import Properties
from continuum.elasticity import Bar
from joints.laws import Law
from joints.uniform import law


class Joints(NamedTuple):
    """The joints that a model resolves.

    number : int array [n], which of the pillar's joints.
    stiffness, time_constant, tension : [n], Pa/m, s (None without any dashpot), whether carried.
    """

    number: np.ndarray
    stiffness: np.ndarray
    time_constant: np.ndarray | None
    tension: np.ndarray

    def law(self) -> Law:
        """Return the law of these joints in its smallest form."""
        return law(self.stiffness, self.time_constant, self.tension)


def resolved_joints(p: Properties, model: str) -> Joints:
    """Return all joints ("jointed"), or the soft layers by their excess ("equivalent")."""
    if model == "jointed":
        assert p.own_stiffness is not None
        number, stiffness = np.arange(p.block_count - 1), p.own_stiffness
    else:
        excess = p.excess_compliance
        number = np.flatnonzero(excess)
        stiffness = 1 / excess[number]
    eta = p.joint_time_constant
    return Joints(number, stiffness, None if eta is None else eta[number], p.tension[number])


def jump_operator(bar: Bar) -> csr_matrix:
    """Return B [cuts, nodes]: gap = u(right) - u(left) of each cut, positive when open."""
    cuts = np.flatnonzero(bar.grid.cut)
    left, right = bar.elements[cuts, -1], bar.elements[cuts + 1, 0]
    rows = np.arange(cuts.size)
    ones = np.ones(cuts.size)
    return csr_matrix(
        (np.r_[-ones, ones], (np.r_[rows, rows], np.r_[left, right])), (cuts.size, bar.y.size)
    )
