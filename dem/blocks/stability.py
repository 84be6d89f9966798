"""The critical step of a rock mass of rigid blocks.

The critical step, with dashpots and what holds the sides, follows from the bound of
`cases.material.block_stiffness`, block by block, on stiffness and damping together. Slip and
opening only take stiffness away; joints that stiffen are as stiff as in the stiffest state in
reach, and joints that dilate as in `joints.dilation.riding_stiffness`. Dashpots of quiet sides
take the mean velocity of a step and change no bound, nor does mass-proportional damping; local
damping alpha makes forces that turn a velocity round 1 + alpha times as large.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from jointwave.cases.material.block_stiffness import block_stiffness
from jointwave.cases.material.rock_mass import Inertia
from jointwave.dem.blocks.joints import Columns
from jointwave.dem.blocks.links import Links
from jointwave.dem.receivers import frames_of
from jointwave.numerics.critical_step import critical_step


def critical_plane_step(links: Links, columns: Columns, inertia: Inertia, local: float) -> float:
    """Return a lower bound of the critical step, s; local : Cundall's damping."""
    count, eta = len(inertia.mass), columns.time_constants
    own = _stiffness(links, columns, tuple(columns.stiffest), count)
    damping = None
    if eta is not None:
        damping = _stiffness(
            links, columns, (eta[0] * columns.normal, eta[1] * columns.shear), count
        )

    def largest(a: float, b: float) -> float:
        both = a * own if damping is None else a * own + b * damping
        return (1 + local) * float(_highest(both, inertia).max())

    return critical_step(largest, damping is not None)


def squared_frequencies(links: Links, columns: Columns, inertia: Inertia) -> np.ndarray:
    """Return the bound of each block on the square of the largest frequency [count], 1/s2."""
    own = _stiffness(links, columns, tuple(columns.stiffest), len(inertia.mass))
    return _highest(own, inertia)


def _highest(matrices: np.ndarray, inertia: Inertia) -> np.ndarray:
    """Return twice the largest eigenvalue of each block's matrix [count, 3, 3] over its inertia."""
    scale = 1 / np.sqrt(np.stack([inertia.mass, inertia.mass, inertia.moment], axis=1))
    return 2 * np.linalg.eigvalsh(scale[:, :, None] * matrices * scale[:, None, :])[:, -1]


def _stiffness(
    links: Links, columns: Columns, values: Sequence[np.ndarray], count: int
) -> np.ndarray:
    """Return the matrix of each block against what it touches [count, 3, 3], of stiffness or
    viscosity per length in each column, normal and in shear."""
    length = np.hypot(*(links.end - links.start).T)
    frame = frames_of(links.normal)
    centre = (links.start + links.end) / 2
    ruled = len(columns.rules) > 1
    places, weights = np.moveaxis(columns.rules[links.column if ruled else [0] * len(length)], 1, 0)
    contact, k = np.indices(places.shape).reshape(2, -1)
    at = centre[contact] + (places[contact, k] * length[contact])[:, None] * frame[contact, 1]
    arm = np.stack([at - links.beside_i[contact], at - links.beside_j[contact]], axis=1)
    each = np.stack([x[links.column] * length for x in values], axis=1)
    springs = weights[contact, k, None] * each[contact]
    beyond = max(count, int(links.blocks.max(initial=-1)) + 1)
    return block_stiffness(beyond, links.blocks[contact], frame[contact], arm, springs)[:count]
