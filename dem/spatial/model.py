"""The constants of a spatial run, what changes in it, and the buffers that it works in."""

from typing import Any, NamedTuple

import numpy as np

from jointwave.dem.spatial.layout import KernelFlags
from jointwave.joints.formula import formula


class Block(NamedTuple):
    """The constants of one block and of the face between two; kernels take them as one array.

    dt : s. arm : half the thickness, m. half_side : of the section, m. keep : what
    mass-proportional damping leaves of a velocity in a step. local : Cundall's damping. mass : kg;
    inertia_across : about x and z, inertia_along : about y, kg m2. freedoms : 3 or 6; kernels take
    it as a number, which keeps compilers from writing out the loops over it.

    The rest are float arrays [6], for x, y, z and the rotations about them. inertia : kg and kg m2.
    push : what a force or moment adds to a velocity in a step, dt / m and dt / I, less by
    mass-proportional damping. fall : what gravity adds, m/s. weight : m g, N. face : sums over the
    points of a face: A, m2, three times, then A z^2, A (x^2 + z^2) and A x^2, m4.
    """

    dt: float
    arm: float
    half_side: float
    keep: float
    local: float
    mass: float
    inertia_across: float
    inertia_along: float
    freedoms: int
    inertia: np.ndarray
    push: np.ndarray
    fall: np.ndarray
    weight: np.ndarray
    face: np.ndarray

    def as_array(self, direction: np.ndarray) -> np.ndarray:
        """Return all in one array [7, 8], as kernels take them, the load's direction last."""
        rows = np.zeros((7, 8))
        rows[0], rows[1:6, :6], rows[6, : direction.size] = self[:8], self[9:], direction
        return rows


class Constants(NamedTuple):
    """A block as kernels use it: `rows` is the whole array, a quantity's row for each freedom.

    One array, not five: every array makes every call that passes it longer to compile.
    """

    dt: float
    arm: float
    half_side: float
    keep: float
    local: float
    mass: float
    inertia_across: float
    inertia_along: float
    freedoms: int
    rows: np.ndarray


INERTIA, PUSH, FALL, WEIGHT, FACE, DIRECTION = range(1, 7)  # rows


@formula
def constants_of(c, freedoms):
    """Return the constants of a block from its array."""
    return Constants(
        c[0, 0], c[0, 1], c[0, 2], c[0, 3], c[0, 4], c[0, 5], c[0, 6], c[0, 7], freedoms, c
    )


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
    where both are free. stride : steps between samples.
    """

    form: KernelFlags
    block: Block
    block_count: int
    table: np.ndarray
    points: np.ndarray
    load: Load
    ends: Any
    receivers: RowReceivers
    stride: int


class RowState(NamedTuple):
    """What changes, in tiles as `layout` says, and at both ends.

    motion : float array [tiles, rows * STRIDE]. history : [tiles, rows * LANES], None where no
    joint remembers anything. ends : [2, 4, freedoms], None where both are free. sums : running sums
    of the ledger [4 * STRIDE], J; None without one.
    """

    motion: np.ndarray
    history: Any
    ends: Any
    sums: Any


class RowSamples(NamedTuple):
    """What is recorded, [receiver, freedom, sample]; energy [term, sample], all that there are, or
    None.

    displacement : with a fourth number of rotation where blocks turn by any angle, the scalar
    part of the quaternion whose vector part the three before it are.
    """

    force: np.ndarray
    velocity: np.ndarray
    displacement: np.ndarray
    energy: Any


class Buffers(NamedTuple):
    """What the steps of a pass need besides the state, a slot for each step under way.

    tile : float array [threads, BUFFER + CARRY * depth]. ledgers : [threads * depth, LEDGER], None
    without a ledger. depth : steps taken in one pass over the tiles by one thread. guard :
    `numerics.divergence.Guard` that ends a run out of bounds, a limit for each row of velocities;
    None without.
    """

    tile: np.ndarray
    ledgers: Any
    depth: int
    guard: Any = None
