"""Small rotations are checked, not trusted."""

import pytest

from jointwave import dem
from jointwave.cases.errors import SceneError

TWIST = {"shape": "step", "direction": [0, 1, 0], "arm": 0.1}


def test_row_that_turns_too_far_is_refused(row):
    """The line names the key, the block, its angle and the remedy."""
    load = {**TWIST, "amplitude": 1e6}
    with pytest.raises(
        SceneError, match=r"motion\.rotation .* turned .* motion.rotation = 'finite'"
    ):
        dem.simulate(row(load=load))
