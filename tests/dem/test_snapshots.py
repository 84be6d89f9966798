"""Snapshots of the blocks are what receivers in every block would record, and change nothing."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from jointwave import dem
from jointwave.cases import SceneError
from jointwave.results.snapshots import snapshots_of

BLOCKS, SPACING, SIDE = 16, 0.5, 0.5
CENTRES = [SPACING * (i + 0.5) for i in range(BLOCKS)]
CONTACTS = [SPACING * i for i in range(BLOCKS + 1)]
EVERYWHERE = {
    "pillar__length": SPACING * BLOCKS,
    "load__amplitude": 1e6,
    "time__duration": 0.02,
    "ends__start": "matched",
    "ends__end": "fixed",
    "joints__damping_ratio": 0.02,
    "record": {"stress": CONTACTS, "velocity": CENTRES, "interval": 1e-4},
}
OBLIQUE = {"load__direction": [0.48, 0.6, -0.64], "load__at": [0.1, -0.05]}
LOOSE = {"joints__friction_angle": 20.0, "joints__tension": False}
UNDAMPED = {"joints__damping_ratio": None, "ends": {"start": "free", "end": "free"}}
MOTIONS = {
    "axial": {},
    "breaking": UNDAMPED | {"joints__tensile_strength": 1e5, "joints__fracture_energy": 5.0},
    "small rotation": OBLIQUE | {"damping__mass_proportional": 50.0},
    "finite rotation": OBLIQUE | LOOSE | UNDAMPED | {"motion__rotation": "finite"},
}


@pytest.mark.parametrize("motion", MOTIONS)
def test_snapshots_are_what_receivers_record_and_change_no_bit(pillar, motion):
    """At every block's centroid and contact, to the round-off of the mean over eight corners."""

    def run(**fields):
        keys = EVERYWHERE | MOTIONS[motion]
        return dem.simulate(pillar(**keys | {"record": keys["record"] | fields}))

    bare, filmed = run(), run(fields=7e-4)
    added = {str(name).removeprefix("field_") for name in filmed.data_vars} - set(bare.data_vars)
    assert added == {"points", "cells", "block"}
    for name in bare.data_vars:
        np.testing.assert_array_equal(bare[name].values, filmed[name].values, str(name))
    found, rows = snapshots_of(filmed), slice(None, None, 7)
    np.testing.assert_array_equal(found.time, filmed.time.values[rows])
    for name in ("displacement", "velocity"):
        corners = getattr(found, name).reshape(len(found.time), BLOCKS, 8, 3)
        recorded = np.moveaxis(filmed[name].values[:, rows], 0, 1)
        axes = [1] if recorded.shape[2] == 1 else [0, 1, 2]
        off = np.abs(corners.mean(axis=2)[..., axes] - recorded)
        assert off.max() <= 1e-15 * np.abs(corners).max()
    contacts = filmed.stress.values[:, rows].T
    np.testing.assert_array_equal(found.stress, (contacts[:, :-1] + contacts[:, 1:]) / 2)


TOPPLING = {
    "pillar__length": 1.0,
    "load__amplitude": 6e6,
    "load__direction": [0.6, 0.8, 0.0],
    "load__at": [0.2, 0.1],
    "motion__rotation": "finite",
    "ends__start": "free",
    "ends__end": "free",
    "joints__tension": False,
    "joints__friction_angle": 20.0,
    "time__duration": 0.1,
    "record": {"velocity": [0.25, 0.75], "interval": 5e-5, "fields": 5e-5},
}


def test_blocks_that_turn_by_any_angle_move_as_rigid_bodies(pillar):
    """Blocks that turn by more than a third of a turn keep all distances, and turn as recorded.
    v - v_centre is at right angles to the arm, and the rate of what is drawn, to second order:
    differences over two samples are off by four times as much as those over one."""
    result = dem.simulate(pillar(**TOPPLING))
    found = snapshots_of(result)
    x = (found.points + found.displacement).reshape(-1, 2, 8, 3)
    rest = found.points.reshape(2, 8, 3)
    v = found.velocity.reshape(-1, 2, 8, 3)
    arms, rest, pace = (a - a.mean(axis=-2, keepdims=True) for a in (x, rest, v))
    turns = Rotation.from_rotvec(np.moveaxis(result.rotation.values, 0, 1).reshape(-1, 3))
    turns = turns.as_matrix().reshape(-1, 2, 3, 3)
    assert np.trace(turns, axis1=2, axis2=3).min() < 0  # 1 + 2 cos(angle)
    np.testing.assert_allclose(arms, np.einsum("tbij,bcj->tbci", turns, rest), rtol=0, atol=1e-13)

    late = found.time > 0.03  # the blow is over, and nothing holds the blocks: they turn freely
    x, v, arms, pace = (a[late] for a in (x, v, arms, pace))
    scale, h = np.abs(pace).max(), 5e-5
    assert scale > 10
    assert np.abs((arms * pace).sum(axis=3)).max() < 1e-13 * scale
    one = np.abs((x[3:-1] - x[1:-3]) / (2 * h) - v[2:-2]).max()
    two = np.abs((x[4:] - x[:-4]) / (4 * h) - v[2:-2]).max()
    assert one < 1e-4 * scale
    assert two / one == pytest.approx(4, rel=0.01)


def test_a_broken_joint_opens_between_its_own_nodes(pillar):
    """Between the facing corners is the gap of the joint; where joints hold it is elastic."""
    breaking = EVERYWHERE | MOTIONS["breaking"]
    changes = breaking | {"record": breaking["record"] | {"fields": 0.02}}
    result = dem.simulate(pillar(**changes))
    found, broke = snapshots_of(result), ~np.isnan(result.break_time.values)
    u = found.displacement[-1].reshape(BLOCKS, 8, 3)
    left, right = [2, 3, 6, 7], [1, 0, 5, 4]
    np.testing.assert_array_equal(
        found.points.reshape(BLOCKS, 8, 3)[:-1, left], found.points.reshape(BLOCKS, 8, 3)[1:, right]
    )
    gaps = u[1:, right, 1] - u[:-1, left, 1]
    moved = result.displacement.values[:, -1, 0]
    np.testing.assert_allclose(gaps, np.repeat(np.diff(moved)[:, None], 4, axis=1), atol=1e-16)
    critical = 2 * 5.0 / 1e5
    assert 0 < broke.sum() < BLOCKS - 1
    assert gaps[broke].max() > critical > gaps[~broke].max()


def test_too_many_snapshots_of_too_many_blocks_are_refused(pillar, monkeypatch):
    """Whatever memory there is: no file holds them."""
    monkeypatch.setenv("JOINTWAVE_MEMORY", "1e6")
    long = {"pillar__length": 5e4, "record__fields": 1e-3}
    with pytest.raises(SceneError, match=r"record\.fields = .*121 snapshots of 800,000 nodes"):
        dem.simulate(pillar(**long))
