"""A cemented joint among open ones, and an open one among cemented joints.

Two of three blocks are pulled off a wall by the end stress -p from t = 0 on. The joint between them
is cemented, that to the third block carries no tension: this block rests, and the other two fall
off at p A / 2 m. At rest relative to each other, the joint between them pulls with half of p."""

import pytest

import jointwave as jw

PULL = 1e5  # Pa
CEMENT = {"tensile_strength": 1e6, "fracture_energy": 500.0}
OPEN = {"tension": False}


def torn(law, layer):
    """Return a pillar of three blocks with this law of its joints and this other one of a joint."""
    return {
        "title": "Torn off",
        "pillar": {"length": 3.0, "side": 0.5, "block": 1.0},
        "rock": {"density": 2500.0, "p_speed": 2600.0, "s_speed": 1500.0, "intact_modulus": 5e10},
        "joints": law | {"damping_ratio": 0.5},
        "soft_layers": [layer],
        "load": {"shape": "step", "amplitude": -PULL},
        "ends": {"end": "fixed"},
        "time": {"duration": 0.01},
        "record": {"stress": [1.0, 2.0], "velocity": [0.5, 1.5, 2.5], "interval": 1e-4},
    }


@pytest.mark.parametrize("engine", ["dem", "continuum-jointed"])
def test_a_layer_may_hold_what_other_joints_do_not(engine, request):
    """Both ways to write the pillar are one, and keys of the layer come before those of joints."""
    if engine == "dem":  # no other test has its kernel
        request.getfixturevalue("plain")
    one = jw.simulate(torn(OPEN, CEMENT | {"y": 1.0}), engine)
    other = jw.simulate(torn(CEMENT, OPEN | {"y": 2.0}), engine)
    assert (one.stress == other.stress).all() and (one.velocity == other.velocity).all()
    held, free = one.stress.values[:, -1]
    assert held == pytest.approx(-PULL / 2, rel=1e-3) and abs(free) < 1e-6 * PULL
    fall = -PULL / (2 * 2500.0) * 0.01
    assert one.velocity.values[:, -1, 0] == pytest.approx([fall, fall, 0.0], rel=1e-2, abs=1e-3)
