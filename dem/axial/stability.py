"""The critical step of the chain: exact, from its largest eigenvalue with all dashpots.

Mass-proportional damping takes the mean velocity of the step and leaves the bound as it is: in the
mode that alternates at every step that mean is zero. Softening, like slip, only takes stiffness
away. Local damping can add a share of every unbalanced force to it, as if the stiffness were
1 + local times itself.
"""

from math import cos, pi, sqrt

import numpy as np

from cases.material.calibrate import Properties
from dem.axial.ends import end_stiffness
from numerics.critical_step import critical_step, critical_step_of_modes


def critical_chain_step(p: Properties, start: str, end: str) -> float:
    """Return the critical step (s) of a chain whose ends are held as `start` and `end` say."""
    alike = p.is_uniform and (p.stiffness == p.stiffness[0]).all() and not p.damps_alone.any()
    pushed = 1 + (p.local_damping or 0.0)
    if alike and {start, end} <= {"free", "quiet"}:
        rigid = 2 * sqrt(p.stiffness[0] * p.area / p.block_mass)
        omega = rigid * cos(pi / (2 * p.block_count))
        return critical_step_of_modes(omega * sqrt(pushed), p.time_constant or 0.0)

    from scipy.linalg import eigh_tridiagonal  # slow to import: only for chains that need it

    k = p.stiffness * p.area
    c = k * (0.0 if p.joint_time_constant is None else p.joint_time_constant)
    ends = np.zeros(p.block_count)
    ends[0], ends[-1] = end_stiffness(start, p.at_start), end_stiffness(end, p.at_end)
    masses = p.masses
    lightness = np.ones(p.block_count) if masses is None else p.block_mass / masses

    def largest(a: float, b: float) -> float:
        joints = a * k + b * c
        diagonal = a * ends
        diagonal[:-1] += joints
        diagonal[1:] += joints
        diagonal *= lightness
        joints *= np.sqrt(lightness[1:] * lightness[:-1])
        last = (p.block_count - 1,) * 2
        top = eigh_tridiagonal(diagonal, -joints, True, select="i", select_range=last)
        return pushed * top[0] / p.block_mass

    return critical_step(largest, p.joint_time_constant is not None)
