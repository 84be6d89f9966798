"""Bounds of the motion of rigid blocks in a rock mass: highest energy, motion of contacts."""

import numpy as np

from jointwave.cases.spectrum import highest_frequency
from jointwave.dem.blocks.model import PlaneState
from jointwave.dem.blocks.system import PlaneSystem
from jointwave.dem.blocks.tile import relative
from jointwave.dem.blocks.tiles import LENGTH, START
from jointwave.dem.shaking import variation
from jointwave.numerics.divergence import speed_that


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
            system.loads.impulse(blocks.masses[system.loads.rows], highest_frequency(blocks.scene)),
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
