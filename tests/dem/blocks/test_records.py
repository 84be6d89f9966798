"""What a run leaves behind: snapshots, the law and the gap of its joints."""

import numpy as np
import pytest

from jointwave.dem import simulate
from jointwave.results.snapshots import snapshots_of

CROSSED = ({"dip": 10.0, "spacing": 2.5}, {"dip": 80.0, "spacing": 3.0, "name": "cross"})


@pytest.fixture
def crossed(rock_mass, joint, wave):
    """Return rock cut by two joint sets alone, with a wave, and tables changed."""

    def scene(**changes):
        sets = [joint(through=None, **one) for one in CROSSED]
        plain = {"joint_sets": sets, "waves": [wave(direction=[0.6, 0.8])]}
        return rock_mass(**(plain | {"numerics": None} | changes))

    return scene


def test_snapshots_are_the_motion_of_the_blocks_and_change_nothing(crossed):
    """A point of a block moves as its triangle's corners do, in proportion to its areas."""
    bare, filmed = simulate(crossed()), simulate(crossed(record={"fields": 2e-3}))
    for name in bare.data_vars:
        assert (bare[name].values == filmed[name].values).all(), name
    found = snapshots_of(filmed)
    assert found.kind == "triangle" and len(found.time) == 6
    edges = np.diff(found.points[found.cells], axis=1)
    areas = np.abs(np.cross(*np.moveaxis(edges, 1, 0))[:, 2]) / 2
    assert areas.sum() == pytest.approx(120, rel=1e-12)
    corners = np.insert(found.points[found.cells][..., :2], 2, 1.0, axis=2).swapaxes(1, 2)
    shares = np.linalg.solve(corners, np.array([[[4.3], [2.1], [1.0]]]))
    (cell,) = np.flatnonzero((shares > 0).all(axis=(1, 2)))
    share = shares[cell, :, 0]
    for name in ("velocity", "displacement"):
        own = np.einsum("c,tcx->tx", share, getattr(found, name)[:, found.cells[cell]])
        aim = filmed[name].values[0, ::20]
        assert np.abs(own[:, :2] - aim).max() < 1e-12 * np.abs(aim).max()
    of_block = found.stress[:, cell]  # the receiver's: the block moves as it is
    assert np.abs(of_block - filmed.stress.values[0, ::20]).max() < 1e-12 * np.abs(of_block).max()
    assert np.abs(found.velocity).max() > 0.05


def test_the_gap_and_the_slip_are_those_of_the_joint_alone(crossed, joint):
    """Without failure: traction over the joint's own stiffness, whatever the rock adds."""
    result = simulate(crossed())
    for axis, name, stiffness in ((0, "gap", 1e10), (1, "slip", 4e9)):
        own = -result.traction.values[0, :, axis] / stiffness
        assert np.abs(result[name].values[0] - own).max() < 1e-12 * np.abs(own).max()
