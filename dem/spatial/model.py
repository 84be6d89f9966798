"""The constants of a spatial run, what changes in it, and the room it works in."""

from typing import Any, NamedTuple

import numpy as np

from dem.spatial.contact import Contact
from dem.spatial.motion import Motion


class Load(NamedTuple):
    """What acts on the start: the mean end stress over each step, cut after the last that acts.

    stress : float array [steps], Pa. direction : float array [freedoms], force (N) and moment
        (N m) on the start face's centre for a unit of stress.
    base : float array [steps + 1], the way of a shaken base in each step, the first the one
        before the run, m; None where no base is shaken.
    """

    stress: np.ndarray
    direction: np.ndarray
    base: Any


class Receivers(NamedTuple):
    """What is recorded, by tile and lane: forces of contacts and motion of blocks, int arrays.

    A contact's lane is that of its force in the scratch: contact c = 0 .. N is left of block c.
    """

    contact_tile: np.ndarray
    contact_lane: np.ndarray
    block_tile: np.ndarray
    block_lane: np.ndarray


class Model(NamedTuple):
    """The constants of a run.

    start, end : `dem.spatial.ends.End`, None where free. last : blocks in the last tile.
    stride : steps between samples. accounts : int array, the account of each energy term, None
        without a ledger. weight : float array [3], m g, N; None without gravity.
    viscous : whether the ledger has anything viscous to book; None where not.
    """

    contact: Contact
    motion: Motion
    load: Load
    start: Any
    end: Any
    last: int
    receivers: Receivers
    stride: int
    accounts: Any
    weight: Any
    viscous: Any


class State(NamedTuple):
    """What changes, in tiles as `layout` says, and at both ends.

    motion : float array [tiles, rows * STRIDE]. history : [tiles, rows * LANES], None where no
    joint remembers anything. slides : int64 [tiles, 1], points that slid in the last step, None
    where none can. sums : running accounts [4 * STRIDE], J; None without a ledger.
    """

    motion: np.ndarray
    history: Any
    slides: Any
    start: Any
    end: Any
    sums: Any


class Samples(NamedTuple):
    """Room for what is recorded, [receiver, freedom, sample]; energy [term, sample] or None.

    displacement : with a fourth number of rotation where blocks turn by any angle, the scalar
    part of the quaternion whose vector part the three before it are.
    """

    force: np.ndarray
    velocity: np.ndarray
    displacement: np.ndarray
    energy: Any


class Room(NamedTuple):
    """What the steps of a pass need besides the state, a slot for each step under way.

    scratch : float array [slots, scratch rows * STRIDE]. carry : [slots, 12], the force of a tile's
    last joint on its way to the next tile. books : [slots, ACCOUNTS * STRIDE], None without ledger.
    depth : steps taken in one pass over the tiles by one thread.
    guard : `numerics.divergence.Guard` that ends a run out of bounds, a limit for each row of
    velocities;
        None without.
    """

    scratch: np.ndarray
    carry: np.ndarray
    books: Any
    depth: int
    guard: Any = None
