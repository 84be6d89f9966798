"""What a pillar starts from: gravity and prestress, in space also by hand, under waves too."""

import numpy as np
import pytest

from closed_forms import cantilever
from jointwave import dem
from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.blocks import sliding_block
from jointwave.compare.exact.blocks.pillar import system_of

G = 9.81
DOWN = {"direction": [0, 1, 0]}
NO_LOAD = {"shape": "step", "amplitude": 0.0}
STILL = 1e-8  # out of balance, of the weight


@pytest.mark.parametrize("held", ["end", "start"], ids=["standing", "hanging, softening"])
def test_every_joint_carries_the_weight_beyond_it(pillar, held):
    """Static stress at joint j is j m g / A on a base, and j m g / A less the weight where the
    pillar hangs; it stays, to 1e-8 of the largest."""
    p = calibrate(pillar())
    scene = pillar(
        load=NO_LOAD,
        gravity=DOWN,
        ends={"start": "free", "end": "free", held: "fixed"},
        joints={"tensile_strength": 3e6, "fracture_energy": 1e5},
        record={"stress": [0.0, *p.joint_y.tolist(), 50.0], "interval": 1e-3},
    )
    result = dem.simulate(scene)
    weight = p.block_mass * G / p.area * np.arange(p.block_count + 1)
    expected = weight if held == "end" else weight - weight[-1]
    assert np.abs(result.stress.values - expected[:, None]).max() < 1e-8 * weight[-1]
    assert result.attrs["static_steps"] == 0
    assert result.attrs["static_out_of_balance"] < 1e-12


def incline(pillar, slope, static=False):
    """Return two blocks on a slope whose tangent is `slope` times that of the friction angle."""
    beta = np.arctan(slope * np.tan(np.radians(30.0)))
    return pillar(
        load=NO_LOAD,
        pillar__length=1.0,
        motion__rotation="none",
        ends__end="fixed",
        joints={"friction_angle": 30.0} | ({} if static else {"damping_ratio": 1.0}),
        prestress={"normal": 0.0} if static else None,
        gravity={"direction": [np.sin(beta), np.cos(beta), 0.0], "static": static},
        time__duration=0.1,
        record={"stress": [0.5], "velocity": [0.25], "interval": 1e-3},
    )


@pytest.mark.parametrize("slope", [0.98, 1.001])
def test_a_block_slides_above_the_friction_angle_alone(pillar, slope):
    """By g (sin - cos tan(phi)) to 1e-6 g, once the dashpots have stilled the normal vibration;
    below, it stands still and its shear force is all of m g sin(beta).

    Two blocks on their half spring, at the damping ratio 1: it decays as exp(-(2 - sqrt(2)) w t),
    w = sqrt(k / m) = 2700 1/s, below 1e-16 from 0.05 s on."""
    scene = incline(pillar, slope)
    assert sliding_block.applies(scene)
    result, exact = dem.simulate(scene), sliding_block.solve(scene)
    v, known = (x.velocity.values[0, :, 0] for x in (result, exact))
    expected = (known[-1] - known[-51]) / 0.05
    assert (v[-1] - v[-51]) / 0.05 == pytest.approx(expected, abs=1e-6 * 9.81)
    if slope < 1:
        assert np.abs(result.velocity.values[0, -10:]).max() < 1e-9
        shear, known = (float(x.shear[0, -1, 0]) for x in (result, exact))
        assert shear == pytest.approx(known, rel=1e-9)


@pytest.mark.parametrize(
    ("leaning", "message"),
    [
        (False, r"gravity: no static .* static = false"),
        (True, r"gravity: no static state: the block at .* slides"),
    ],
    ids=["hanging", "leaning above the friction angle"],
)
def test_without_a_static_state_the_scene_is_refused(pillar, leaning, message):
    weak = {"tensile_strength": 1e5, "fracture_energy": 1e2}
    hangs = {"gravity": {"direction": [0, -1, 0]}, "ends__end": "fixed", "joints": weak}
    with pytest.raises(SceneError, match=message):
        dem.simulate(incline(pillar, 1.01, True) if leaning else pillar(**hangs))


PAIR = {
    "pillar__length": 1.0,
    "load": NO_LOAD | {"direction": [1, 0, 0]},
    "record": {"stress": [0.0, 0.5, 1.0], "velocity": [0.25, 0.75], "interval": 1e-4},
    "time__duration": 1e-4,
}


def test_weight_under_a_prestress_counts_from_the_prestressed_state(row, plain):
    """Half springs 2 K hold 2 W by W / K, and the joint W by W / K."""
    pressed = {"prestress": {"normal": 2e6}, "ends__end": "fixed", "gravity": DOWN}
    scene = row(**PAIR, **pressed, motion__rotation="finite")
    p, result = calibrate(scene), dem.simulate(scene)
    W, k = G * p.block_mass, p.regular_stiffness * p.area
    moved = np.array([2, 1]) * W / k
    assert result.displacement.values[:, 0, 1] == pytest.approx(moved, rel=1e-6)
    carried = 2e6 + np.array([0, 1, 2]) * W / p.area
    assert result.stress.values[:, 0] == pytest.approx(carried, abs=1e-6 * W / p.area)


COLUMNS = {
    "vertices": ({}, 1.0, "end", "small"),
    "2 x 2 midpoint": ({"point_rule": "midpoint"}, 3 / 4, "end", "small"),
    "3 x 3 midpoint": ({"contact_points": 3, "point_rule": "midpoint"}, 8 / 9, "end", "small"),
    "2 x 2 Gauss": ({"contact_points": 2, "point_rule": "gauss"}, 1.0, "end", "small"),
    "hanging": ({}, 1.0, "start", "small"),
    "finite rotations": ({"point_rule": "midpoint"}, 3 / 4, "end", "finite"),
}


@pytest.mark.parametrize("joints, share, held, rotation", COLUMNS.values(), ids=COLUMNS)
@pytest.mark.parametrize("axis, turn, sign", [(0, 5, 1), (2, 3, -1)], ids="xz")
def test_static_deflection_is_the_sum(row, axis, turn, sign, joints, share, held, rotation):
    """The explicit sum. What is out of balance by 1e-8 W moves no freedom by more than 1e-8 W
    sum |K^-1|, and it stays where it is. At 1e-4 m/s2 nothing turns by more than 1e-7, of which
    finite rotations differ by as much."""
    weighs = {"direction": np.eye(3)[axis].tolist(), "acceleration": 1e-4}
    scene = row(
        load=NO_LOAD | {"direction": [0, 1, 0]},
        ends={"start": "free", "end": "free", held: "fixed"},
        joints=joints,
        gravity=weighs,
        motion__rotation=rotation,
        record={"stress": [], "velocity": (0.25 + 0.5 * np.arange(16)).tolist(), "interval": 0.01},
    )
    p, result = calibrate(scene), dem.simulate(scene)
    bending = p.regular_stiffness * share * p.side**4 / 12
    weight, shear = 1e-4 * p.block_mass, p.regular_shear_stiffness * p.area
    u, theta = cantilever.deflection(16, p.spacing, weight, shear, bending)
    flexibility = np.abs(np.linalg.inv(system_of(scene).stiffness.toarray())).sum(axis=1)
    bound = STILL * 16 * weight * flexibility.reshape(16, 6)[:, [axis, turn]]
    found = result.displacement.values
    order = slice(None) if held == "end" else slice(None, None, -1)
    assert (np.abs(found[order, 0, axis] - u) <= bound[order, 0]).all()
    turned = result.rotation.values[order, 0, turn - 3] * (1 if held == "end" else -1)
    assert (np.abs(turned - sign * theta) <= bound[order, 1]).all()
    assert 0 < result.attrs["static_out_of_balance"] <= STILL
    assert np.abs(found - found[:, :1]).max() < 1e-7 * np.abs(found).max()
