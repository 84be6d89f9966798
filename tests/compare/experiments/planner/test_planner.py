"""Plans: predictions are obtained, the cheapest sufficient choice is taken, failures are shown."""

import re
from functools import cache
from itertools import chain

import numpy as np
import pytest

import cases
from cases.errors import SceneError
from cases.read import parse_override
from compare.engines import solve
from compare.experiments.cost.scenes import PILLAR
from compare.experiments.planner import families, planner
from compare.experiments.planner import reference as plan_reference
from compare.experiments.planner import trials as plan_trials
from compare.experiments.planner.families import Family, plain
from compare.experiments.planner.planner import options_of, plan
from compare.experiments.planner.trials import Choice, Trial
from compare.misfit.metrics import Stack, misfit, stacked, worst
from compare.scenes import find

SHORT = {"pillar__length": 10.0, "time__duration": 0.03, "record__stress": [4.0]}
RICKER = {"shape": "ricker", "amplitude": 1e6, "period": 0.01}


DAMPED = {"joints.damping_ratio": 0.02, "ends.end": "quiet"}


@pytest.fixture(scope="module")
def planned(scene_with):
    """Return a function that gives the plan of a short pillar within a misfit, made once."""
    short = {key.replace("__", "."): value for key, value in SHORT.items()} | {"load": RICKER}

    @cache
    def found(target, damped):
        return plan(scene_with(**short, **(DAMPED if damped else {})), target)

    return found


@pytest.fixture
def few(monkeypatch):
    """Return a function that leaves the planner some of its families."""

    def leave(first, end):
        some = lambda scene: families.families_of(scene)[first:end]  # noqa: E731
        monkeypatch.setattr(planner, "families_of", some)

    return leave


@pytest.mark.parametrize("target", [0.05, 0.01, 1e-3])
@pytest.mark.parametrize("damped", [False, True])
def test_what_is_predicted_is_obtained(target, damped, planned):
    """Within a tenth: Richardson leaves the next term of the error, and two steps that are rounded
    to divide the sampling interval."""
    found = planned(target, damped)
    assert found.reference.name == "jointed-bar" and found.reference.is_exact
    assert found.misfit <= target
    assert found.obtained.numerical == pytest.approx(found.chosen.numerical, rel=0.1)
    assert found.misfit == found.obtained.numerical + found.obtained.modelling


def test_coarse_demands_are_met_by_rigid_blocks_and_fine_ones_by_rock(planned):
    """Rigid blocks end at their modelling error, 0.2 %. Both cost milliseconds at 5 %, as measured:
    what else the machine does may disturb one plan, not three."""
    again = (planned.__wrapped__(0.05, False) for _ in range(2))
    plans = chain([planned(0.05, False)], again)
    assert any(one.chosen.family.name == "dem" for one in plans)
    assert planned(1e-3, False).chosen.family.name == "continuum-jointed"


def test_options_make_the_configuration(planned):
    """The printed options reproduce the printed misfit."""
    found = planned(0.01, False)
    scene = found.scene
    overrides = {key.replace("__", "."): value for key, value in SHORT.items()}
    overrides |= {"load": RICKER, "record.interval": scene.interval, "record.energy": False}
    overrides |= dict(parse_override(text) for text in options_of(found.chosen))
    again = cases.load_variant(PILLAR, "", overrides)
    own, finest = (solve(x.name, plain(scene)) for x in (found.own, found.reference))
    result = solve(found.chosen.family.name, again)
    assert misfit(result, own) + found.own.error == found.obtained.numerical
    apart = 0 if own.equals(finest) else misfit(own, finest) + found.reference.error
    assert found.obtained.modelling == apart


def test_what_no_family_is_about_stays_the_scenes_own(pillar):
    """The dimension, and points of a face."""
    scene = pillar(**SHORT, numerics__continuum__dim=2, joints__contact_points=3)
    (rock,) = [
        f
        for f in families.families_of(scene)
        if f.name == "continuum-jointed"
        and f.changes == {"scheme": "explicit", "order": 3, "elements_per_block": 1}
    ]
    made = families.configured(scene, rock, {"step_fraction": 0.5})
    assert made.numerics.continuum.dim == 2 and made.joints.contact_points == 3
    assert (made.numerics.continuum.order, made.numerics.continuum.step_fraction) == (3, 0.5)


def test_what_nothing_reaches_is_said(pillar, few):
    few(0, 2)
    found = plan(pillar(load=RICKER, **SHORT), 1e-5)
    assert found.chosen is None and found.misfit == np.inf
    assert all("modelling error of dem is already" in reason for reason in found.skipped.values())


def test_families_that_cannot_run_say_why(planned):
    """Dashpots bar the fourth order."""
    skipped = planned(0.05, True).skipped
    assert next(reason for label, reason in skipped.items() if "fourth" in label)


def test_few_families_are_run_where_a_coarse_one_does(pillar, monkeypatch):
    """Nothing that would cost more than what meets the misfit already is run, and it is said. Here
    a freedom-step of any engine costs the same, whatever else the machine does."""

    def counted(name, scene):
        result = solve(name, scene)
        return result, 1e-8 * result.attrs["steps"] * result.attrs["degrees_of_freedom"]

    for module in (planner, plan_trials):
        monkeypatch.setattr(module, "timed", counted)
    found = plan(pillar(load=RICKER, **SHORT), 0.05)
    assert found.chosen.measured and found.trials <= 8
    assert planner.DEAR in found.skipped.values()
    assert found.planning > 0


LOCAL = {"damping": {"local": 0.5}}


def test_a_scene_without_exact_solution_is_held_against_a_converged_run(pillar):
    """The run's own error is what it says: one of far finer steps is no further."""
    scene = pillar(load=RICKER, **SHORT, **LOCAL)
    found = plan(scene, 0.01)
    assert found.reference.name == "dem" and not found.reference.is_exact
    assert 0 < found.reference.error < 0.1 * 0.01
    (dem, *_) = families.families_of(scene)
    finer = families.configured(scene, dem, {"step_fraction": 3e-4})
    assert misfit(found.reference.result, solve("dem", finer)) <= found.reference.error
    assert found.misfit <= 0.01 and found.obtained.modelling == 0


def test_a_scene_whose_runs_do_not_converge_in_reach_is_refused(pillar, monkeypatch):
    monkeypatch.setattr(plan_reference, "LEVELS", 2)
    with pytest.raises(SceneError, match=r"no exact solution to plan by, and dem .* converges to"):
        plan(pillar(load=RICKER, **SHORT, **LOCAL), 1e-9)


def barred(found, name):
    """Return the modelling error (%) that the families of an engine were not tried for."""
    said = f"the modelling error of {name} is already (.*) %"
    reasons = (re.fullmatch(said, reason) for reason in found.skipped.values())
    return next(float(found[1]) for found in reasons if found)


def test_rigid_blocks_never_meet_a_misfit_below_their_modelling_error(pillar):
    """A step whose error cancels part of the modelling error is 0.1 % from jointed rock, as the
    blocks' exact chain is not: the step is no answer to 0.15 %."""
    scene = pillar(load=RICKER, **SHORT, record__interval=5e-4)
    (blocks, *_) = families.families_of(scene)
    finest, chain = (solve(name, plain(scene)) for name in ("jointed-bar", "lattice"))
    coarse = [families.configured(scene, blocks, {"step_fraction": f}) for f in (0.9, 0.4)]
    lucky = min(misfit(solve("dem", one), finest) for one in coarse)
    assert lucky < 0.0015 < misfit(chain, finest)
    found = plan(scene, 0.0015)
    assert found.chosen.family.name == "continuum-jointed" and found.misfit <= 0.0015
    assert barred(found, "dem") == pytest.approx(0.205, rel=0.1)


def test_joints_that_open_are_not_planned_by_what_lacks_deformable_rock(few):
    """No exact solution has both: the reference is a run of jointed rock that has converged."""
    few(0, 3)
    changes = {key.replace("__", "."): value for key, value in SHORT.items()}
    found = plan(cases.load_variant(find("guo-li-2002/fig-09"), "no tension", changes), 0.002)
    assert found.reference.name == "continuum-jointed" and not found.reference.is_exact
    assert found.chosen.family.name == "continuum-jointed" and found.misfit <= 0.002
    assert barred(found, "dem") == pytest.approx(0.31, rel=0.1)


def test_joints_that_slip_are_not_planned_by_homogenised_rock(few):
    few(3, 4)
    found = plan(cases.load_variant(find("beyond/slip-three-cohesions"), "", SLIPPING), 0.02)
    assert found.reference.name == "continuum-jointed" and found.chosen is None
    assert barred(found, "continuum-equivalent") == pytest.approx(5.6, rel=0.1)


#: One joint under an upright wave, in a square that is small beside it.
ROCK_MASS = {
    "domain.size": [6.0, 6.0],
    "joint_sets.0.dip": 0.0,
    "joint_sets.0.through": [3.0, 3.0],
    "record.points": [[2.9, 1.4], [2.9, 4.4]],
    "record.joints": [[3.0, 3.0]],
    "time.duration": 0.012,
}


def test_a_rock_mass_is_planned_by_sizes_of_blocks_and_elements(few):
    """Held against the exact field of its joint; blocks of half the size are nearer to it, and what
    is predicted is obtained by the options that are printed."""
    few(0, 6)
    scene = cases.load_variant(find("rock-mass/one-joint"), "", ROCK_MASS)
    found = plan(scene, 0.008)
    assert found.reference.name == "oblique-joint" and found.misfit <= 0.008
    assert found.chosen.family.name == "continuum-jointed"
    assert found.obtained.numerical == pytest.approx(found.chosen.numerical, rel=0.1)
    sizes = [family.changes["block"] for family in families.families_of(scene)[:2]]
    coarse, fine = (barred(found, rf"dem \(block {size:g}\)") for size in sizes)
    assert sizes[0] > 1.9 * sizes[1] and coarse > 4 * fine > 4
    overrides = dict(parse_override(text) for text in options_of(found.chosen))
    overrides |= {"record.interval": scene.interval, "record.energy": False}
    again = cases.load_variant(find("rock-mass/one-joint"), "", ROCK_MASS | overrides)
    exact = found.reference.result
    assert misfit(solve("continuum-jointed", again), exact) == pytest.approx(
        found.obtained.numerical - found.own.error
    )


def test_sizes_of_a_rock_mass_are_parts_of_its_slowest_wave():
    """2774 m/s times 5 ms; the scene's own blocks are among them, and finer ones cost more."""
    found = families.families_of(cases.load_variant(find("rock-mass/one-joint"), ""))
    rigid = [family for family in found if family.name == "dem"]
    sizes = [family.changes["block"] for family in rigid]
    assert sizes == sorted(sizes)[::-1] and sizes[0] == pytest.approx(13.87 / 6, rel=2e-3)
    assert 0.8 in sizes and families.is_finer(rigid[-1], rigid[0])
    rock = families.rock(
        cases.load_variant(find("rock-mass/one-joint"), ""), "continuum-jointed", 2
    )
    assert rock.changes["size"] == pytest.approx(13.87 / 6, rel=2e-3)


def test_blocks_between_spaced_joints_have_a_model_of_their_own():
    """With its own blocks it is exact in time as a lattice; cut into smaller blocks it is not."""
    changes = {"domain.size": [8.0, 4.0], "record.points": [[2.5, 1.5]], "record.joints": []}
    changes |= {"joint_sets.1.ends_at": [], "joint_sets.1.offset": 0.0}
    scene = cases.load_variant(find("rock-mass/brickwork"), "", changes)
    references = plan_reference.References.__new__(plan_reference.References)
    references.scene, references.asked, references._own = scene, 0.1, {}
    lattice = solve("block-lattice", plain(scene))
    references.finest = plan_reference.ErrorReference("continuum-jointed", lattice, 0.0, "a run")
    own = references.own(Family("dem", {}))
    assert own.reference.name == "block-lattice" and own.modelling == 0
    cut = references.own(Family("dem", {"block": 0.5}))
    assert cut.reference.name == "dem" and cut.modelling > 0.01


def test_a_reference_of_small_blocks_has_elements_of_half_the_size_each(monkeypatch):
    """Bricks of 2 m by 1 m have the same elements at the first sizes, parts of a wave of 16 m: such
    runs would agree, and say nothing of their error."""
    found = []

    def noted(name, scene):
        found.append(solve(name, scene))
        return found[-1]

    monkeypatch.setattr(plan_reference, "solve", noted)
    changes = {"domain.size": [8.0, 4.0], "record.points": [[2.5, 1.5]], "record.joints": []}
    scene = cases.load_variant(find("rock-mass/brickwork"), "", changes | {"time.duration": 0.02})
    model = Family("continuum-jointed", {})
    reference = plan_reference._converged(scene, model, 20.0, None)
    first, second = (one.attrs["degrees_of_freedom"] for one in found)
    assert second > 2.5 * first and 0 < reference.error < 2
    sizes = [rock.changes["size"] for rock in plan_reference._refined(scene, model)]
    assert f"size {sizes[1]}" not in reference.settings and len(found) == 2


SLIPPING = {
    "pillar.length": 10.0,
    "pillar.block": 0.5,
    "rock.intact_modulus": 8.64e10,
    "time.duration": 0.06,
    "record.stress": [2.0, 8.0],
    "soft_layers": [{"y": 5.0, "cohesion": 5e4, "spacing_stiffness": 1e9}],
}


def test_a_finer_step_that_is_worse_takes_the_credit_of_a_coarser_one():
    """7.1, 2.1, 0.96, 1.7, 1.9 %: only what no finer step undoes is met."""
    errors = (0.071, 0.021, 0.0096, 0.017, 0.019)
    family = Family("dem", {}, 2)
    along = [Choice(family, {}, 2**k, e, 0.0, 2.0**k, True) for k, e in enumerate(errors)]
    assert plan_trials.cheapest(along, 0.01, None) is None
    assert plan_trials.cheapest(along, 0.02, None).misfit == 0.0096
    assert plan_trials.cheapest(along[:3], 0.01, None).misfit == 0.0096


def test_errors_add_up_and_a_margin_is_kept_of_the_numerical_one():
    told = choice(0.005, 1.0)._replace(modelling=0.0049)
    assert told.misfit == pytest.approx(0.0099)
    assert plan_trials.cheapest([told], 0.01, None) == told
    assert plan_trials.cheapest([told._replace(measured=False)], 0.01, None) is None
    assert plan_trials.cheapest([told._replace(modelling=0.0051)], 0.01, None) is None


def test_a_reference_that_does_not_know_itself_well_enough_judges_nothing(pillar, monkeypatch):
    """A tenth of the misfit at most; what it does know is added to the numerical error."""
    scene = pillar(load=RICKER, **SHORT)
    exact = solve("jointed-bar", plain(scene))
    rms = float(np.sqrt((exact.stress**2).mean()))
    bounded = exact.assign(stress_error=("stress_y", [2e-4 * rms]))
    monkeypatch.setattr(plan_reference, "solve", lambda name, asked: bounded)
    with pytest.raises(SceneError, match=r"jointed-bar knows itself to 0.02 %, not to 0.01 %"):
        plan_reference.References(scene, 1e-3)
    own = plan_reference.References(scene, 1e-2).own(Family("continuum-jointed", {}))
    assert own.modelling == 0 and own.least == pytest.approx(2e-4, rel=1e-3)


def trials(order, steps=(1, 2, 4), floor=0.0, first=0.1):
    """Runs whose error falls from `first` by some order, to what their elements leave; in a second
    waveform, a million times as large, from half of that."""
    time = np.linspace(0, 1, 101)
    goal, error, model = np.sin(20 * time), np.cos(20 * time), np.sin(40 * time)
    size, share, goals = np.array([[1.0], [1e6]]), np.array([[1.0], [0.5]]), np.array([goal, goal])
    waves = [size * (goals + share * (first * error * n**-order + floor * model)) for n in steps]
    norm = np.sqrt(((size * goals) ** 2).mean(axis=1))
    stacks = [Stack(w, size * goals, norm, np.zeros(2)) for w in waves]
    return [Trial(n, s, 1e-3 * (2 + n), 1.0) for n, s in zip(steps, stacks, strict=True)]


@pytest.mark.parametrize("order", [0.5, 1.0, 1.4, 2.0])
def test_the_order_is_measured_from_three_runs(order):
    """At kinks it is below the scheme's, and what finer steps give follows the measured one."""
    three = trials(order, floor=0.01)
    assert plan_trials.rate(three, 2) == pytest.approx(order)
    (far,) = trials(order, (64,), floor=0.01)
    assert plan_trials.forecast(three, 2)(64) == pytest.approx(far.waves.one, rel=1e-9, abs=1e-12)


def test_each_waveform_is_extrapolated_by_itself():
    """The numerical error is that of the worst one, regardless of the size of the others."""
    (one,) = trials(1.0, (8,))
    assert one.misfits[1] == pytest.approx(one.misfits[0] / 2)
    assert one.misfit == one.misfits[0]


def test_a_stack_has_the_misfit_of_its_two_results(pillar):
    scene = pillar(load=RICKER, **SHORT, record__velocity=[3.0, 10.0])
    blocks, rock = (solve(name, scene) for name in ("lattice", "jointed-bar"))
    found = stacked(blocks, rock).misfits
    assert found.max() == pytest.approx(worst(blocks, rock).misfit, rel=1e-12)


def test_the_order_stays_within_reason():
    assert (plan_trials.rate(trials(3.0), 2) == 2).all()
    assert (plan_trials.rate(trials(0.1), 2) == plan_trials.SLOWEST).all()
    assert (plan_trials.rate(trials(1.0)[:2], 2) == 2).all()


def test_a_forecast_is_trusted_once_it_has_come_true():
    """Two runs tell a third where the order is the scheme's; below it they do not yet."""
    assert not plan_trials.is_trusted(trials(2.0)[:2], 2, 1e-3)
    assert plan_trials.is_trusted(trials(2.0), 2, 1e-3)
    assert not plan_trials.is_trusted(trials(1.0), 2, 1e-3)
    assert plan_trials.is_trusted(trials(1.0, (1, 2, 4, 8)), 2, 1e-3)


def test_a_family_whose_model_is_too_far_is_given_up_after_two_runs():
    assert plan_trials.is_hopeless(trials(2.0, first=0.01, floor=0.2)[:2], 0.01)
    assert not plan_trials.is_hopeless(trials(0.5)[:2], 1e-6)


def test_seconds_are_a_start_and_so_much_a_step():
    coarse, fine, _ = trials(2.0)
    assert plan_trials.seconds_of(coarse, fine) == pytest.approx((2e-3, 1e-3))


def test_steps_are_so_many_to_a_doubling():
    assert plan_trials.steps(1, 8, 2) == [1, 2, 3, 4, 6, 8]
    assert plan_trials.steps(5, 10, 1) == [5, 10]


def test_finer_families_cost_more():
    coarse, fine = (
        Family("continuum-jointed", {"scheme": "explicit", **elements}, 2)
        for elements in (
            {"order": 1, "elements_per_block": 1},
            {"order": 2, "elements_per_block": 1},
        )
    )
    assert families.is_finer(fine, coarse)
    assert not families.is_finer(coarse, fine)
    assert not families.is_finer(fine, fine)
    assert not families.is_finer(fine._replace(name="continuum-equivalent"), coarse)


def choice(numerical, seconds):
    """Return one of the steps of a family of its own, its model the finest physics."""
    family = Family("dem", {"scheme": f"{numerical} {seconds}"}, 2)
    return Choice(family, {}, 1, numerical, 0.0, seconds, True)


@pytest.mark.parametrize(
    ("target", "seconds", "expected"),
    [
        (0.1, None, (0.05, 1.0)),
        (0.01, None, (0.01, 4.0)),
        (0.001, None, None),
        (0.01, 2.0, (0.02, 2.0)),
        (0.1, 2.0, (0.05, 1.0)),
        (0.1, 0.1, None),
    ],
)
def test_the_cheapest_that_meets_it_or_the_best_in_time(target, seconds, expected):
    given = [choice(0.05, 1.0), choice(0.02, 2.0), choice(0.01, 4.0), choice(0.2, 0.5)]
    found = plan_trials.cheapest(given, target, seconds)
    assert expected == (None if found is None else (found.misfit, found.seconds))


def test_what_is_predicted_keeps_a_margin():
    """Two steps leave the next term of the error: what is measured may be as much as is asked."""
    told = choice(0.01, 1.0)._replace(measured=False)
    assert plan_trials.cheapest([told], 0.01, None) is None
    assert plan_trials.cheapest([choice(0.01, 1.0)], 0.01, None) is not None
    assert plan_trials.cheapest([told], 0.01 / plan_trials.MARGIN, None) == told
