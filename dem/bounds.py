"""Bounds of the motion of rigid blocks in a rock mass: highest energy, motion of contacts."""

import numpy as np

from jointwave.cases.loads import highest_frequency
from jointwave.dem.build import carried
from jointwave.dem.contacts import springs_of
from jointwave.dem.model import State
from jointwave.dem.shaking import variation
from jointwave.dem.system import BlockSystem
from jointwave.numerics.divergence import speed_that


def highest_energy(system: BlockSystem, state: State) -> float:
    """Return a bound on sqrt(m) v of any degree of freedom, sqrt(J).

    From sources, gravity and moving walls, and the energy stored at the start.
    """
    blocks, time, mass = system.blocks, system.time, system.blocks.inertia[:, 0]
    own = system.model.blocks
    duration = time.dt * (time.steps + time.stride)
    shaken = 0.0
    if system.shaking is not None:
        shaken = variation(system.shaking(np.arange(time.steps + time.stride)))
    with np.errstate(over="ignore"):
        return speed_that(
            system.loads.impulse(
                blocks.inertia[system.loads.rows], highest_frequency(blocks.scene)
            ),
            duration * np.linalg.norm(own.gravity) * np.sqrt(mass.sum()),
            np.sqrt(mass.sum()) * shaken,
            stored(system, state),
        )


def motion_of_contacts(system: BlockSystem, state: State) -> np.ndarray:
    """Return gap and slips (m) at the centres of all contacts, and their rotation, in their frames
    [c, F]."""
    met, dim, u = system.blocks.contacts, system.blocks.dim, state.u
    motion, (i, j) = u @ system.blocks.onto, met.blocks.T
    at, gradient = motion[:, :dim], motion[:, dim:].reshape(-1, dim, dim)
    moved = at[j] - at[i]
    if dim > 1:
        moved += np.einsum("ca,cab->cb", met.arm[:, 1], gradient[j])
        moved -= np.einsum("ca,cab->cb", met.arm[:, 0], gradient[i])
    turned = u[j, dim:] - u[i, dim:]
    if turned.shape[1] > 1:
        turned = np.einsum("cab,cb->ca", met.frame, turned)
    return np.hstack([np.einsum("cab,cb->ca", met.frame, moved), turned])


def stored(system: BlockSystem, state: State) -> float:
    """Return the root of twice the energy in all contacts, sqrt(J)."""
    met, own, dim = system.blocks.contacts, system.blocks.columns, system.blocks.dim
    moved, rotations = motion_of_contacts(system, state), state.u.shape[1] - dim
    if system.model.form.stressed:
        moved[:, :dim] += carried(system.blocks)
    normal, shear = own.normal[met.column], own.shear[met.column]
    springs = springs_of(normal, shear, met.area, met.spread, rotations)
    return float(np.sqrt(np.einsum("ca,cab,cb->", moved, springs, moved)))
