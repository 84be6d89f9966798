"""A bound on the motion of a rock mass, which the divergence monitor compares its run with."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cases.spectrum import highest_frequency
from dem.blocks.leapfrog import relative
from dem.blocks.model import LENGTH, PlaneState
from dem.blocks.shaking import variation
from numerics.divergence import speed_that

if TYPE_CHECKING:
    from dem.blocks.system import PlaneSystem


def highest_energy(system: PlaneSystem, state: PlaneState) -> float:
    """Return a bound on sqrt(m) v of any freedom of any block, sqrt(J per metre).

    What sources, gravity and shaken walls can add to sqrt(2 E), and what is stored at the start.
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


def stored(system: PlaneSystem, state: PlaneState) -> float:
    """Return the root of twice the energy in all contacts that hold, sqrt(J per metre)."""
    own, contacts = system.blocks.columns, system.model.contacts
    column, table = system.blocks.links.column, contacts.table.T
    i, j = contacts.blocks.T
    gap, slip, turn = relative(state.u, i, j, table)
    if contacts.start is not None:
        gap, slip = gap + contacts.start[:, 0], slip + contacts.start[:, 1]
    length = table[LENGTH]
    twice = own.normal[column] * (gap**2 + (length * turn) ** 2 / 12) + own.shear[column] * slip**2
    return float(np.sqrt((length * twice).sum()))
