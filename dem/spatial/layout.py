"""Where a block's numbers lie: tiles of 64 blocks, one row of lanes for each number.

The motion of a tile and the history of its joints are flat arrays in which all distances between
rows are constants: what lets the compiler work on several blocks at once. They are apart because
a loop that reads neighbouring lanes of the one writes the other.

Rows of motion: displacement and rotation, then velocity and angular velocity. A row has room for
the first block of the next tile, whose joint with this tile's last block is computed here. Rows
of history, per joint: the rates of its relative motion half a step before (`rates`), and what the
law remembers of each contact point (`slides`, x and z in turn, `openings`, `cohesions`).
"""

from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from numerics.aligned import zeros
from numerics.jit import inlined, jitted

LANES = 64  # blocks in a tile
STRIDE = 72  # lanes in a row of motion: the tile's own, the next one's first, whole cache lines


class Layout(NamedTuple):
    """Which rows a tile has, as tuples of their indices; an absent kind is None.

    The lengths are known when a kernel is compiled, so the place of each row is a constant.
    """

    motion: tuple
    rates: Any
    slides: Any
    openings: Any
    cohesions: Any


def layout(motion: int, rates: int, slides: int, openings: int, cohesions: int) -> Layout:
    """Return the layout with so many rows of each kind."""
    ends = np.cumsum([0, rates, slides, openings, cohesions]).tolist()
    history = (tuple(range(a, b)) or None for a, b in pairwise(ends))
    return Layout(tuple(range(motion)), *history)


@inlined
def count(rows):
    """Return how many rows of a kind there are."""
    if rows is None:
        return 0
    return len(rows)


@jitted
def freedoms(rows):
    """Return how many freedoms a block has."""
    return len(rows.motion) // 2


@inlined
def velocities(rows):
    """Return the place of the first velocity in a tile's motion."""
    return len(rows.motion) // 2 * STRIDE


@inlined
def first_slide(rows):
    """Return the place of the first slide in a tile's history."""
    return count(rows.rates) * LANES


@inlined
def first_opening(rows):
    """Return the place of the first largest opening in a tile's history."""
    return first_slide(rows) + count(rows.slides) * LANES


@inlined
def first_cohesion(rows):
    """Return the place of the first cohesion in a tile's history."""
    return first_opening(rows) + count(rows.openings) * LANES


def tile_count(blocks: int) -> int:
    """Return how many tiles hold so many blocks."""
    return -(-blocks // LANES)


def packed(values: np.ndarray, stride: int) -> np.ndarray:
    """Return values [rows, blocks] as tiles [tiles, rows * stride]; lanes without a block are 0."""
    rows, blocks = values.shape
    padded = np.zeros((rows, tile_count(blocks) * LANES))
    padded[:, :blocks] = values
    tiles = zeros((tile_count(blocks), rows, stride))
    tiles[:, :, :LANES] = padded.reshape(rows, -1, LANES).transpose(1, 0, 2)
    return tiles.reshape(len(tiles), -1)


def unpacked(tiles: np.ndarray, stride: int, blocks: int) -> np.ndarray:
    """Return tiles [tiles, rows * stride] as values [rows, blocks]."""
    lanes = tiles.reshape(len(tiles), -1, stride)[:, :, :LANES]
    return lanes.transpose(1, 0, 2).reshape(lanes.shape[1], -1)[:, :blocks]
