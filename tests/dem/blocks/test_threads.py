"""However many threads share a step, every bit of a result is the same."""

import pytest

from jointwave.dem import simulate

SLIDES = {"friction_angle": 10.0, "cohesion": 2e5, "residual_cohesion": 0.0, "damping_ratio": 0.05}
UNDER_STRESS = {"xx": 2e6, "yy": 3e6}


def everything(rock_mass, joint, wave, **numerics):
    """Return 750 blocks that slide, under stress, weight and damping, with quiet sides."""
    return rock_mass(
        joint_sets=[joint(**SLIDES)],
        prestress=UNDER_STRESS,
        gravity={"static": False},
        damping={"mass_proportional": 5.0, "local": 0.05},
        waves=[wave(amplitude=4e6)],
        numerics={"dem": {"block": 0.4} | numerics},
    )


def shaken(rock_mass, joint, wave, **numerics):
    """Return blocks whose base moves under them, without a ledger."""
    base = {"kind": "base", "side": "bottom", "direction": [0.6, 0.8], "quantity": "velocity"}
    return rock_mass(
        joint_sets=[joint(damping_ratio=0.05)],
        boundaries={"bottom": "fixed", "top": "free"},
        loads=[base | {"shape": "ricker", "amplitude": 0.02, "period": 0.004}],
        record={"energy": False},
        numerics={"dem": {"block": 0.4} | numerics},
    )


@pytest.mark.parametrize("scene", [everything, shaken])
def test_threads_change_no_bit(scene, rock_mass, joint, wave):
    """Five threads share a few tiles of blocks: some have none."""
    expected = simulate(scene(rock_mass, joint, wave, threads=1))
    assert expected.velocity.any() and expected.attrs["blocks"] > 700
    for threads in (2, 3, 5):
        found = simulate(scene(rock_mass, joint, wave, threads=threads))
        assert found.attrs["threads"] == threads
        assert found.equals(expected)


def test_a_scene_of_the_effects_has_them(rock_mass, joint, wave):
    """Each term of the ledger is there, so that each of its sums is compared, and they add up."""
    energy = simulate(everything(rock_mass, joint, wave)).energy
    for term in energy.term.values:
        if term != "fracture":
            assert energy.sel(term=term).any(), term
    open_by = energy.sum("term") - 2 * energy.sel(term="work")
    assert abs(open_by - open_by[0]).max() < 1e-12 * abs(energy).max()
