"""Runs that are interrupted and go on, that diverge, and how far their blocks have moved."""

import numpy as np
import pytest

from jointwave.cases.errors import InterruptedRun, StoppedError
from jointwave.continuum.monitor import farthest_joint, motion_of_blocks
from jointwave.continuum.plan import plan_of
from jointwave.continuum.run import simulate
from jointwave.continuum.scene import body_of
from jointwave.continuum.space.evaluation import blocks_of_nodes
from tests.continuum.bodies import PUSH

DAMPED = {"joints__damping_ratio": 0.02}
#: What a run has besides its motion: closure of half joints in front of dashpots, relaxation.
PILLARS = {
    "half joints": DAMPED | {"ends__end": "matched"},
    "rock of Q": DAMPED
    | {"soft_layers": [{"y": 1.0, "damping_ratio": 0.05}], "rock__quality_factor": 10.0},
}


def shaken(rock_mass, scheme):
    """Return a scene that slips, on a fixed base beside quiet sides."""
    record = {"points": [[2.0, 3.0]], "joints": [[3.0, 2.0]], "interval": 2e-5, "fields": 1.6e-4}
    return rock_mass(
        {"dip": 30.0, "through": [3.0, 2.0], "friction_angle": 30.0}, loads=[PUSH],
        boundaries={"bottom": "fixed", "left": "quiet", "right": "quiet"}, record=record,
        continuum={"steps_per_period": 50, "scheme": scheme},
    )  # fmt: skip


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
@pytest.mark.parametrize("kind", ["slip", *PILLARS])
def test_an_interrupted_run_goes_on_to_the_same_bits(
    rock_mass, short, keeper_at, scheme, kind, plain
):
    scene = shaken(rock_mass, scheme)
    if kind in PILLARS:
        scene = short({"scheme": scheme}, **PILLARS[kind])
    keeper, whole = keeper_at(45), simulate(scene)
    assert whole.attrs["scheme"] == scheme
    if kind == "slip":
        assert np.abs(whole["slip"]).max() > 1e-6 and whole.sizes["field_time"] > 10
    with pytest.raises(InterruptedRun):
        simulate(scene, keeper=keeper)
    assert simulate(scene, keeper=keeper).equals(whole)


def test_nothing_beyond_the_bounds_is_kept_where_no_ledger_is(short, plain):
    """Above the critical step motion grows by a third in every step, of hundreds between looks."""
    own = {"scheme": "explicit", "step_fraction": 1.01, "allow_unstable": True}

    def scene(interval, steps):
        record = {"interval": interval, "energy": False}
        return short(own, record=record, time__duration=interval * steps)

    critical = plan_of(scene(1e-3, 10)).critical
    said = r"diverged at t = .* s, step \d+ of .* times the critical step .* to at most 0\.9"
    with pytest.raises(StoppedError, match=said) as stopped:
        simulate(scene(1.01 * critical, 4000))
    result = stopped.value.result
    assert result.attrs["steps"] == 4000 and 0 < result.sizes["time"] < 1000
    assert np.abs(result.velocity).max() < 1e6


def test_the_first_instants_of_a_wave_are_within_the_bounds(rock_mass):
    """A run of one sample: the field of waves in jointed rock is at rest at t = 0 only."""
    wave = PUSH | {"kind": "P", "direction": [0.0, 1.0], "shape": "ricker"}
    sides = dict.fromkeys(("left", "right", "bottom", "top"), "quiet")
    record, of = {"points": [[2.0, 1.0]], "interval": 4e-4}, {"dip": 0.0, "through": [3.0, 2.0]}
    del wave["side"]
    scene = rock_mass(of, waves=[wave], boundaries=sides, record=record, time={"duration": 4e-4})
    assert np.abs(simulate(scene).velocity[:, -1]).max() > 0


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
def test_faces_of_a_pillar_may_part_but_not_slip(short, dim):
    """Its second block has moved by 3 mm across, and its third by 1 m along the pillar."""
    found = body_of(short(numerics__continuum__dim=dim))
    body, pillar = found.body, found.scene.pillar
    u = np.zeros((len(body.x), body.components))
    block = blocks_of_nodes(body)
    u[block == 2, min(1, body.components - 1)] = 1.0
    if dim == 1:
        assert farthest_joint(found, u.ravel()) is None
        return
    u[block == 1, 0] = 3e-3
    moved = farthest_joint(found, u.ravel())
    assert moved.by == pytest.approx(3e-3) and moved.size == pillar.side
    assert (moved.block, moved.other) in ((0, 1), (1, 2))
    assert moved.place == pytest.approx([pillar.block * moved.other])
