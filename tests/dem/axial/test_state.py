"""What a chain keeps from step to step, and where it lies."""

import pytest

from cases.material.calibrate import calibrate
from dem.axial.build import build
from numerics.cache_lines import CACHE_LINE
from results.arrays import arrays

EFFECTS = {"joints__damping_ratio": 0.1, "joints__tensile_strength": 1e5}


@pytest.mark.parametrize("blocks", [2, 3, 100])
def test_every_row_is_at_rest_and_starts_a_cache_line(pillar, blocks):
    """The loops over joints and blocks start there; the force of joint 0 is the second."""
    softening = {**EFFECTS, "joints__fracture_energy": 100.0}
    scene = pillar(**softening, pillar__length=0.5 * blocks, record={"stress": [0.5]})
    _, state, _, _ = build(scene)
    assert calibrate(scene).block_count == blocks
    rows = list(arrays((state.u, state.v, state.gap_rate, state.opening, state.dashpot_force)))
    assert [row.size for row in rows] == [blocks, blocks, blocks - 1, blocks - 1, blocks - 1]
    assert state.force.size == blocks + 1
    for row in (*rows, state.force[1:]):
        assert not row.any() and row.flags.c_contiguous
        assert row.ctypes.data % CACHE_LINE == 0
