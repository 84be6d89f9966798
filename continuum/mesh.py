"""Intervals along the pillar, cut at interfaces by doubled vertices."""

from math import ceil
from typing import NamedTuple

import numpy as np

from cases.calibrate import Properties
from continuum import compat


class Grid(NamedTuple):
    """Elements in a row.

    edges : float array [elements + 1], m, ends of the elements, from the loaded end.
    cut : bool array [elements - 1], whether an element shares no vertex with the next.
    """

    edges: np.ndarray
    cut: np.ndarray


#: Of the period: the longest that a wave may take through one element. A load that starts like a
#: sine has a kink, which only dashpots round off on its way.
TRAVEL_OF_KINKS, TRAVEL_OF_DAMPED = 0.01, 0.04


def elements_in_block(block: float, speed: float, period: float, damped: bool = False) -> int:
    """Return the fewest equal elements in a block (m) that resolve waves of this speed (m/s).

    A wave crosses one element within a hundredth of the period (s), or a 25th in damped rock.
    """
    travel = TRAVEL_OF_DAMPED if damped else TRAVEL_OF_KINKS
    return max(1, ceil(block / (speed * travel * period) * (1 - 1e-9)))


def pillar_grid(p: Properties, elements_per_block: int, interfaces: np.ndarray) -> Grid:
    """Return equal elements for every block, cut at the joints `interfaces` (int array)."""
    elements = p.block_count * elements_per_block
    edges = p.spacing / elements_per_block * np.arange(elements + 1)
    cut = np.zeros(elements - 1, dtype=bool)
    cut[elements_per_block * (interfaces + 1) - 1] = True
    return Grid(edges, cut)


def create(grid: Grid):
    """Return the dolfinx mesh of a grid; pieces between cuts are topologically disconnected."""
    left = np.concatenate([[0], np.cumsum(1 + grid.cut)])
    cells = np.column_stack([left, left + 1]).astype(np.int64)
    x = np.empty(left[-1] + 2)
    x[left], x[left + 1] = grid.edges[:-1], grid.edges[1:]
    return compat.interval_mesh(cells, x)
