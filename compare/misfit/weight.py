"""The weight of each component in its quantity's motion, which decides how a misfit is measured.

The motion of a quantity at a receiver is the root mean square over time of its vector or tensor,
minus its static state: velocity, displacement, rotation, the traction of a joint, its gap and slip,
the stress and shear of a section, or the stress tensor with its shear stress counted twice. It is
independent of the axes.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd

from jointwave.compare.misfit.places import Place
from jointwave.results.labels import UNITS

CARRIES = 0.05  #: least part of the motion for a component to decide a misfit
FAINT = 0.01  #: least part of a unit's largest motion for a receiver to decide a misfit
EXCITED = 1e-6  #: part of a unit's largest motion below which a waveform is not excited
#: Pa s/m: stress over velocity below which stress is round-off of rock that moves as a whole; 1e-8
#: of that in waves in soft soil.
RIGID = 1e-3
ROUND_OFF = 1e-9  # m: ratio of displacement and rotation (rad) below which either is round-off
_ONE_VECTOR = {"shear": "stress", "slip": "gap"}


class Weight(NamedTuple):
    """The norm that the misfit of each waveform is relative to, and when it decides, [waveform].

    norm : root mean square of the reference's component, if it carries at least 5 % of the motion;
    else of all motion there; at a receiver below 1 % of the loudest one, of the loudest. least :
    misfit from which the waveform decides: 0 if it carries, else CARRIES or FAINT; inf if a whole
    unit rests in the reference while another moves. excited : whether the reference moves there.
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
    loudest[:3] *= loudest[2] >= ROUND_OFF * loudest[3]  # else the rock only rotates
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
