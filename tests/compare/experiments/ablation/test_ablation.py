"""Cost and influence of effects: leaving one out leaves exactly that one out."""

import numpy as np
import pytest
import xarray as xr

import dem
from cases.effects import active_effects
from cases.errors import SceneError
from cases.schema.joint import PARTS
from compare.experiments.ablation import ablation
from compare.experiments.ablation.ablation import ablate, prepare
from compare.experiments.ablation.variants import NEEDS, WITHOUT, left_out, only
from compare.misfit.metrics import relative_l2
from compare.studies.step_cost import StepCost

LAYER = [{"y": 20.0, "spacing_stiffness": 4e8, "damping_ratio": 0.05, "tension": False}]
ACROSS = {"load__direction": [0.6, 0.8, 0.0]}
FALL = {"direction": [0, 1, 0], "static": False}


def law(part):
    """Return the keys of a part of the joint law, of a pillar struck across where it is of slip."""
    slides = ACROSS | {"joints__friction_angle": 30.0} if part.along else {}
    return slides | {f"joints__{key}": value for key, value in part.sample.items()}


CALLS = {part.name: law(part) for part in PARTS} | {
    "dashpots": {"joints__damping_ratio": 0.02, "soft_layers": LAYER},
    "no tension": {"joints__tension": False, "soft_layers": LAYER},
    "segments": {"segments": [{"y": [10.0, 20.0], "density": 2600.0}]},
    "scatter": {"scatter": {"spacing": 0.2, "seed": 1}},
    "joints that differ": {"soft_layers": LAYER},
    "quiet ends": {"ends__end": "quiet"},
    "matched ends": {"ends__start": "matched"},
    "fixed ends": {"ends__end": "fixed"},
    "energy ledger": {},
    "field output": {"record__fields": 0.01},
    "finite rotation": {**ACROSS, "motion__rotation": "finite"},
    "slip": {**ACROSS, "joints__friction_angle": 30.0, "joints__cohesion": 1e4},
    "mass damping": {"damping__mass_proportional": 5.0},
    "local damping": {"damping": {"local": 0.5}},
    "constant Q": {"rock__quality_factor": 20.0},
    "gravity": {"gravity": FALL},
    "prestress": {"prestress": {"normal": 1e5}},
}


def test_every_effect_that_can_be_left_out_is_tried():
    """Those of sides exist only for rock masses."""
    assert set(CALLS) == {name for name in WITHOUT if not name.endswith(" sides")}


@pytest.mark.parametrize("effect", CALLS)
def test_leaving_one_out_leaves_the_others(effect, pillar):
    """But dashpots and what bars tension in a layer that goes with the layers."""
    scene = pillar(**CALLS[effect])
    before, after = set(active_effects(scene)), set(active_effects(left_out(scene, effect)))
    of_layer = {"dashpots", "no tension"} if effect == "joints that differ" else set()
    assert before - after == {effect} | of_layer
    assert not after - before


def test_what_the_scene_is_about_stays(pillar):
    with pytest.raises(SceneError, match="is the subject of the scene"):
        left_out(pillar(**ACROSS), "spatial motion")


def test_an_end_that_the_load_needs_stays(pillar):
    """The base that shakes cannot be free; the reason is the scene's own."""
    load = {"shape": "sine", "amplitude": 0.1, "period": 0.01, "quantity": "velocity"}
    with pytest.raises(SceneError, match=r"load\.quantity .*needs ends\.start"):
        left_out(pillar(ends__start="fixed", load=load), "fixed ends")


@pytest.mark.parametrize("effect", CALLS)
def test_an_effect_alone_is_the_only_one(effect, pillar):
    """Of all that can be left out; finite rotation and slip need the space that the scene is in,
    and what becomes of slip needs slip."""
    changes = {"record__energy": True} | CALLS[effect]
    scene = pillar(**{"joints__damping_ratio": 0.02} | changes)
    assert set(active_effects(only(scene, None))) <= {"spatial motion"}
    assert set(active_effects(only(scene, effect))) - {"spatial motion"} == {
        effect,
        NEEDS.get(effect, effect),
    }


def test_what_needs_others_is_not_alone(pillar):
    """Slip does not act on a pillar that is not struck across."""
    with pytest.raises(SceneError, match="has no effect without the others"):
        only(pillar(joints__friction_angle=30.0), "slip")


@pytest.fixture
def cheap(monkeypatch):
    """The cost of everything, by a step that is quickly compiled; one round of everything."""
    monkeypatch.setattr(ablation, "with_every_effect", lambda scene: scene)
    monkeypatch.setattr("compare.studies.step_cost.REPEATS", 1)


def test_influence_is_the_misfit_of_the_result_without(pillar, cheap):
    """The ledger changes nothing; dashpots do, and shorten the step."""
    scene = pillar(joints__damping_ratio=0.05, time__duration=0.03)
    one = ablate("a/b", scene, prepare(scene))
    found = {w.effect: w for w in one.effects}
    assert set(found) == {"dashpots", "energy ledger"}
    assert found["energy ledger"].misfit == 0 and found["energy ledger"].steps == 1
    plain = dem.simulate(left_out(scene, "dashpots"))["stress"].values
    expected = relative_l2(plain, dem.simulate(scene)["stress"].values)
    assert found["dashpots"].misfit == pytest.approx(expected) and expected > 0.01
    assert found["dashpots"].steps > 1


#: ns of a block-step with (dashpots, energy ledger).
KNOWN = {(False, False): 1.0, (False, True): 3.0, (True, False): 4.0, (True, True): 7.0}


def test_costs_are_differences_of_what_was_timed(pillar, monkeypatch):
    """Of steps of known cost, 20 ns with everything: alone over the bare one, otherwise of the
    scene's own over the one without."""

    def known(scenes, name="dem"):
        effects = [active_effects(one) for one in scenes[1:]]
        ns = [20.0, *(KNOWN["dashpots" in e, "energy ledger" in e] for e in effects)]
        return [StepCost(x, 0.25 * x) for x in ns]

    monkeypatch.setattr(ablation, "step_costs", known)
    monkeypatch.setattr(ablation, "applies", lambda name, scene: False)  # in rock nothing is timed
    scene = pillar(joints__damping_ratio=0.05, time__duration=0.01)
    names = "dashpots", "energy ledger"
    one = ablate(
        "a/b", scene, [ablation.Dropped(name, 0.0, 1.0, True, False, "") for name in names]
    )
    assert (one.bare, one.own, one.everything) == (1.0, 7.0, 20.0)
    dashpots, ledger = one.effects
    assert (dashpots.alone, dashpots.cost, dashpots.share) == (3.0, 4.0, 4 / 7)
    assert (ledger.alone, ledger.cost, ledger.share) == (2.0, 3.0, 3 / 7)
    assert (dashpots.noise["alone"], dashpots.noise["cost"]) == (0.25 * 5, 0.25 * 10)
    assert dashpots.is_resolved("cost") and ledger.is_resolved("alone")


def test_what_stands_still_with_an_effect_has_no_misfit():
    """A component that is round-off with the effect has none; the moving one has a misfit."""
    still = [[1.0, 1e-17], [2.0, -1e-17], [1.0, 3e-17]]
    result, without = (
        xr.Dataset(
            {"velocity": (("velocity_y", "time", "axis"), [values])},
            {"time": [0.0, 1.0, 2.0], "velocity_y": [3.0], "axis": ["x", "y"]},
        )
        for values in (still, [[1.1, 0.1], [2.0, 0.2], [1.0, 0.1]])
    )
    misfit, stirred = ablation._influence(without, result)
    assert misfit == pytest.approx(0.1 / 6**0.5) and stirred.startswith("velocity y")
    assert ablation._influence(result, result) == (0.0, "")


def test_an_effect_that_stays_has_a_reason_and_no_number(pillar, cheap):
    """The wall that the load shakes; the ledger beside it is measured."""
    load = {"shape": "sine", "amplitude": 0.1, "period": 0.01, "quantity": "velocity"}
    stays = ablation._drop(pillar(ends__start="fixed", load=load), "fixed ends", None)
    assert "is the motion of a base" in stays.reason
    scene = pillar(time__duration=0.01)
    there = ablation.Dropped("energy ledger", 0.0, 1.0, True, False, "")
    fixed, ledger = ablate("a/b", scene, [stays, there]).effects
    assert fixed.reason == stays.reason
    assert np.isnan([fixed.alone, fixed.cost, fixed.share, fixed.rock, fixed.misfit]).all()
    assert ledger.reason == "" and np.isfinite([ledger.alone, ledger.cost]).all()


def test_rock_that_cannot_take_the_scene_has_no_number(pillar, cheap):
    """Only rigid blocks have local damping; their own costs are given nonetheless."""
    scene = pillar(damping={"local": 0.1}, time__duration=0.01)
    there = ablation.Dropped("local damping", 0.1, 1.0, False, False, "")
    found = ablate("a/b", scene, [there])
    assert np.isnan(found.rock) and np.isnan(found.effects[0].rock)
    assert np.isfinite(found.effects[0].cost)
