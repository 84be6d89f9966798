"""What a tile leaves of itself at a sample: forces of contacts, motion of blocks."""

from dem.spatial.layout import STRIDE as R
from numerics.jit import inlined


@inlined
def sample_before(receivers, samples, half, s, q, t, c):
    """Read forces, displacements and half the velocities of tile t for sample c."""
    for r in range(receivers.contact_tile.size):
        if receivers.contact_tile[r] == t:
            for k in range(half):
                samples.force[r, k, c] = q[k * R + receivers.contact_lane[r]]
    for r in range(receivers.block_tile.size):
        if receivers.block_tile[r] == t:
            lane = receivers.block_lane[r]
            for k in range(half):
                samples.displacement[r, k, c] = s[k * R + lane]
                samples.velocity[r, k, c] = 0.5 * s[(half + k) * R + lane]
            for k in range(half, samples.displacement.shape[1]):  # the scalar part of a quaternion
                samples.displacement[r, k, c] = s[(half + k) * R + lane]


@inlined
def sample_after(receivers, samples, half, s, t, c):
    """Add the other half of the velocities."""
    for r in range(receivers.block_tile.size):
        if receivers.block_tile[r] == t:
            for k in range(half):
                samples.velocity[r, k, c] += 0.5 * s[(half + k) * R + receivers.block_lane[r]]
