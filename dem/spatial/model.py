"""The constants of a spatial run, what changes in it, and the buffers that it works in."""

from typing import Any, NamedTuple

import numpy as np

from dem.spatial.layout import Form
from dem.spatial.motion import Block


class Load(NamedTuple):
    """What acts on the start: the mean end stress over each step, cut after the last that acts.

    stress : float array [steps], Pa. direction : float array [freedoms], force (N) and moment
        (N m) on the start face's centre for a unit of stress.
    base : float array [steps + 1], the displacement of a shaken base in each step, the first the
        one before the run, m; None where no base is shaken.
    """

    stress: np.ndarray
    direction: np.ndarray
    base: Any


class RowReceivers(NamedTuple):
    """What is recorded: tile and lane, int64 arrays [2, places], of forces of contacts and of
    motion of blocks. A contact's lane is that of its force: contact c = 0 .. N is left of block c.
    """

    contacts: np.ndarray
    centres: np.ndarray


class RowModel(NamedTuple):
    """The constants of a run.

    table : the joint law, [tiles, fields * LANES] where joints vary, else one tile of them.
    points : x, z (m) and area (m2) of a face's contact points [3, points].
    ends : constants of start and end, `dem.spatial.ends`, [2, MATRIX + freedoms, freedoms]; None
    where both are free. stride : steps between samples. places : int64 array, where the ledger
    has each energy term; None without.
    """

    form: Form
    block: Block
    block_count: int
    table: np.ndarray
    points: np.ndarray
    load: Load
    ends: Any
    receivers: RowReceivers
    stride: int
    places: Any


class RowState(NamedTuple):
    """What changes, in tiles as `layout` says, and at both ends.

    motion : float array [tiles, rows * STRIDE]. history : [tiles, rows * LANES], None where no
    joint remembers anything. sliding : int64 [tiles, 1], points that slid in the last step, None
    where none can. ends : [2, 4, freedoms], None where both are free. sums : running sums of the
    ledger [4 * STRIDE], J; None without one.
    """

    motion: np.ndarray
    history: Any
    sliding: Any
    ends: Any
    sums: Any


class RowSamples(NamedTuple):
    """What is recorded, [receiver, freedom, sample]; energy [term, sample] or None.

    displacement : with a fourth number of rotation where blocks turn by any angle, the scalar
    part of the quaternion whose vector part the three before it are.
    """

    force: np.ndarray
    velocity: np.ndarray
    displacement: np.ndarray
    energy: Any


class Buffers(NamedTuple):
    """What the steps of a pass need besides the state, a slot for each step under way.

    tile : float array [threads, BUFFER]. carry : [slots, 12], the force of a tile's last joint on
    its way to the next tile. ledgers : [slots, LEDGER], None without a ledger.
    depth : steps taken in one pass over the tiles by one thread.
    guard : `numerics.divergence.Guard` that ends a run out of bounds, a limit for each row of
    velocities;
        None without.
    """

    tile: np.ndarray
    carry: np.ndarray
    ledgers: Any
    depth: int
    guard: Any = None
