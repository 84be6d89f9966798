"""Memory layout of a row: tiles of 64 blocks, a line of numbers for each quantity.

The motion of a tile and the history of its joints are flat arrays in which all distances between
rows are constants: what lets the compiler work on several blocks at once. They are apart because
a loop that reads neighbouring lanes of the one writes the other.

Rows of motion: displacement (3), rotation (3), velocity (3), angular velocity (3). With finite
rotations the vector part of the unit quaternion, its angular momentum, and the scalar part last.
A row ends with a copy of the first block of the next tile, whose joint with this tile's last block
is computed here. Rows of history, per joint: the rates of its relative motion half a step before,
where it has dashpots, and for each contact point its slides along x and z, its largest opening with
softening, its cohesion where slip reduces it, and the path it has slid where that changes it.
"""

from typing import NamedTuple

import numpy as np

from jointwave.joints.law import LawFlags
from jointwave.numerics.cache_lines import zeros

LANES = 64  # blocks in a tile
STRIDE = 72  # lanes in a row of motion: the tile's own, the next one's first, whole cache lines

# Rows of a vector and a rotation: of motion, of velocity, of force and moment.
X, Y, Z, ABOUT_X, ABOUT_Y, ABOUT_Z = range(0, 6 * STRIDE, STRIDE)

SLIDING = LANES + 1  # where in a tile's motion the number of points that slid last is

# Rows of the buffer of one tile's step, which the next tile does not need. Joint i has lane i, but
# for its forces: those lie in lane i + 1, so that a block finds the force of its left joint in its
# own lane and that of its right joint in the next.
FORCE = 0  # and moment about the face's centre; with finite rotations about the right centroid
LEFT = 6 * STRIDE  # moment about the left block's centroid, for finite rotations
DRAG = 9 * STRIDE  # the dashpots' share of all nine, for the ledger
BEFORE = 18 * STRIDE  # velocity and angular velocity before the step, for the ledger
RELATIVE = 24 * STRIDE  # relative motion of a joint's faces: displacement and rotation, 6 or 9 rows
RATE = 33 * STRIDE  # their rates half a step before
CENTRED = 42 * STRIDE  # and at the whole step, for the dashpots
BUFFER = 51 * STRIDE
CARRY = (
    12  # then, for each step under way, the force of a tile's last joint and its dashpots' share
)

# Rows of the ledger of one step, J in lanes. Running sums up to the step; AFTER further on what the
# step adds behind it.
VISCOUS, BOUNDARY, WORK, FRICTION, AFTER = range(0, 5 * STRIDE, STRIDE)
# States, filled at samples only.
KINETIC, ROTATION, ELASTIC, FRACTURE, GRAVITY = range(7 * STRIDE, 12 * STRIDE, STRIDE)
LEDGER = 12 * STRIDE

#: Where each term of the energy lies, in the order of its rows in results.
TERMS = {
    "kinetic": KINETIC,
    "rotation": ROTATION,
    "elastic": ELASTIC,
    "viscous": VISCOUS,
    "friction": FRICTION,
    "fracture": FRACTURE,
    "boundary": BOUNDARY,
    "gravity": GRAVITY,
    "work": WORK,
}


class KernelFlags(NamedTuple):
    """Which effects a row has: the constants of its compiled kernel.

    parts : of the joint law. points : whether the law acts at every contact point, else over the
    face as a whole, where joints always hold. turns, finite : whether blocks turn, and by any
    angle. start, end : whether anything acts on these ends. relaxed : whether the same kernel
    brings the blocks to rest first, for which it can damp their motion, without a place in the
    ledger.
    """

    parts: LawFlags
    points: bool
    turns: bool
    finite: bool
    mass_damping: bool
    local_damping: bool
    gravity: bool
    base: bool
    start: bool
    end: bool
    ledger: bool
    relaxed: bool

    @property
    def freedoms(self) -> int:
        """How many freedoms a block has."""
        return 6 if self.turns else 3

    @property
    def motion_rows(self) -> int:
        """Rows of a tile's motion."""
        return 2 * self.freedoms + self.finite

    @property
    def rate_rows(self) -> int:
        """Rows of history with the rates of the relative motion."""
        return self.freedoms if self.parts.dashpots else 0

    @property
    def point_rows(self) -> int:
        """Rows of history for each contact point: slides, opening, cohesion, path."""
        p = self.parts
        return 2 + p.softening + p.residual + p.path if self.points else 0

    @property
    def openings(self) -> slice:
        """The rows of history with the largest openings of the contact points."""
        return slice(self.rate_rows + 2, None, self.point_rows)

    @property
    def cohesions(self) -> slice:
        """The rows of history with the cohesions of the contact points."""
        return slice(self.rate_rows + 2 + self.parts.softening, None, self.point_rows)


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
