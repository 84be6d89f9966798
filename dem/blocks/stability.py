"""Bounds of a rock mass of rigid blocks: its critical step, and how fast its blocks can become.

The critical step, with dashpots and what holds the sides, follows from the bound of
`cases.material.rigid_step`, block by block, on stiffness and damping together. Slip and opening
only take stiffness away; joints that stiffen are as stiff as in the stiffest state in reach, and
joints that dilate as in `joints.dilation.riding_stiffness`. Dashpots of quiet sides take the mean
velocity of a step and change no bound, nor does mass-proportional damping; local damping alpha
makes forces that turn a velocity round 1 + alpha times as large.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from cases.material.contact_points import ContactPoints
from cases.material.rigid_step import block_stiffness
from cases.material.rock_mass import Inertia, Stiffness
from cases.partition.blocks import Contacts
from cases.spectrum import highest_frequency
from dem.blocks.joints import Columns
from dem.blocks.links import Links
from dem.blocks.model import PlaneState
from dem.blocks.shaking import variation
from dem.blocks.tile import relative
from dem.blocks.tiles import LENGTH, START
from numerics.critical_step import critical_step
from numerics.divergence import speed_that

if TYPE_CHECKING:
    from dem.blocks.system import PlaneSystem


def critical_plane_step(links: Links, columns: Columns, inertia: Inertia, local: float) -> float:
    """Return a lower bound of the critical step, s; local : Cundall's damping."""
    count, eta = len(inertia.mass), columns.time_constants
    own = _stiffness(links, columns, tuple(columns.stiffest), count)
    damping = None
    if eta is not None:
        damping = _stiffness(
            links, columns, (eta[0] * columns.normal, eta[1] * columns.shear), count
        )
    scale = 1 / np.sqrt(np.stack([inertia.mass, inertia.mass, inertia.moment], axis=1))

    def largest(a: float, b: float) -> float:
        both = a * own if damping is None else a * own + b * damping
        scaled = scale[:, :, None] * both * scale[:, None, :]
        return 2 * (1 + local) * float(np.linalg.eigvalsh(scaled)[:, -1].max())

    return critical_step(largest, damping is not None)


def _stiffness(
    links: Links, columns: Columns, values: Sequence[np.ndarray], count: int
) -> np.ndarray:
    """Return the matrix of each block against what it touches [count, 3, 3], of stiffness or
    viscosity per length in each column, normal and in shear."""
    length = np.hypot(*(links.end - links.start).T)
    along = np.stack([-links.normal[:, 1], links.normal[:, 0]], axis=1)
    centre = (links.start + links.end) / 2
    ruled = len(columns.rules) > 1
    places, weights = np.moveaxis(columns.rules[links.column if ruled else [0] * len(length)], 1, 0)
    contact, k = np.indices(places.shape).reshape(2, -1)
    at = centre[contact] + (places[contact, k] * length[contact])[:, None] * along[contact]
    arm = np.stack([at - links.beside_i[contact], at - links.beside_j[contact]], axis=1)
    points = ContactPoints(contact, arm, weights[contact, k] * length[contact])
    normal, shear = (x[links.column] for x in values)
    contacts = Contacts(links.blocks, links.start, links.end, links.normal, length, links.column)
    beyond = int(links.blocks.max(initial=-1)) + 1
    return block_stiffness(max(count, beyond), contacts, points, Stiffness(normal, shear))[:count]


def highest_energy(system: PlaneSystem, state: PlaneState) -> float:
    """Return a bound on sqrt(m) v of any degree of freedom, sqrt(J per metre).

    From sources, gravity and moving walls, and the energy stored at the start.
    """
    blocks, time, mass = system.blocks, system.time, system.blocks.inertia.mass
    own = system.model.blocks
    duration = time.dt * (time.steps + time.stride)
    shaken = 0.0
    if system.shaking is not None:
        shaken = variation(system.shaking(np.arange(time.steps + time.stride)))
    with np.errstate(over="ignore"):
        return speed_that(
            system.sources.impulse(
                blocks.masses[system.sources.rows], highest_frequency(blocks.scene)
            ),
            duration * np.hypot(own.gravity_x, own.gravity_y) * np.sqrt(mass.sum()),
            np.sqrt(mass.sum()) * shaken,
            stored(system, state),
        )


def motion_of_contacts(system: PlaneSystem, state: PlaneState) -> tuple[np.ndarray, ...]:
    """Return opening and slip (m) at the centres of all contacts, and their rotation [c]."""
    k, links = system.model.contacts.rows(), system.blocks.links
    (x_i, y_i, turn_i), (x_j, y_j, turn_j) = state.u.T[:, links.blocks].transpose(2, 0, 1)
    return relative(x_j - x_i, y_j - y_i, turn_i, turn_j, *k[:LENGTH])


def stored(system: PlaneSystem, state: PlaneState) -> float:
    """Return the root of twice the energy in all contacts, sqrt(J per metre)."""
    k, links, own = system.model.contacts.rows(), system.blocks.links, system.blocks.columns
    gap, slip, turn = motion_of_contacts(system, state)
    if system.model.form.stressed:
        gap, slip = gap + k[START], slip + k[START + 1]
    length, column = k[LENGTH], links.column
    twice = own.normal[column] * (gap**2 + (length * turn) ** 2 / 12) + own.shear[column] * slip**2
    return float(np.sqrt((length * twice).sum()))
