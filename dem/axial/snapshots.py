"""A look at all blocks of a chain at once."""

from collections.abc import Callable

import numpy as np

from cases.material.calibrate import Properties
from cases.sampling import interpolation
from dem.axial.model import Model, Receivers
from dem.axial.record import room, sample_after, sample_before
from dem.axial.state import State
from dem.axial.step import march
from dem.snapshots import Shot
from numerics.borrowed import borrowed
from numerics.denormals import flush_tiny, restore_tiny
from numerics.jit import jitted
from results.arrays import copied


def shooter(p: Properties, model: Model, state: State, stride: int) -> Callable[[int], Shot]:
    """Return what takes a sample of all contacts and blocks, on a copy of the state.

    A velocity at a whole step needs the step, as it does at the receivers.
    """
    contacts = p.spacing * np.arange(p.block_count + 1)
    centres = contacts[1:] - p.spacing / 2
    places = Receivers(
        interpolation(contacts, contacts.tolist()), interpolation(centres, centres.tolist())
    )
    everywhere = model._replace(receivers=places)

    def shoot(sample: int) -> Shot:
        twin = copied(state)
        found = room(everywhere, twin, 1)
        sample_once(everywhere, twin, found, sample * stride)
        return Shot(found.stress[:, 0], found.displacement, found.velocity)

    shoot(0)  # compiles
    return shoot


@jitted
def sample_once(model, state, samples, n):
    """Take step n and the only sample around it."""
    tiny = flush_tiny()
    model, state, samples = borrowed((model, state, samples))
    sample_before(model, state, samples, 0)
    march(model, state, n, n + 1)
    sample_after(model, state, samples, 0, n)
    restore_tiny(tiny)
