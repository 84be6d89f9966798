"""Loads whose squares overflow or underflow: scaled if the scene is homogeneous, else refused."""

import numpy as np
import pytest

from jointwave import dem
from jointwave.cases.errors import SceneError
from jointwave.cases.loads import load_history
from jointwave.compare.exact.bar import images


@pytest.mark.parametrize("amplitude", [1e-300, -1e200, 1e300])
def test_load_is_near_one_and_its_power_of_two_is_kept(pillar, amplitude):
    """The history is divided by the factor of the result, to the last digit."""
    scene = pillar(load__amplitude=amplitude, record__energy=False)
    history = load_history(scene)
    assert 0.5 <= abs(history.amplitude) <= 1
    assert history.amplitude * scene.load.scale == amplitude


def test_load_of_any_ordinary_size_is_left_alone(pillar):
    """Between 1e-30 and 1e30 and at zero nothing is scaled."""
    for amplitude in (0.0, 1e-30, 1e6, -1e30):
        scene = pillar(load__amplitude=amplitude)
        assert scene.load.scale == 1 and load_history(scene).amplitude == amplitude


def test_engine_and_exact_solution_agree_at_any_size(pillar):
    """The difference of bar and blocks is the same under 1e300 Pa as under 1 Pa."""
    changes = {"record__energy": False, "pillar__length": 10.0, "record__stress": [5.0]}
    changes["record__velocity"] = []

    def apart(amplitude):
        scene = pillar(load__amplitude=amplitude, **changes)
        one, other = (
            s.stress.values / amplitude for s in (dem.simulate(scene), images.solve(scene))
        )
        return np.linalg.norm(one - other) / np.linalg.norm(other)

    assert apart(1e300) == pytest.approx(apart(1.0), rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        (
            {"joints__tensile_strength": 1e5, "joints__fracture_energy": 1e2},
            "joints.tensile_strength",
        ),
        ({"soft_layers": [{"y": 5.0, "cohesion": 1.0}]}, "soft_layers[0].cohesion"),
        ({"prestress": {"normal": 1.0}}, "prestress"),
        ({"load__direction": [1.0, 0.0, 0.0]}, "load.direction"),
        ({"record__energy": True}, "record.energy"),
        ({"load__amplitude": 1e301}, "load.amplitude"),
        ({"load__amplitude": 1e-301}, "load.amplitude"),
    ],
)
def test_what_does_not_scale_is_refused(pillar, changes, key):
    """One line names the conflicting key."""
    with pytest.raises(SceneError) as error:
        pillar(**{"load__amplitude": 1e300, "record__energy": False} | changes)
    assert error.value.key == key and "\n" not in str(error.value)
