"""Effects of a scene: leaving one out leaves exactly that one out; its cost and its influence."""

import json
from itertools import chain
from math import nan

import numpy as np
import pandas as pd
import pytest

from jointwave import dem
from jointwave.cases.effects import active_effects
from jointwave.cases.effects import effects as effects_of
from jointwave.cases.errors import SceneError
from jointwave.cases.read import load_tables
from jointwave.cases.schema.law_parts import PARTS
from jointwave.compare.cli import studies
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.compare.studies import effects
from jointwave.compare.studies.effects import COLUMNS, WITHOUT, Effects, experiment, left_out
from jointwave.compare.studies.effects_summary import draw, sentences, summarise, table
from jointwave.compare.studies.step_cost import StepCost

LAYER = [{"y": 20.0, "spacing_stiffness": 4e8, "damping_ratio": 0.05, "tension": False}]
ACROSS = {"load__direction": [0.6, 0.8, 0.0]}
BASE = {"shape": "sine", "amplitude": 0.1, "period": 0.01, "quantity": "velocity"}
#: Keys of the joint law for its parts, of a pillar and of a rock mass alike.
OF_LAW = {
    "dashpots": {"damping_ratio": 0.02},
    "no tension": {"tension": False},
    "slip": {"friction_angle": 30.0, "cohesion": 1e4},
    "closure": {"maximum_closure": 1e-3},
    "weakening": {"dynamic_friction_angle": 20.0, "weakening_distance": 1e-3},
    "dilation": {"dilation_angle": 5.0, "dilation_distance": 1e-2},
    "rate and state": {"direct_effect": 0.01, "evolution_effect": 0.015}
    | {"critical_slip_distance": 1e-4, "reference_rate": 1e-6},
    "softening": {"tensile_strength": 1e5, "fracture_energy": 100.0},
}
SLIDING = {"slip", *(part.name for part in PARTS if part.along)}
JOINT = {"normal_stiffness": 1e10, "shear_stiffness": 4e9, "spacing": 2.0}
ROWS, COLUMNS_OF_BLOCKS = ({"name": f"{dip:g}", "dip": dip} | JOINT for dip in (0.0, 90.0))
STIFF = {"normal_stiffness": 2e10}
PRESS = {"kind": "pressure", "side": "top", "shape": "ricker", "amplitude": 1e6, "period": 0.004}
WAVE = {"kind": "P", "direction": [0.0, 1.0], "shape": "step", "amplitude": 1e6}
SUBJECT = "is the subject of the scene"


def law(name):
    return ({"friction_angle": 30.0} if name in SLIDING else {}) | OF_LAW[name]


def of_pillar(name):
    across = ACROSS if name in SLIDING else {}
    layered = {"soft_layers": LAYER} if name in ("dashpots", "no tension") else {}
    return across | layered | {f"joints__{key}": value for key, value in law(name).items()}


CALLS = {name: of_pillar(name) for name in OF_LAW} | {
    "segments": {"segments": [{"y": [10.0, 20.0], "density": 2600.0}]},
    "scatter": {"scatter": {"spacing": 0.2, "seed": 1}},
    "joints that differ": {"soft_layers": LAYER},
    "quiet ends": {"ends__end": "quiet"},
    "matched ends": {"ends__start": "matched"},
    "fixed ends": {"ends__end": "fixed"},
    "energy ledger": {},
    "field output": {"record__fields": 0.01},
    "finite rotation": {**ACROSS, "motion__rotation": "finite"},
    "mass damping": {"damping__mass_proportional": 5.0},
    "local damping": {"damping": {"local": 0.5}},
    "constant Q": {"rock__quality_factor": 20.0},
    "gravity": {"gravity": {"direction": [0, 1, 0], "static": False}},
    "prestress": {"prestress": {"normal": 1e5}},
}
#: What only a rock mass has, and what its tables hold in another place.
OF_MASS = {
    "quiet sides": {"boundaries": {"bottom": "quiet"}},
    "fixed sides": {"boundaries": {"bottom": "fixed"}},
    "roller sides": {"boundaries": {"bottom": "roller"}},
    "periodic sides": {"boundaries": {"left": "periodic", "right": "periodic"}},
    "dilation": {"joint_sets": [ROWS | law("dilation"), COLUMNS_OF_BLOCKS]},
    "prestress": {"prestress": {"xx": 1e6, "yy": 2e6}},
}


def mass(**tables):
    """Return blocks of 2 m in 12 m by 10 m, free, pressed at the top, without a ledger."""
    ours = {
        "title": "blocks",
        "domain": {"size": [12.0, 10.0]},
        "rock": {"density": 2600.0, "intact_modulus": 5e10},
        "joint_sets": [ROWS, COLUMNS_OF_BLOCKS],
        "loads": [PRESS],
        "time": {"duration": 0.01},
        "record": {"points": [[6.0, 3.0]], "energy": False},
    }
    return load_tables(ours | tables)


@pytest.mark.parametrize(
    "kind, effect", [*(("pillar", name) for name in CALLS), *(("mass", name) for name in OF_MASS)]
)
def test_a_scene_without_an_effect_keeps_the_others(kind, effect, pillar):
    """But dashpots and what bars tension in a layer that goes with the layers."""
    scene = pillar(**CALLS[effect]) if kind == "pillar" else mass(**OF_MASS[effect])
    of_layer = {"dashpots", "no tension"} if effect == "joints that differ" else set()
    before, after = set(active_effects(scene)), set(active_effects(left_out(scene, effect)))
    assert (before - after, after - before) == ({effect} | of_layer, set())


def test_every_effect_is_tried():
    """Those of a rock mass are left out or are what acts."""
    assert set(CALLS) | set(OF_MASS) == set(WITHOUT)
    acts = {"loads", "incident waves", "shaken base"}
    assert {one.name for one in effects_of(mass())} - set(WITHOUT) == acts


def test_an_effect_that_the_scene_needs_stays(pillar):
    """What it is about, a base that shakes, a side that a wave enters."""
    shaken = pillar(ends__start="fixed", load=BASE)
    entered = mass(boundaries={"bottom": "quiet"}, waves=[WAVE], loads=[])
    for scene, effect, words in (
        (pillar(**ACROSS), "spatial motion", SUBJECT),
        (mass(), "loads", SUBJECT),
        (shaken, "fixed ends", r"load\.quantity .*needs ends\.start"),
        (entered, "quiet sides", r"must be 'quiet': waves\[0\] enters there"),
    ):
        with pytest.raises(SceneError, match=words):
            left_out(scene, effect)


#: ns of a block-step with (dashpots, energy ledger).
KNOWN = {(False, False): 1.0, (False, True): 3.0, (True, False): 4.0, (True, True): 7.0}


@pytest.fixture
def known(monkeypatch):
    def costs(some, name="dem"):
        kinds = [active_effects(one) for one in some]
        return [StepCost(KNOWN["dashpots" in k, "energy ledger" in k], 0.25) for k in kinds]

    monkeypatch.setattr(effects, "step_costs", costs)
    monkeypatch.setattr(effects, "cost_of_every_effect", lambda scene: StepCost(40.0, 0.0))
    monkeypatch.setattr(effects.step_cost, "with_every_effect", lambda scene: scene)


def run(variant, folder, progress=None):
    rows = experiment("", [variant], folder).rows(None, progress)
    return pd.DataFrame(chain(*rows), columns=COLUMNS)


def test_effects_are_measured_by_leaving_them_out_and_once(pillar, known, tmp_path, monkeypatch):
    """The ledger changes nothing; dashpots do, and shorten the step. Costs are differences."""
    fractions: list[float] = []
    steps = {"numerics__continuum__scheme": "implicit", "time__duration": 0.03}
    damped = "a/b", pillar(joints__damping_ratio=0.05, **steps)
    found = run(damped, tmp_path, fractions.append)
    by_name = found.set_index(["engine", "effect"])
    assert set(by_name.loc["dem"].index) == {"dashpots", "energy ledger"} and fractions[-1] == 1
    ledger, dashpots = by_name.loc["dem", "energy ledger"], by_name.loc["dem", "dashpots"]
    assert (ledger.misfit, ledger.steps) == (0, 1)
    plain = dem.simulate(left_out(damped[1], "dashpots"))["stress"].values
    expected = relative_l2(plain, dem.simulate(damped[1])["stress"].values)
    assert dashpots.misfit == pytest.approx(expected) and expected > 0.01
    assert dashpots.steps > 1
    assert (dashpots.ns, dashpots.share) == (4.0, 4 / 7)
    assert (ledger.ns, ledger.share, ledger.noise, ledger.own) == (3.0, 3 / 7, 0.5, 7.0)
    assert ledger.everything == 40.0
    rock = by_name.loc["continuum-jointed", "dashpots"]
    assert rock.ns == 4.0 and 0.01 < rock.misfit < 1 and np.isnan(rock.everything)
    for name in ("measure", "timed"):
        monkeypatch.setattr(effects, name, lambda *some: pytest.fail("measured again"))
    pd.testing.assert_frame_equal(found, run(damped, tmp_path))


def test_an_effect_that_stays_has_a_reason_and_no_number(known):
    """A side that a wave enters. Rock that cannot be run, above its critical step, has no row."""
    sides = {"bottom": "quiet", "left": "periodic", "right": "periodic"}
    rock, joints = {"continuum": {"step_fraction": 1.5}}, [ROWS, COLUMNS_OF_BLOCKS | STIFF]
    scene = mass(boundaries=sides, joint_sets=joints, waves=[WAVE], loads=[], numerics=rock)
    point = ("a/b", scene), effects.BLOCKS
    rows = {one["effect"]: one for one in effects.timed(point, effects.measure(point))}
    quiet, periodic = rows["quiet sides"], rows["periodic sides"]
    assert "waves[0] enters there" in quiet["reason"]
    assert not {"ns", "share", "misfit"} & {*quiet}
    assert periodic["reason"] == "" and np.isfinite(periodic["ns"])
    assert effects.measure((("a/b", scene), effects.ROCK)) == []


def row(effect, misfit, ns, share, steps=1.0, of=("set/one", "One", "", "dem"), **more):
    about = {"reason": "", "own": 4.0, "everything": 40.0, "ns": ns, "noise": 0.2, "share": share}
    about |= dict(zip(COLUMNS, (*of, effect), strict=False))
    return about | {"misfit": misfit, "steps": steps} | more


TWO = {"of": ("set/two", "Two", "hard", "dem"), "everything": 20.0}
FOUND = pd.DataFrame(
    [
        row("joints that differ", 0.8, -0.1, -0.025),
        row("energy ledger", 0.0, 3.0, 0.75),
        row("spatial motion", nan, nan, nan, nan, **TWO, reason=SUBJECT),
        row("dashpots", 0.05, 2.0, 0.5, 4.0, **TWO),
        row("dashpots", 0.04, 1.5, 0.375, of=("set/two", "Two", "hard", "rock"), everything=nan),
    ],
    columns=COLUMNS,
)


def test_the_table_has_the_most_expensive_first_and_says_why_an_effect_stays():
    """A cost below the noise of its timing is said to be within it; sentences name the extremes."""
    found = table(FOUND)
    effects = ["energy ledger", "joints that differ", "dashpots", "spatial motion", "dashpots"]
    assert found.index.get_level_values("effect").tolist() == effects
    assert found.iloc[1, 1:3].tolist() == ["within ±5", "within ±0.2"]
    assert found.iloc[2].tolist() == [5.0, 50.0, 2.0, 4.0, ""]
    assert found.iloc[3, -1] == SUBJECT and found.iloc[3, :-1].isna().all()
    sets, nothing = sentences(FOUND)
    assert "10.0 % (set/one) to 20.0 % (set/two, hard)" in sets
    assert "the energy ledger: 75.0 % of a step of set/one" in nothing


def test_the_diagram_has_a_point_for_every_effect_that_can_be_left_out():
    ax = draw(FOUND).axes[0]
    points = {line.get_label(): line.get_xydata()[0] for line in ax.lines if line.get_gid()}
    assert set(points) == {"energy ledger", "joints that differ", "dashpots"}
    assert tuple(points["dashpots"]) == pytest.approx((50, 5))
    assert tuple(points["energy ledger"]) == pytest.approx((75, 0.01))
    assert tuple(points["joints that differ"]) == pytest.approx((0.5, 80))
    assert sorted(text.get_text() for text in ax.texts) == ["1", "1", "2"]


def test_the_command_prints_a_scene_and_keeps_its_files(command, tmp_path, monkeypatch):
    summarise(tmp_path, FOUND)
    frame = pd.read_csv(tmp_path / "effects.csv", keep_default_na=False)
    assert frame["effect"].tolist() == FOUND.effect.tolist()
    rows = [row("energy ledger", 0, 3, 0.75)]
    monkeypatch.setattr(Effects, "rows", lambda *of: [rows])
    scene = ["effects", "guo-li-2002/fig-09", "--variant", "no tension"]
    said = command(*scene).out
    assert "energy ledger" in said and "10.0 % of 40 ns" in said
    assert "effects.csv" in said and (tmp_path / "effects" / "effects.csv").is_file()
    facts = json.loads(command(*scene, "--json").out)
    assert facts["rows"][0]["misfit"] == 0 and facts["rows"][0]["ns"] == 3


@pytest.mark.parametrize(
    ("scene", "change", "words"),
    [
        ("guo-li-2002/fig-03", "record.energy=false", "has no effect to leave out"),
        ("rock-mass/one-joint", "numerics.dem={}", "dem does not apply: numerics.dem.block"),
    ],
)
def test_a_scene_without_effects_or_rigid_blocks_is_refused_in_one_line(
    scene, change, words, command, monkeypatch
):
    monkeypatch.setattr(studies, "CORES", 1)
    said = command("effects", scene, "--variant", "", "--set", change, code=2)
    assert said.out == "" and words in said.err and said.err.count("\n") == 1
