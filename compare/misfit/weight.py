"""The weight of each component in the motion of its quantity, which decides what a misfit follows.

The motion of a quantity at a receiver is the root mean square over time of its vector or tensor,
less its static state: velocity, displacement, rotation, the traction of a joint, its gap and slip,
the stress and shear of a section, or the stress tensor with its shear stress counted twice. It does
not depend on the axes.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from jointwave.compare.misfit.places import Place
from jointwave.results.labels import UNITS

CARRIES = 0.05  #: part of the motion from which a component decides a misfit
FAINT = 0.01  #: part of the largest motion of a unit from which a receiver decides one
EXCITED = 1e-6  #: part of the largest motion of a unit below which a scene does not excite anything
#: Pa s/m: stress below this times the velocity, 1e-8 of what waves in soft soil have, is round-off
#: of rock that moves as a whole.
RIGID = 1e-3
ROUND_OFF = 1e-9  # m: rotations (rad) below this part of displacements, and the reverse, are zero
_ONE_VECTOR = {"shear": "stress", "slip": "gap"}


class Weight(NamedTuple):
    """What the misfit of each waveform is relative to, and from where on it decides, [waveform].

    norm : root mean square: of the reference's component where it carries at least 5 % of the
    motion; else of all motion there; at a receiver below 1 % of the loudest one, of that.
    least : misfit from which it decides: 0 of a component that carries, else CARRIES or FAINT; inf
    where the reference leaves out all of a unit while something else moves.
    excited : whether the reference moves there at all.
    """

    norm: np.ndarray
    least: np.ndarray
    excited: np.ndarray


def weigh(places: Sequence[Place], moved: np.ndarray) -> Weight:
    """Return the weight of each waveform; moved : root mean square in the reference [waveform]."""
    unit_of = {quantity: k for k, unit in enumerate(UNITS) for quantity in unit}
    vectors = [(_ONE_VECTOR.get(p.quantity, p.quantity), p.at) for p in places]
    twice = np.array([2.0 if len(set(p.component)) == 2 else 1.0 for p in places])
    squares = pd.Series(twice * moved**2, dtype=float)
    motion = np.sqrt(
        squares.groupby(pd.factorize(pd.Series(vectors, dtype=object))[0]).transform("sum")
    ).to_numpy()
    units = np.array([unit_of[p.quantity] for p in places], dtype=int)
    loudest = np.zeros(len(UNITS))
    np.maximum.at(loudest, units, motion)
    loudest[:3] *= loudest[2] >= ROUND_OFF * loudest[3]  # else the rock only turns
    loudest[0] *= loudest[0] >= RIGID * loudest[1]
    at_rest = ((loudest == 0) & loudest.any())[units]
    loudest[3] = max(loudest[3], ROUND_OFF / FAINT * loudest[2])
    largest = loudest[units]
    heard = motion >= FAINT * largest
    carries = heard & (moved >= CARRIES * motion)
    norm = np.where(carries, moved, np.where(heard, motion, largest))
    least = np.where(carries, 0.0, np.where(heard, CARRIES, FAINT))
    excited = (moved >= EXCITED * largest) & ~at_rest
    return Weight(norm, np.where(at_rest, np.inf, least), excited)
