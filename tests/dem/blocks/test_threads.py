"""However many threads share a step, every bit of a result is the same."""

import numba
import pytest

from jointwave.cases.errors import InterruptedRun, StoppedError
from jointwave.dem import simulate
from jointwave.dem.kernel.parts import divided, thread_count
from jointwave.dem.prepare import prepared
from jointwave.dem.run import plan

SLIDES = {"friction_angle": 10.0, "cohesion": 2e5, "residual_cohesion": 0.0, "damping_ratio": 0.05}
UNDER_STRESS = {"xx": 2e6, "yy": 3e6}


@pytest.fixture
def everything(rock_mass, joint, wave):
    """Return 750 blocks that slide, under stress, weight and damping, with quiet sides."""

    def scene(**numerics):
        return rock_mass(
            joint_sets=[joint(**SLIDES)],
            prestress=UNDER_STRESS,
            gravity={"static": False},
            damping={"mass_proportional": 5.0, "local": 0.05},
            waves=[wave(amplitude=4e6)],
            record={"fields": 2e-3},
            numerics={"dem": {"block": 0.4} | numerics},
        )

    return scene


@pytest.fixture
def shaken(rock_mass, joint):
    """Return blocks whose base moves under them, without a ledger."""
    base = {"kind": "base", "side": "bottom", "direction": [0.6, 0.8], "quantity": "velocity"}

    def scene(**numerics):
        return rock_mass(
            joint_sets=[joint(damping_ratio=0.05)],
            boundaries={"bottom": "fixed", "top": "free"},
            loads=[base | {"shape": "ricker", "amplitude": 0.02, "period": 0.004}],
            record={"energy": False},
            numerics={"dem": {"block": 0.4} | numerics},
        )

    return scene


@pytest.fixture
def turning(row):
    """Return 400 blocks that slide and turn by any angle."""
    slides = {"joints__friction_angle": 20.0, "joints__tension": False}

    def scene(**numerics):
        keys = {f"numerics__dem__{key}": value for key, value in numerics.items()} | slides
        finite = {"motion__rotation": "finite", "time__duration": 2e-3, "ends__end": "matched"}
        return row(**keys, **finite, pillar__length=200.0)

    return scene


@pytest.mark.parametrize("name", ["everything", "shaken", "turning"])
def test_threads_change_no_bit(name, request, narrow, assert_alike):
    """Of what receivers and snapshots have; parts are of a few tiles, and there are up to five."""
    scene = request.getfixturevalue(name)
    expected = simulate(scene(threads=1))
    assert expected.velocity.any() and expected.attrs["blocks"] >= 400
    for threads in (2, 3, 5):
        found = simulate(scene(threads=threads))
        assert found.attrs["threads"] == threads
        assert_alike(found, expected)
    if name == "everything":  # each sum of the ledger is compared, and they add up
        energy = expected.energy
        for term in set(energy.term.values) - {"fracture"}:
            assert energy.sel(term=term).any(), term
        open_by = energy.sum("term") - 2 * energy.sel(term="work")
        assert abs(open_by - open_by[0]).max() < 1e-12 * abs(energy).max()


def test_a_run_on_threads_that_goes_on_is_the_same_to_the_last_bit(everything, narrow, keeper_at):
    """Waves, snapshots, and the ledger, whose sums have one order for one number of threads."""
    own, keeper = everything(threads=2), keeper_at(40)
    with pytest.raises(InterruptedRun):
        simulate(own, keeper=keeper)
    assert 40 <= keeper.done < 100
    assert simulate(own, keeper=keeper).equals(simulate(own))


def test_threads_stop_with_one_that_diverges(everything, narrow, assert_alike):
    """At the same step, in one line, with the same sound part of the result."""
    forced, found = {"step_fraction": 1.5, "allow_unstable": True}, []
    for threads in (1, 2):
        with pytest.raises(StoppedError, match=r"^.*diverged at.*fastest at \[.*$") as stopped:
            simulate(everything(threads=threads, **forced))
        found.append(stopped.value)
    assert str(found[0]) == str(found[1])
    assert_alike(found[1].result, found[0].result)


def test_each_thread_has_as_many_chunks(everything, narrow):
    """With those of tiles that others own, of which it steps some: to a tile."""
    chunks = prepared(everything()).model.chunks
    ends, depth = divided(chunks, None, 3, 2)
    assert depth > 1 and len(ends) == 3
    one, other = ends[1] + (depth - 1) / 2, ends[2] - ends[1] + (depth + 1) / 2
    assert abs(one - other) <= 1


def test_a_long_row_takes_the_processors_that_it_may_use(monkeypatch, row):
    """Those that numba may use, by default; a row of less than 40,000 blocks takes one."""
    monkeypatch.setattr(numba.config, "NUMBA_NUM_THREADS", 3)
    assert thread_count(None, 40_000, 3) == 3 and thread_count(None, 39_999, 3) == 1
    brief = {"time__duration": 2e-4, "record": {"stress": [2.0], "energy": False}}
    assert plan(row(**brief)).threads == 1
    assert plan(row(**brief, numerics__dem__threads=4)).threads == 4
