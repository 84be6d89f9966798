"""One point of a joint whose history is told by its elastic slip, as the source papers tell it."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from hypothesis import strategies as st

from jointwave.joints import tangent as tangents
from jointwave.joints.law import History, law_of, parts_of, table_of, traction

DT = 1e-5
RATE = {"direct_effect": 0.01, "evolution_effect": 0.015, "critical_slip_distance": 1e-3}
RATE |= {"reference_rate": 1e-6, "initial_state": 1.0}


class Point(NamedTuple):
    """Largest opening, elastic slip in x and z, m; cohesion, Pa; path of slip, m."""

    opening: float = 0.0
    ex: float = 0.0
    ez: float = 0.0
    cohesion: float = 0.0
    path: float = 0.0


def at_point(one, j=0):
    """Return the law of one joint as kernels have it, every parameter a number, and its parts."""
    return law_of(table_of(one), j), parts_of(one)


def jump_of(gap, slip, before):
    """Return jump and history of a step whose slip so far is all elastic."""
    jump = gap, before.ex + slip[0], before.ez + slip[1]
    return jump, History(before.opening, 0.0, 0.0, before.cohesion, before.path)


def advance(law, parts, gap, gap_rate, slip, slip_rate, dt, before):
    """Return (t_n, t_x, t_z, point) after a step of increments of slip (x, z), m."""
    jump, history = jump_of(gap, slip, before)
    found = traction(law, parts, jump, (0.0, *slip), (gap_rate, *slip_rate), dt, history)
    opening, slide_x, slide_z, cohesion, path = found.history
    after = Point(opening, jump[1] - slide_x, jump[2] - slide_z, cohesion, path)
    return found.n, found.x, found.z, after


def tangent(law, parts, gap, gap_rate, slip, slip_rate, dt, before, r):
    """Return the `Tangent` of such a step."""
    jump, history = jump_of(gap, slip, before)
    return tangents.tangent(law, parts, jump, (gap_rate, *slip_rate), dt, history, r)


def march(one, path, **flags):
    """Yield (step, traction before, after) of every step of a path of jumps, m, from rest."""
    law, parts = at_point(one)
    parts, history, before = parts._replace(**flags), History(cohesion=one.cohesion or 0.0), None
    for last, jump in pairwise([np.zeros(3), *map(np.array, path)]):
        step = jump - last
        now = traction(law, parts, tuple(jump), tuple(step), tuple(step / DT), DT, history)
        if before is not None:
            yield step, before, now
        history, before = now.history, now


def some(low, high, digits=9):
    """Return floats in a range; rounded, as the square of a number below 1e-162 is zero, and
    differences of small ones mean nothing."""
    return st.floats(low, high).map(lambda x: round(x, digits))
