"""Bounds of the motion of rigid blocks in a rock mass: highest energy, motion of contacts."""

import numpy as np

from jointwave.cases.spectrum import highest_frequency
from jointwave.dem.blocks.build import carried, faces_of
from jointwave.dem.blocks.system import PlaneSystem
from jointwave.dem.model import State
from jointwave.dem.shaking import variation
from jointwave.numerics.divergence import speed_that


def highest_energy(system: PlaneSystem, state: State) -> float:
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
            duration * np.linalg.norm(own.gravity) * np.sqrt(mass.sum()),
            np.sqrt(mass.sum()) * shaken,
            stored(system, state),
        )


def motion_of_contacts(system: PlaneSystem, state: State) -> tuple[np.ndarray, ...]:
    """Return opening and slip (m) at the centres of all contacts, and their rotation [c]."""
    faces = faces_of(system.blocks)
    u = state.u[faces.blocks]
    across = np.stack([-faces.arm[..., 1], faces.arm[..., 0]], axis=-1)
    moved = np.diff(u[..., :2] + u[..., 2:] * across, axis=1)[:, 0]
    gap, slip = np.einsum("cak,ck->ac", faces.frame, moved)
    return gap, slip, u[:, 1, 2] - u[:, 0, 2]


def stored(system: PlaneSystem, state: State) -> float:
    """Return the root of twice the energy in all contacts, sqrt(J per metre)."""
    faces, own, column = faces_of(system.blocks), system.blocks.columns, system.blocks.links.column
    gap, slip, turn = motion_of_contacts(system, state)
    if system.model.form.stressed:
        start = carried(system.blocks)
        gap, slip = gap + start[:, 0], slip + start[:, 1]
    normal, shear, length = own.normal[column], own.shear[column], faces.area
    twice = normal * (gap**2 + (length * turn) ** 2 / 12) + shear * slip**2
    return float(np.sqrt((length * twice).sum()))
