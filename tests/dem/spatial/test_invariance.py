"""The axes x and z are alike, and so are both their senses: to round-off."""

import numpy as np
import pytest

from jointwave import dem

JOINTS = {
    "elastic": {},
    "slip": {"joints": {"friction_angle": 20.0, "cohesion": 1e4}},
    "no tension": {"joints": {"tension": False}},
    "finite rotations": {
        "motion__rotation": "finite",
        "joints": {"tension": False, "friction_angle": 20.0, "point_rule": "midpoint"},
    },
}
QUARTER = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])  # about y
MIRROR = np.diag([-1, 1, 1])
FRAMES = {
    "quarter turn": QUARTER,
    "half turn": QUARTER @ QUARTER,
    "three quarters": QUARTER.T,
    "mirror": MIRROR,
    "mirror and quarter": QUARTER @ MIRROR,
}


def seen(result, frame):
    """Return all waveforms as vectors of the frame; a rotation in a mirror keeps its sense."""
    across = np.zeros((*result.shear.shape[:2], 3))
    across[..., [0, 2]] = result.shear.values
    turned = np.linalg.det(frame) * result.rotation.values @ frame.T
    vectors = {k: result[k].values @ frame.T for k in ("velocity", "displacement")}
    return {
        **vectors,
        "shear": across @ frame.T,
        "rotation": turned,
        "stress": result.stress.values,
    }


@pytest.mark.parametrize("joints", JOINTS.values(), ids=JOINTS)
def test_a_turned_load_gives_the_turned_result(row, joints):
    """Sums over the contact points in another order are all that differs: 1e-12 of the largest."""
    direction, at = np.array([0.48, 0.6, -0.64]), np.array([0.1, 0.0, -0.05])
    original = dem.simulate(row(**joints))
    plain = seen(original, np.eye(3))
    assert not joints or float(original.energy.sel(term="friction")[-1]) > 1e-3 * float(
        original.energy.sel(term="work")[-1]
    )
    for frame in FRAMES.values():
        d, a = (frame @ direction).tolist(), (frame @ at).tolist()
        scene = row(**joints, load__direction=d, load__at=[a[0], a[2]])
        turned = seen(dem.simulate(scene), np.eye(3))
        expected = seen(original, frame)
        for name, values in turned.items():
            assert np.abs(values - expected[name]).max() <= 1e-12 * np.abs(plain[name]).max()
