"""Criteria that can fail: runs made wrong are not taken for sound ones."""

import numpy as np
import pytest

from compare.engines import solve
from compare.experiments.robustness.case import (
    ALLOW,
    FOURTH,
    JOINTED,
    LEAPFROG,
    STEP,
    CaseTrial,
    Criterion,
    HardCase,
    Judgement,
)
from compare.experiments.robustness.criteria import accuracy, energies, steps
from compare.experiments.robustness.linear_cases import BLOW, JOINT, TINY
from compare.experiments.robustness.rock_mass_cases import ROCK_MASSES
from compare.experiments.robustness.run import FAILED, HELD, NONE, row_of

#: Changes of runs, not of what they are held to.
STIFF = {"joint_sets.1.normal_stiffness": 2e14, "joint_sets.1.shear_stiffness": 8e13}
SLIPPERY = {f"joint_sets.{k}.friction_angle": 15.001 for k in (0, 1)}


def judged(judge, changes, stepper=LEAPFROG, **about):
    """Return the row of a case of one's own."""
    return row_of(HardCase("a case", judge, changes, **about), stepper)


def test_unstable_step_breaks_the_bound_of_the_stable_one(monkeypatch):
    """At 1.001 with the guard off, motion leaves what the impulse allows."""
    monkeypatch.setattr(steps, "STEPS", 1000)
    changes = {STEP: 1.001, ALLOW: True} | BLOW
    assert judged(steps.impulse_bound, changes).state == FAILED
    assert judged(steps.impulse_bound, changes | {STEP: 0.999}).state == HELD


def test_step_that_is_never_stopped_is_not_caught():
    """A stable step that is asked for as an unstable one runs to its end: the criterion says so."""

    class Sound(CaseTrial):
        def run(self, **more):
            return super().run(**more | {STEP: 0.9})

    case = HardCase("a case", steps.caught, {STEP: 1.001} | BLOW)
    assert not np.isfinite(steps.caught.judge(Sound(case, LEAPFROG)).value)


def test_wrong_stiffness_breaks_the_accuracy():
    """Joints one part in a hundred too stiff are further off than the phase error."""

    class Stiffer(CaseTrial):
        def run(self, **more):
            layers = [{"y": 0.5 * j, "normal_stiffness": 1.05 * JOINT} for j in range(1, 20)]
            return super().run(soft_layers=layers, **more)

    case = HardCase("a case", accuracy.near_exact)
    sound, wrong = (
        accuracy.near_exact.judge(kind(case, LEAPFROG)) for kind in (CaseTrial, Stiffer)
    )
    assert sound.value < sound.bound and wrong.value > wrong.bound


def test_energy_that_leaks_has_a_trend():
    """Dashpots of a ratio of 1e-12 lose more in a hundred thousand steps than round-off does."""
    leaky = TINY | {"joints.damping_ratio": 1e-12}
    assert judged(energies.no_trend(100_000), leaky).state == FAILED
    assert judged(energies.no_trend(100_000), TINY | {"joints.damping_ratio": 0.0}).state == HELD


def test_dissipated_energy_that_comes_back_is_seen(pillar):
    """A viscous term that falls by a millionth of the work breaks the second law."""
    result = solve("dem", pillar(joints__damping_ratio=0.1))
    assert energies.largest_fall(result) < 1e-12
    work = float(np.abs(result.energy.sel(term="work")).max())
    viscous = result.energy.values[list(result.term.values).index("viscous")]
    viscous[-1] = viscous[:-1].max() - 1e-6 * work
    assert energies.largest_fall(result) == pytest.approx(1e-6, rel=0.1)


def test_bound_that_bounds_nothing_fails():
    """A bound of infinity or nan, and a value of nan, hold nothing."""
    for finding in (Judgement(1.0, np.inf), Judgement(1.0, np.nan), Judgement(np.nan, 1.0)):
        assert judged(Criterion("", lambda trial, found=finding: found), {}).state == FAILED


def test_spared_and_impossible_rows_give_their_reason():
    """Spared cases and cases beyond a scheme are rows without a number."""
    spared = judged(accuracy.near_exact, {}, spared={"dem": "because"})
    assert (spared.state, spared.message) == (NONE, "because") and np.isnan(spared.value)
    damped = judged(accuracy.near_exact, {"joints.damping_ratio": 0.1}, FOURTH)
    assert damped.state == NONE and "dashpots" in damped.message


def test_error_of_a_run_is_a_failed_row():
    """A scene that cannot be run fails its row with the message of the run."""
    found = judged(accuracy.near_exact, {"rock.density": -1.0})
    assert found.state == FAILED and "rock.density" in found.message


@pytest.mark.parametrize(
    "name, stepper, wrong",
    [
        (
            "a block held by one corner",
            LEAPFROG,
            {"joint_sets.0.normal_stiffness": 2e10 * (1 + 1e-6)},
        ),
        ("T-junctions of brickwork under shear", LEAPFROG, {"joint_sets.1.offset": 0.5 + 1e-9}),
        ("one set 1e8 as stiff as the other, rigid blocks", LEAPFROG, STIFF),
        ("a wave at 88 degrees, rigid blocks", LEAPFROG, {"joint_sets.1.normal_stiffness": 1.9e10}),
        ("a wave at 88 degrees on a joint", JOINTED, {"joint_sets.0.shear_stiffness": 5e9}),
        ("T-junctions of brickwork that slide", LEAPFROG, SLIPPERY),
        ("T-junctions of brickwork that slide", JOINTED, SLIPPERY),
        ("T-junctions of brickwork that slide", LEAPFROG, {"waves.0.amplitude": 1e5}),
    ],
)
def test_rock_mass_that_is_another_fails_its_row(name, stepper, wrong):
    """A run of joints a little off is not within the bound of what the case asks for; nor is one
    whose joints do not slide said to be within friction."""

    class Other(CaseTrial):
        def run(self, **more):
            changes = {key: value for key, value in wrong.items() if key.split(".")[0] not in more}
            return super().run(**more, **changes)

    case = next(one for one in ROCK_MASSES if one.name == name)
    found = case.criterion.judge(Other(case, stepper))
    assert found.value > 1.5 * found.bound


def test_energy_from_nowhere_breaks_the_ledger():
    """A hundred thousand millionth of the work more is beyond round-off."""
    case = next(
        one for one in ROCK_MASSES if one.name == "the ledger of a block held by one corner"
    )
    trial = CaseTrial(case, LEAPFROG)
    energy = trial.result["energy"]
    energy.values[0, -1] += 1e-11 * float(np.abs(energy.sel(term="work")).max())
    found = case.criterion.judge(trial)
    assert found.value > found.bound
