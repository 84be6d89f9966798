"""However many threads share a step, every bit of a result is the same."""

import numpy as np
import pytest

from jointwave.dem import simulate
from jointwave.dem.blocks.leapfrog import make_stepper, march, samples_for
from jointwave.dem.blocks.model import state_at_rest
from jointwave.dem.blocks.system import prepared
from jointwave.dem.static import NEVER

SLIDES = {"friction_angle": 30.0, "cohesion": 2e5, "residual_cohesion": 0.0, "damping_ratio": 0.05}
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
    """Five threads share the three chunks of blocks and six of contacts: two have no block."""
    expected = simulate(scene(rock_mass, joint, wave, threads=1))
    assert expected.velocity.any() and expected.attrs["blocks"] > 700
    for threads in (2, 3, 5):
        found = simulate(scene(rock_mass, joint, wave, threads=threads))
        assert found.attrs["threads"] == threads
        assert found.equals(expected)


def test_a_scene_of_the_effects_has_them(rock_mass, joint, wave):
    """Each term of the ledger is there, so that each of its sums is compared."""
    energy = simulate(everything(rock_mass, joint, wave)).energy
    for term in energy.term.values:
        if term != "fracture":
            assert energy.sel(term=term).any(), term


@pytest.mark.parametrize("threads", [1, 2])
def test_steps_in_parts_by_one_marcher_change_no_bit(threads, rock_mass, joint, wave):
    """Of blocks that slide above walls at 1 cm/s; more than it has room for is refused."""
    own = shaken(rock_mass, lambda **law: joint(**SLIDES), wave)
    model = prepared(own).model
    shake = np.full((20, model.walls, 2), 1e-2)
    whole, parts = state_at_rest(model), state_at_rest(model)
    for state in (whole, parts):
        state.v[:] = 0.1 * np.random.default_rng(1).normal(size=state.v.shape)
    march(model, whole, samples_for(model, 0), NEVER, (1, 21), shake=shake)
    take = make_stepper(model, parts, samples_for(model, 0), 8, shake=shake[:8], threads=threads)
    for first, last in ((1, 9), (9, 17), (17, 21)):
        take(NEVER, first, last)
    assert (whole.u == parts.u).all() and (whole.v == parts.v).all()
    assert (whole.history == parts.history).all()
    with pytest.raises(ValueError, match="9 steps at a time, at most 8"):
        take(NEVER, 21, 30)
