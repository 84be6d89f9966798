"""What is on but idle changes nothing, or round-off alone; and no axis is special."""

import numpy as np
import pytest

from jointwave import dem

STEP = {"load": {"shape": "step", "amplitude": 1e6}, "time__duration": 0.03}
#: Name: the fixture, what both scenes have, and what one of them has on.
IDLE = {
    "dashpots of zero": ("pillar", STEP, {"joints__damping_ratio": 0.0}),
    "tension never asked": ("pillar", STEP, {"joints__tension": False}),
    "one cut": ("pillar", STEP, {"soft_layers": [{"y": 20.0, "tension": False}]}),
    "ledger": ("pillar", STEP, {"record__energy": False}),
    "strength never reached": (
        "pillar", STEP, {"joints": {"tensile_strength": 1e12, "fracture_energy": 1e18}},
    ),
    "weightless under a prestress of zero": (
        "pillar", STEP | {"ends__end": "fixed"},
        {
            "gravity": {"direction": [0, 1, 0], "acceleration": 0.0, "static": False},
            "prestress": {"normal": 0.0},
        },
    ),
    "ledger in space": ("row", {}, {"record__energy": False}),
    "layer like the rock": ("row", {}, {"soft_layers": [{"y": 2.0}]}),
    "points by default": ("row", {}, {"joints__contact_points": 2}),
}  # fmt: skip
FIELDS = ("stress", "shear", "velocity", "displacement", "rotation")


def waveforms(result):
    """Return the samples of every field."""
    return {name: result[name].values for name in FIELDS if name in result}


@pytest.mark.parametrize(("fixture", "own", "idle"), IDLE.values(), ids=IDLE)
def test_idle_effect_changes_no_bit(fixture, own, idle, request):
    """The kernel with an effect on but idle gives the very numbers of the kernel without it."""
    make = request.getfixturevalue(fixture)
    without, with_idle = (dem.simulate(make(**own, **more)) for more in ({}, idle))
    assert without.attrs["dt"] == with_idle.attrs["dt"]
    found = waveforms(with_idle)
    assert all((values == found[name]).all() for name, values in waveforms(without).items())


def test_friction_that_is_never_reached_changes_round_off_alone(row):
    """A joint that may slip or open is summed over its points, one that holds over its section.

    Both sums differ in the last digits, which some thousand steps make 1e-12 of the largest."""
    idle = {"friction_angle": 20.0, "cohesion": 1e9, "point_rule": "midpoint"}
    without, with_idle = (waveforms(dem.simulate(row(**x))) for x in ({}, {"joints": idle}))
    for name, values in without.items():
        assert np.abs(values - with_idle[name]).max() < 1e-12 * np.abs(values).max()


QUARTER = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]])  # about y
MIRROR = np.diag([-1, 1, 1])
FRAMES = (QUARTER, QUARTER @ QUARTER, QUARTER.T, MIRROR, QUARTER @ MIRROR)
JOINTS = {
    "elastic": {},
    "slip": {"joints": {"friction_angle": 20.0, "cohesion": 1e4}},
    "finite rotations": {
        "motion__rotation": "finite",
        "joints": {"tension": False, "friction_angle": 20.0, "point_rule": "midpoint"},
    },
}


def seen(result, frame):
    """Return all waveforms as vectors of the frame; a rotation in a mirror keeps its sense."""
    across = np.zeros((*result.shear.shape[:2], 3))
    across[..., [0, 2]] = result.shear.values
    vectors = {k: result[k].values @ frame.T for k in ("velocity", "displacement")}
    vectors |= {"shear": across @ frame.T, "stress": result.stress.values}
    return vectors | {"rotation": np.linalg.det(frame) * result.rotation.values @ frame.T}


@pytest.mark.parametrize("joints", JOINTS.values(), ids=JOINTS)
def test_a_turned_load_gives_the_turned_result(row, joints):
    """The axes x and z are alike, and so are both their senses. Sums over the contact points in
    another order are all that differs: 1e-12 of the largest."""
    direction, at = np.array([0.48, 0.6, -0.64]), np.array([0.1, 0.0, -0.05])
    original = dem.simulate(row(**joints))
    plain = seen(original, np.eye(3))
    if joints:
        last = original.energy.isel(time=-1)
        assert last.sel(term="friction") > 1e-3 * last.sel(term="work")
    for frame in FRAMES:
        d, a = (frame @ direction).tolist(), (frame @ at).tolist()
        turned = dem.simulate(row(**joints, load__direction=d, load__at=[a[0], a[2]]))
        expected = seen(original, frame)
        for name, values in seen(turned, np.eye(3)).items():
            assert np.abs(values - expected[name]).max() <= 1e-12 * np.abs(plain[name]).max()
