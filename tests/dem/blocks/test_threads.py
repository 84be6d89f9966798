"""However many threads share a step, every bit of a result is the same."""

import pytest

from jointwave.cases.errors import InterruptedRun, StoppedError
from jointwave.dem import simulate
from jointwave.dem.kernel.parts import divided
from jointwave.dem.prepare import prepared

SLIDES = {"friction_angle": 10.0, "cohesion": 2e5, "residual_cohesion": 0.0, "damping_ratio": 0.05}
UNDER_STRESS = {"xx": 2e6, "yy": 3e6}


def everything(rock_mass, joint, wave, stress=UNDER_STRESS, **numerics):
    """Return 750 blocks that slide, under stress, weight and damping, with quiet sides."""
    return rock_mass(
        joint_sets=[joint(**SLIDES)],
        prestress=stress,
        gravity={"static": False},
        damping={"mass_proportional": 5.0, "local": 0.05},
        waves=[wave(amplitude=4e6)],
        record={"fields": 2e-3},
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
def test_threads_change_no_bit(scene, rock_mass, joint, wave, narrow, assert_alike):
    """Of what receivers and snapshots have; parts are of a few tiles, and there are up to five."""
    expected = simulate(scene(rock_mass, joint, wave, threads=1))
    assert expected.velocity.any() and expected.attrs["blocks"] > 700
    for threads in (2, 3, 5):
        found = simulate(scene(rock_mass, joint, wave, threads=threads))
        assert found.attrs["threads"] == threads
        assert_alike(found, expected)


def test_a_run_on_threads_that_goes_on_is_the_same_to_the_last_bit(
    rock_mass, joint, wave, narrow, keeper_at
):
    """The ledger too, whose sums have one order for one number of threads."""
    own, keeper = everything(rock_mass, joint, wave, None, threads=2), keeper_at(40)
    with pytest.raises(InterruptedRun):
        simulate(own, keeper=keeper)
    assert simulate(own, keeper=keeper).equals(simulate(own))


def test_threads_stop_with_one_that_diverges(rock_mass, joint, wave, narrow, assert_alike):
    """At the same step, with the same sound part of the result."""
    forced, found = {"step_fraction": 1.5, "allow_unstable": True}, []
    for threads in (1, 2):
        with pytest.raises(StoppedError, match=r"diverged at") as stopped:
            simulate(everything(rock_mass, joint, wave, None, threads=threads, **forced))
        found.append(stopped.value)
    assert str(found[0]) == str(found[1])
    assert_alike(found[1].result, found[0].result)


def test_each_thread_has_as_many_chunks(rock_mass, joint, wave, narrow):
    """With those of tiles that others own, of which it steps some: to a tile."""
    chunks = prepared(everything(rock_mass, joint, wave)).model.chunks
    ends, depth = divided(chunks, None, 3, 2)
    assert depth > 1 and len(ends) == 3
    one, other = ends[1] + (depth - 1) / 2, ends[2] - ends[1] + (depth + 1) / 2
    assert abs(one - other) <= 1


def test_a_scene_of_the_effects_has_them(rock_mass, joint, wave):
    """Each term of the ledger is there, so that each of its sums is compared, and they add up."""
    energy = simulate(everything(rock_mass, joint, wave)).energy
    for term in energy.term.values:
        if term != "fracture":
            assert energy.sel(term=term).any(), term
    open_by = energy.sum("term") - 2 * energy.sel(term="work")
    assert abs(open_by - open_by[0]).max() < 1e-12 * abs(energy).max()
