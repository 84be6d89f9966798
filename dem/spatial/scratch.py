"""Where the numbers of one tile's step lie that the next tile does not need: rows of STRIDE lanes.

A joint's force lies one lane beyond its left block. The dashpots' share of it has the same rows as
the whole, DRAG further on.
"""

from dem.spatial.layout import STRIDE

FORCE = 0  # and moment: six rows
DRAG = 6 * STRIDE  # the dashpots' share of both
BEFORE = 12 * STRIDE  # velocities before the step, and angular velocities
LEFT = 18 * STRIDE  # moment on the left block, for finite rotations; the dashpots' share at + DRAG
MOMENTA = 27 * STRIDE  # angular momenta before the step, for finite rotations
SLID = 30 * STRIDE  # work done by sliding
ROWS = 31
