"""Cost and influence of effects of a rock mass: leaving one out leaves exactly that one out."""

import numpy as np
import pytest

from cases.effects import active_effects, effects
from cases.errors import SceneError
from cases.read import load_tables
from cases.schema.joint import PARTS
from compare.engines import solve
from compare.experiments.ablation import ablation
from compare.experiments.ablation.ablation import ablate, prepare
from compare.experiments.ablation.variants import NEEDS, left_out, only
from compare.misfit.metrics import misfit
from compare.studies import step_cost

ELASTIC = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
ROWS = {"name": "rows", "dip": 0.0, "spacing": 2.0, **ELASTIC}
COLUMNS = ROWS | {"name": "columns", "dip": 90.0}
PRESS = {"kind": "pressure", "side": "top", "shape": "ricker", "amplitude": 1e6, "period": 0.004}
WAVE = {"kind": "P", "direction": [0.0, 1.0], "shape": "step", "amplitude": 1e6}
ACTS = {"loads", "incident waves", "shaken base"}


def law(part):
    """Return the joints of a part of the joint law."""
    slides = {"friction_angle": 30.0} if part.along else {}
    return {"joint_sets": [ROWS | slides | part.sample, COLUMNS]}


CALLS = {part.name: law(part) for part in PARTS} | {
    "dashpots": {"joint_sets": [ROWS | {"damping_ratio": 0.02}, COLUMNS]},
    "no tension": {"joint_sets": [ROWS | {"tension": False}, COLUMNS]},
    "slip": {"joint_sets": [ROWS | {"friction_angle": 30.0, "cohesion": 1e4}, COLUMNS]},
    "quiet sides": {"boundaries": {"bottom": "quiet"}},
    "fixed sides": {"boundaries": {"bottom": "fixed"}},
    "periodic sides": {"boundaries": {"left": "periodic", "right": "periodic"}},
    "energy ledger": {"record": {"points": [[6.0, 3.0]]}},
    "field output": {"record": {"points": [[6.0, 3.0]], "energy": False, "fields": 1e-3}},
    "mass damping": {"damping": {"mass_proportional": 5.0}},
    "local damping": {"damping": {"local": 0.5}},
    "constant Q": {"rock": {"density": 2600.0, "intact_modulus": 5e10, "quality_factor": 20.0}},
    "gravity": {"gravity": {"static": False}},
    "prestress": {"prestress": {"xx": 1e6, "yy": 2e6}},
}


def mass(**tables):
    """Blocks of 2 m in 12 m by 10 m, free, pressed at the top, without a ledger."""
    ours = {
        "title": "blocks",
        "domain": {"size": [12.0, 10.0]},
        "rock": {"density": 2600.0, "intact_modulus": 5e10},
        "joint_sets": [ROWS, COLUMNS],
        "loads": [PRESS],
        "time": {"duration": 0.01},
        "record": {"points": [[6.0, 3.0]], "energy": False},
    }
    return load_tables(ours | tables)


@pytest.mark.parametrize("effect", CALLS)
def test_leaving_one_out_leaves_the_others(effect):
    scene = mass(**CALLS[effect])
    before, after = set(active_effects(scene)), set(active_effects(left_out(scene, effect)))
    assert before - after == {effect} and not after - before


def test_every_effect_is_left_out_or_is_what_acts():
    assert {one.name for one in effects(mass())} == set(CALLS) | ACTS


@pytest.mark.parametrize("effect", CALLS)
def test_an_effect_alone_is_the_only_one_beside_what_acts(effect):
    scene = mass(**{"damping": {"mass_proportional": 1.0}} | CALLS[effect])
    assert set(active_effects(only(scene, None))) == {"loads"}
    assert set(active_effects(only(scene, effect))) == {effect, NEEDS.get(effect, effect), "loads"}


def test_what_acts_stays():
    with pytest.raises(SceneError, match="is the subject of the scene"):
        left_out(mass(), "loads")


def test_a_side_that_a_wave_enters_stays():
    """The reason is the scene's own."""
    scene = mass(boundaries={"bottom": "quiet"}, waves=[WAVE], loads=[])
    with pytest.raises(SceneError, match=r"must be 'quiet': waves\[0\] enters there"):
        left_out(scene, "quiet sides")


def test_influence_is_the_misfit_of_the_result_without(monkeypatch):
    """Local damping, which only rigid blocks have, and a quiet side; loads cannot be left out."""
    monkeypatch.setattr(ablation, "with_every_effect", lambda scene: scene)
    monkeypatch.setattr(step_cost, "REPEATS", 1)
    scene = mass(damping={"local": 0.3}, boundaries={"bottom": "quiet"})
    one = ablate("a/b", scene, prepare(scene))
    found = {e.effect: e for e in one.effects}
    assert set(found) == {"quiet sides", "local damping", "loads"}
    full = solve("dem", scene)
    for name in ("quiet sides", "local damping"):
        expected = misfit(solve("dem", left_out(scene, name)), full)
        assert found[name].misfit == expected > 0.01
        assert np.isfinite([found[name].alone, found[name].cost]).all()
    assert found["loads"].reason == "is the subject of the scene"
    assert np.isnan(one.rock) and one.own > 0 and one.bare > 0
