"""Effects that are idle change no bit; effects that are absent leave no array."""

import numpy as np
import pytest

from cases.calibrate import calibrate
from cases.errors import SceneError
from continuum import applies, simulate
from continuum.build import build
from continuum.explicit import run
from continuum.model import Quiet, room, state_at_rest


def waves(scene, model, change=lambda built: built):
    """Return stress, velocity and displacement of a run whose model was changed."""
    built, _, time, _ = build(scene, model)
    built = change(built)
    state = state_at_rest(built, scene.record.energy)
    samples = room(built, state, time.samples)
    run(built, state, samples, time.stride, 0, time.steps + 1)
    return np.concatenate([samples.stress, samples.velocity, samples.displacement])


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
def test_dashpots_of_ratio_zero_change_nothing(pillar, model):
    step = {"numerics__continuum__step_fraction": 0.2, "time__duration": 0.06}
    idle = simulate(pillar(joints__damping_ratio=0.0, **step), model)
    assert idle["stress"].equals(simulate(pillar(**step), model)["stress"])
    assert idle["velocity"].equals(simulate(pillar(**step), model)["velocity"])


def test_joints_that_all_carry_tension_one_by_one_change_nothing(pillar):
    scene = pillar(time__duration=0.06)

    def change(built):
        every = np.ones(built.interfaces.area.size, dtype=bool)
        law = built.interfaces.law._replace(carries_tension=every)
        return built._replace(interfaces=built.interfaces._replace(law=law))

    assert np.array_equal(waves(scene, "jointed"), waves(scene, "jointed", change))


def test_barred_tension_changes_nothing_while_all_is_compressed(pillar):
    """A step that has not reached the far end pulls no joint. Linear elements, for higher ones
    send ripples of 1e-11 of it ahead of the front."""
    step = {"load": {"shape": "step", "amplitude": 1e6}, "numerics__continuum__order": 1}
    places = np.arange(0.5, 50.0, 0.5).tolist()
    changes = {"joints__damping_ratio": 0.05, "time__duration": 0.03, "record__stress": places}
    free = simulate(pillar(**step, **changes))
    assert float(free["stress"].min()) >= 0.0
    barred = simulate(pillar(joints__tension=False, **step, **changes))
    assert barred["stress"].equals(free["stress"])
    assert barred["velocity"].equals(free["velocity"])


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
def test_quiet_end_without_impedance_changes_nothing(pillar, model):
    scene = pillar(time__duration=0.06)

    def change(built):
        quiet = Quiet(np.array([0, built.rock.mass.size - 1]), np.zeros(2), np.zeros(2))
        return built._replace(ends=built.ends._replace(quiet=quiet))

    assert np.array_equal(waves(scene, model), waves(scene, model, change))


def test_ledger_changes_nothing(pillar):
    scene = pillar(joints__damping_ratio=0.02, time__duration=0.06)
    silent = pillar(joints__damping_ratio=0.02, time__duration=0.06, record__energy=False)
    assert np.array_equal(waves(scene, "jointed"), waves(silent, "jointed"))


def test_absent_effects_leave_no_array(pillar):
    built, state, _, _ = build(pillar(record__energy=False), "equivalent")
    assert built.interfaces is None and built.ends.quiet is None and built.ends.fixed is None
    assert built.rock.time_constant is None
    rest = (state.rate, state.drag, state.traction, state.dashpot, state.ledger)
    assert rest == (None,) * 5


def test_absent_effects_leave_no_instruction(pillar, instructions):
    """Without no-tension nothing is compared, without a quiet end nothing is divided."""

    def count(kind, model="jointed", **changes):
        built, state, _, _ = build(pillar(record__energy=False, **changes), model)
        samples = room(built, state, 1)
        return instructions(run, (built, state, samples, 1, 0, 0), kind)

    assert count("fcmp") == 0 < count("fcmp", joints__tension=False)
    assert count("fdiv") < count("fdiv", ends__end="quiet")
    assert count("fmul", "equivalent") < count("fmul") < count("fmul", joints__damping_ratio=0.02)


def test_alike_undamped_joints_are_one_number(pillar):
    built, state, _, _ = build(pillar(), "jointed")
    law = built.interfaces.law
    assert isinstance(law.normal_stiffness, float)
    assert law.normal_viscosity is None and law.carries_tension is None
    assert state.rate is None and state.dashpot is None and state.drag is None


def test_homogenised_bar_is_whole_but_for_soft_layers(pillar):
    layer = [{"y": 20.0, "spacing_stiffness": 4.375e8}, {"y": 30.0}]
    scene = pillar(soft_layers=layer)
    p = calibrate(scene)
    built, _, _, _ = build(scene, "equivalent")
    assert built.interfaces.area.size == 1
    excess = 1 / p.stiffness[39] - 1 / p.regular_stiffness
    assert built.interfaces.law.normal_stiffness == pytest.approx(1 / excess, rel=1e-12)


@pytest.mark.parametrize(
    ("changes", "model", "reason"),
    [
        ({"rock__intact_modulus": None}, "jointed", "needs rock.intact_modulus"),
        ({"joints__tension": False}, "equivalent", "no joints to open"),
        ({"soft_layers": [{"y": 20.0, "spacing_stiffness": 9e9}]}, "equivalent", "stiffer"),
        ({"soft_layers": [{"y": 20.0, "damping_ratio": 0.1}]}, "equivalent", "one ordinary joint"),
    ],
)
def test_model_that_does_not_apply_says_why(pillar, changes, model, reason):
    scene = pillar(**changes)
    assert reason in applies(scene, model)
    with pytest.raises(SceneError, match=reason):
        simulate(scene, model)


def test_soft_layer_without_tension_opens_in_the_homogenised_bar(pillar):
    layer = [{"y": 20.0, "spacing_stiffness": 4.375e8, "tension": False}]
    scene = pillar(soft_layers=layer)
    assert applies(scene, "equivalent") == ""
    stress = simulate(scene, "equivalent")["stress"]
    assert float(stress.min()) > -1e-10 * float(stress.max())


@pytest.mark.parametrize(("key", "value"), [("dim", 2), ("dim", 3), ("model", "discrete")])
def test_what_is_not_built_is_refused(pillar, key, value):
    with pytest.raises(SceneError, match=key):
        simulate(pillar(), **{key: value})
