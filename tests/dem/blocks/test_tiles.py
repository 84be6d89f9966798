"""The order of contacts, and tiles that only need their neighbours."""

import numpy as np
import pytest

from dem.blocks.tiles import LANES, LENGTH, contacts_of, depth_of, marks


def tangled(seed, count, number, reach):
    """Return contacts at random between blocks that are at most so many numbers apart, some of them
    with walls, and their blocks [c, 2]."""
    random = np.random.default_rng(seed)
    i = random.integers(0, count, number)
    j = np.abs(i - 1 - random.integers(0, reach, number))
    j[random.random(number) < 0.1] = count + 1  # a wall
    start, end = random.standard_normal((2, number, 2))
    normal = np.tile([1.0, 0.0], (number, 1))
    blocks = np.stack([i, j], axis=1)
    beside = np.zeros((number, 2))
    law = random.integers(0, 5, number)
    return contacts_of(blocks, start, end, normal, (beside, beside), count, law=law), blocks, law


@pytest.mark.parametrize(
    ("seed", "count", "number", "reach"),
    [(0, 1000, 3000, 5), (1, 1000, 3000, 200), (2, 3, 500, 2), (3, 50, 0, 1), (4, 500, 65, 499)],
)
def test_a_tile_needs_its_neighbours_alone(seed, count, number, reach):
    """All forces of a tile's blocks come from it and the tile before; its contacts touch no block
    beyond the next tile. Contacts keep their numbers, of which `place` tells where they are."""
    contacts, blocks, law = tangled(seed, count, number, reach)
    chunk, first = contacts.first_chunk, contacts.first_block
    assert chunk[0] == first[0] == 0 and first[-1] == count
    assert chunk[-1] == -(-number // LANES) and (np.diff(first) >= 0).all()
    tile = np.searchsorted(LANES * chunk, contacts.place, side="right") - 1
    own = np.searchsorted(first[1:], np.where(blocks < count, blocks, blocks[:, :1]), side="right")
    assert ((own == tile[:, None]) | (own == tile[:, None] + 1)).all()
    assert (own.min(axis=1, initial=len(chunk)) >= tile).all()
    rows = contacts.pair.reshape(len(contacts.pair), 3, LANES).swapaxes(0, 1).reshape(3, -1)
    assert (rows[:, contacts.place] == [*(3 * blocks.T), law]).all()
    length = contacts.table[:, LENGTH * LANES :].ravel()
    assert (length > 0).sum() == number  # what fills the last chunk up has no force


def test_a_pass_takes_fewer_steps_of_wider_tiles_and_of_more_threads():
    """Within a core's own cache, and so that all threads have a band to work on."""
    narrow, wide = tangled(0, 20_000, 60_000, 5)[0], tangled(0, 20_000, 60_000, 2000)[0]
    assert 1 <= depth_of(wide, None, 1) < depth_of(narrow, None, 1) == 16
    tiles = len(wide.first_chunk) - 1
    for threads in (2, 5, 100):
        depth = depth_of(wide, None, threads)
        assert depth == 1 or tiles + depth - 1 >= threads * (depth + 1) - 1


def test_marks_name_each_place_in_its_tile():
    """In any order."""
    first, at, row = marks(np.array([7, 0, 3, 9]), np.array([0, 3, 8, 10]))
    assert at.tolist() == [0, 3, 7, 9] and row.tolist() == [1, 2, 0, 3]
    assert first.tolist() == [0, 1, 3, 4]
