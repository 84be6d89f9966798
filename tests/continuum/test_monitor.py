"""Runs that stop where blocks move further than contacts of the initial state allow."""

import numpy as np
import pytest

from jointwave.cases.errors import StoppedError
from jointwave.continuum.monitor import farthest_joint, motion_of_blocks
from jointwave.continuum.plan import plan_of
from jointwave.continuum.run import simulate
from jointwave.continuum.scene import body_of
from jointwave.continuum.space.evaluation import blocks_of_nodes

LOOSE = {"dip": 0.0, "through": [3.0, 2.0, 2.5], "tension": False}


def falling(rock_mass, dim, **numerics):
    """Return a block that falls from one that is held."""
    joint = LOOSE | {"through": LOOSE["through"][:dim]}
    own = {"continuum": {"size": 3.0, "order": 1, "scheme": "explicit"}, **numerics}
    record = {"points": [[2.0, 0.5, 0.5][:dim]], "interval": 1e-3, "fields": 1e-2}
    tables = {"gravity": {"static": False}, "boundaries": {"top": "fixed"}, "record": record}
    return rock_mass(joint, dim=dim, time={"duration": 0.2}, numerics=own, **tables)


@pytest.mark.parametrize("dim", [2, 3])
def test_a_falling_block_stops_the_run(rock_mass, dim):
    """At 2 % of its size, looked at twenty times; what was recorded until then is there."""
    with pytest.raises(StoppedError, match=r"numerics\.allow_large_motion = true") as stopped:
        simulate(falling(rock_mass, dim))
    words, result = str(stopped.value), stopped.value.result
    at = float(words.split("by t = ")[1].split(" s")[0])
    size = {2: 12.0, 3: 60.0}[dim] ** (1 / dim)
    reached = np.sqrt(2 * 0.02 * size / 9.81)
    assert reached < at < reached + 0.2 / 20 + 1e-3
    moved = float(words.split("has moved by ")[1].split(" m")[0])
    assert moved == pytest.approx(9.81 * at**2 / 2, rel=0.02)
    assert reached - 0.2 / 20 - 1e-3 < result.time.values[-1] < reached
    assert result.sizes["field_time"] == -(-result.sizes["time"] // 10)


def test_a_scene_may_allow_it(rock_mass):
    found = simulate(falling(rock_mass, 2, allow_large_motion=True))
    assert found.displacement.values[0, -1, 1] == pytest.approx(-9.81 * 0.2**2 / 2, rel=0.02)


def test_nothing_beyond_the_bounds_is_kept_where_no_ledger_is(rock_mass):
    """Above the critical step motion grows by a third in every step, of hundreds between looks."""
    push = {"kind": "pressure", "side": "top", "shape": "sine", "period": 1e-3, "amplitude": 1e6}
    joint, own = {"dip": 0.0, "through": [3.0, 2.0]}, {"scheme": "explicit", "step_fraction": 1.01}

    def scene(interval, steps):
        record = {"points": [[2.0, 1.5]], "interval": interval, "energy": False}
        continuum = own | {"allow_unstable": True}
        time = {"duration": interval * steps}
        return rock_mass(joint, continuum=continuum, loads=[push], record=record, time=time)

    critical = plan_of(scene(1e-3, 10)).critical
    with pytest.raises(StoppedError, match=r"times the critical step") as stopped:
        simulate(scene(1.01 * critical, 4000))
    result = stopped.value.result
    assert result.attrs["steps"] == 4000 and 0 < result.sizes["time"] < 1000
    assert np.abs(result.velocity).max() < 1e6


@pytest.mark.parametrize("cell", ["triangle", "quadrilateral"])
def test_blocks_move_as_their_nodes_do(made, cell):
    """Rigid motions, each of its own."""
    joints = {"dip": 0.0, "through": [3.0, 1.0]}, {"dip": 90.0, "through": [2.5, 2.0]}
    found = made(*joints, continuum={"cell": cell})
    motion = np.random.default_rng(4).uniform(-1.0, 1.0, (found.blocks.count, 3))
    node = blocks_of_nodes(found.body)
    arm = found.body.x - found.blocks.centroid[node]
    u = motion[node, :2] + motion[node, 2:] * arm[:, ::-1] * [-1, 1]
    np.testing.assert_allclose(motion_of_blocks(found, u.ravel()), motion, rtol=0, atol=1e-12)


@pytest.mark.parametrize("dim", [1, 2, 3])
def test_faces_of_a_pillar_may_part_but_not_slip(pillar, dim):
    """Its second block has moved by 3 mm across, and its third by 1 m along the pillar."""
    scene = pillar(
        pillar__length=2.0,
        rock__intact_modulus=5e10,
        record={"velocity": [0.0]},
        numerics__continuum={"dim": dim, "elements_per_block": 2},
    )
    found = body_of(scene)
    body, spacing = found.body, scene.pillar.block
    u = np.zeros((len(body.x), body.components))
    block = blocks_of_nodes(body)
    u[block == 2, min(1, body.components - 1)] = 1.0
    if dim == 1:
        assert farthest_joint(found, u.ravel()) is None
        return
    u[block == 1, 0] = 3e-3
    moved = farthest_joint(found, u.ravel())
    assert moved.by == pytest.approx(3e-3) and moved.size == scene.pillar.side
    assert (moved.block, moved.other) in ((0, 1), (1, 2))
    assert moved.place == pytest.approx([spacing * moved.other])
