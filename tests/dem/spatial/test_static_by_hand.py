"""Two blocks at rest in space, worked out by hand, and by relaxation as plain Python."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases.material.calibrate import calibrate

pytestmark = pytest.mark.usefixtures("plain")

PAIR = {
    "pillar__length": 1.0,
    "load": {"shape": "step", "amplitude": 0.0, "direction": [1, 0, 0]},
    "record": {"stress": [0.0, 0.5, 1.0], "velocity": [0.25, 0.75], "interval": 1e-4},
    "time__duration": 1e-4,
}
STILL = 1e-8  # out of balance, of the weight


@pytest.mark.parametrize("rotation", ["small", "finite"])
@pytest.mark.parametrize("axis, about, sign", [(0, 2, 1), (2, 0, -1)], ids="xz")
@pytest.mark.parametrize("held", ["start", "end"])
def test_a_pair_leans_out_from_its_wall(row, rotation, axis, about, sign, held):
    """Weights W across: 2 W and 4 W h by the wall's half springs 2 S and 2 B, W and W h by the
    joint's S and B; each face goes along by h times its block's rotation.

    At 1e-4 m/s2 nothing turns by more than 1e-7, of which finite rotations differ by as much; what
    is out of balance by 1e-8 of 2 W moves nothing by more than some 1e-7 of its way.
    """
    direction = np.eye(3)[axis].tolist()
    scene = row(
        **PAIR,
        motion__rotation=rotation,
        ends={"start": "free", "end": "free", held: "fixed"},
        gravity={"direction": direction, "acceleration": 1e-4},
    )
    p, result = calibrate(scene), dem.simulate(scene)
    # The paper's two midpoints a side have 3/4 of the bending stiffness of the face.
    W, S, B = 1e-4 * p.block_mass, p.regular_shear_stiffness * p.area, p.regular_stiffness
    B, h = B * 0.75 * p.side**4 / 12, p.spacing / 2
    near = 4 * W * h / (2 * B)
    far = near + W * h / B
    moved = 2 * W / (2 * S) + h * near
    beyond = moved + h * near + W / S + h * far
    order = slice(None) if held == "start" else slice(None, None, -1)
    turn = sign if held == "end" else -sign
    u, theta = result.displacement.values[order, 0], result.rotation.values[order, 0]
    assert u[:, axis] == pytest.approx([moved, beyond], rel=1e-6)
    assert theta[:, about] == pytest.approx([turn * near, turn * far], rel=1e-6)
    across = 0 if axis == 0 else 1
    expected = np.array([-2, -1, 0] if held == "start" else [0, 1, 2]) * W / p.area
    assert result.shear.values[:, 0, across] == pytest.approx(expected, abs=1e-6 * W / p.area)
    assert 0 < result.attrs["static_out_of_balance"] <= STILL
    assert result.attrs["static_steps"] > 0


@pytest.mark.parametrize("rotation", ["none", "small", "finite"])
@pytest.mark.parametrize("ends", [("free", "free"), ("quiet", "fixed"), ("fixed", "matched")])
def test_a_prestressed_pair_is_at_rest_at_once(row, rotation, ends):
    """The joint and what is fixed carry it; results count displacements from there."""
    load = {"quantity": "velocity"} if ends[0] == "fixed" else {}
    scene = row(
        **{**PAIR, "load": PAIR["load"] | load},
        motion__rotation=rotation,
        ends=dict(zip(("start", "end"), ends, strict=True)),
        prestress={"normal": 2e6},
    )
    p, result = calibrate(scene), dem.simulate(scene)
    gap = 2e6 / p.regular_stiffness
    assert np.abs(result.stress.values / 2e6 - 1).max() < 1e-12
    assert np.abs(result.displacement.values).max() < 1e-12 * gap
    assert np.abs(result.velocity.values).max() < 1e-9 * gap / result.attrs["dt"]
    assert result.attrs["static_steps"] == 0
    elastic = result.energy.sel(term="elastic").values
    if "fixed" not in ends:  # whose half springs store as well
        assert elastic == pytest.approx(p.area * 2e6 * gap / 2, rel=1e-12)
    assert elastic[0] > 0 and np.abs(elastic / elastic[0] - 1).max() < 1e-12
    if rotation != "none":
        assert not np.abs(result.rotation.values).any()


def test_weight_under_a_prestress_counts_from_the_prestressed_state(row):
    """Half springs 2 K hold 2 W by W / K, and the joint W by W / K."""
    scene = row(
        **PAIR,
        ends__end="fixed",
        prestress={"normal": 2e6},
        gravity={"direction": [0, 1, 0]},
        motion__rotation="finite",
    )
    p, result = calibrate(scene), dem.simulate(scene)
    W, k = 9.81 * p.block_mass, p.regular_stiffness * p.area
    moved = np.array([2, 1]) * W / k
    assert result.displacement.values[:, 0, 1] == pytest.approx(moved, rel=1e-6)
    carried = 2e6 + np.array([0, 1, 2]) * W / p.area
    assert result.stress.values[:, 0] == pytest.approx(carried, abs=1e-6 * W / p.area)
