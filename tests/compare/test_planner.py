"""Plans: what is predicted is obtained, the cheapest that does is taken, and nothing is hidden."""

import pytest

import cases
from cases.errors import SceneError
from cases.read import parse_override
from compare import planner
from compare.effort import PILLAR
from compare.engines import solve
from compare.metrics import misfit
from compare.planner import Choice, Family, options_of, plain, plan

SHORT = {"pillar__length": 10.0, "time__duration": 0.03, "record__stress": [4.0]}
RICKER = {"shape": "ricker", "amplitude": 1e6, "period": 0.01}


@pytest.mark.parametrize("target", [0.05, 0.01, 1e-3])
@pytest.mark.parametrize("changes", [{}, {"joints__damping_ratio": 0.02, "ends__end": "quiet"}])
def test_what_is_predicted_is_obtained(target, changes, pillar):
    """Within a tenth: Richardson leaves the next term of the error, and two steps that are rounded
    to divide the sampling interval."""
    found = plan(pillar(load=RICKER, **SHORT, **changes), target)
    assert found.reference == "jointed-bar"
    assert found.misfit <= target
    assert found.misfit == pytest.approx(found.chosen.misfit, rel=0.1)


def test_coarse_demands_are_met_by_rigid_blocks_and_fine_ones_by_rock(pillar):
    """Rigid blocks end at their modelling error."""
    scene = pillar(load=RICKER, **SHORT)
    coarse, fine = plan(scene, 0.05), plan(scene, 1e-4)
    assert coarse.chosen.family.name == "dem"
    assert fine.chosen.family.name == "continuum-jointed"


def test_options_make_the_configuration(pillar):
    """What is printed gives the misfit that is printed."""
    scene = pillar(load=RICKER, **SHORT)
    found = plan(scene, 0.01)
    overrides = {key.replace("__", "."): value for key, value in SHORT.items()}
    overrides |= {"load": RICKER, "record.interval": scene.interval, "record.energy": False}
    overrides |= dict(parse_override(text) for text in options_of(found.chosen))
    again = cases.load_variant(PILLAR, "", overrides)
    exact = solve(found.reference, plain(scene))
    assert misfit(solve(found.chosen.family.name, again), exact) == found.misfit


def test_what_no_family_is_about_stays_the_scenes_own(pillar):
    """The dimension, and points of a face."""
    scene = pillar(**SHORT, numerics__continuum__dim=2, joints__contact_points=3)
    (rock,) = [
        f
        for f in planner.FAMILIES
        if f.changes == {"scheme": "explicit", "order": 3, "elements_per_block": 1}
    ]
    made = planner.configured(scene, rock, {"step_fraction": 0.5})
    assert made.numerics.continuum.dim == 2 and made.joints.contact_points == 3
    assert (made.numerics.continuum.order, made.numerics.continuum.step_fraction) == (3, 0.5)


def test_what_nothing_reaches_is_said(pillar):
    found = plan(pillar(load=RICKER, **SHORT), 1e-12)
    assert found.chosen is None and found.trials > 0


def test_families_that_cannot_run_say_why(pillar):
    """Dashpots bar the fourth order; without its modulus there is no intact rock."""
    damped = pillar(load=RICKER, **SHORT, joints__damping_ratio=0.02)
    found = plan(damped, 0.05)
    assert next(reason for label, reason in found.skipped.items() if "fourth" in label)
    assert found.trials == 2 * (len(planner.FAMILIES) - len(found.skipped))


def test_a_scene_that_nothing_knows_is_refused(pillar):
    with pytest.raises(SceneError, match="no exact solution to plan by"):
        plan(pillar(**SHORT, damping={"local": 0.5}), 0.01)


def choice(misfit, seconds):
    return Choice(Family("dem", "dem", {}, 2), {}, misfit, seconds)


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
    choices = [choice(0.05, 1.0), choice(0.02, 2.0), choice(0.01, 4.0), choice(0.2, 0.5)]
    found = planner._cheapest(choices, target, seconds)
    assert expected == (None if found is None else (found.misfit, found.seconds))
