"""Motion of blocks that turn by any angle in space, whose momenta are in place of velocities."""

from jointwave.dem.rotation import angular_velocity, three, turned_freely
from jointwave.joints.formula import formula


@formula
def quaternion(turn, u, block):
    """Return that of a block from its displacements u and the scalar parts."""
    x, y, z = three(u, 6 * block + 3, 1)
    return turn[block], x, y, z


@formula
def turn_blocks(blocks, first, turn, u, v, dt):
    """Turn blocks from `first` on by their angular momenta in dt, s."""
    for block in range(u.size // 6):
        i, free = 6 * block + 3, blocks.free[first + block]
        q = quaternion(turn, u, block)
        turn[block], u[i], u[i + 1], u[i + 2] = turned_freely(free, q, three(v, i, 1), dt)


@formula
def rate(blocks, first, turn, u, v, i):
    """Return freedom i of the velocities of blocks from `first` on."""
    block = i // 6
    if i % 6 < 3:
        return v[i]
    q, momentum = quaternion(turn, u, block), three(v, 6 * block + 3, 1)
    return angular_velocity(blocks.free[first + block], q, momentum)[i % 6 - 3]
