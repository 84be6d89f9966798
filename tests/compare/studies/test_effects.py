"""Cost and influence of effects: measured, saved when done, and shown whole."""

import json
from itertools import chain
from math import nan

import numpy as np
import pandas as pd
import pytest

from jointwave import dem
from jointwave.cases.effects import active_effects
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.compare.studies import effects
from jointwave.compare.studies.effects import COLUMNS, Effects, experiment, left_out
from jointwave.compare.studies.effects_summary import draw, sentences, summarise, table
from jointwave.compare.studies.step_cost import StepCost

#: ns of a block-step with (dashpots, energy ledger).
KNOWN = {(False, False): 1.0, (False, True): 3.0, (True, False): 4.0, (True, True): 7.0}


@pytest.fixture
def known(monkeypatch):
    """Replace timing by KNOWN; return the timed scenes."""
    scenes = []

    def costs(some, name="dem"):
        scenes.extend(some)
        kinds = [active_effects(one) for one in some]
        return [StepCost(KNOWN["dashpots" in k, "energy ledger" in k], 0.25) for k in kinds]

    monkeypatch.setattr(effects, "step_costs", costs)
    monkeypatch.setattr(effects, "cost_of_every_effect", lambda scene: StepCost(40.0, 0.0))
    return scenes


@pytest.fixture
def damped(pillar):
    return "a/b", pillar(joints__damping_ratio=0.05, time__duration=0.03)


def run(variant, folder, progress=None):
    """Return the table of the effects of a variant."""
    rows = experiment("", [variant], folder).rows(None, progress)
    return pd.DataFrame(chain(*rows), columns=COLUMNS)


def test_effects_are_measured_by_leaving_them_out(damped, known, tmp_path):
    """The ledger changes nothing; dashpots do, and shorten the step. Costs are differences."""
    found = run(damped, tmp_path).set_index(["engine", "effect"])
    assert set(found.loc["dem"].index) == {"dashpots", "energy ledger"}
    ledger, dashpots = found.loc["dem", "energy ledger"], found.loc["dem", "dashpots"]
    assert (ledger.misfit, ledger.steps) == (0, 1)
    plain = dem.simulate(left_out(damped[1], "dashpots"))["stress"].values
    expected = relative_l2(plain, dem.simulate(damped[1])["stress"].values)
    assert dashpots.misfit == pytest.approx(expected) and expected > 0.01
    assert dashpots.steps > 1
    assert (dashpots.ns, dashpots.share) == (4.0, 4 / 7)
    assert (ledger.ns, ledger.share, ledger.noise, ledger.own) == (3.0, 3 / 7, 0.5, 7.0)
    assert ledger.everything == 40.0
    rock = found.loc["continuum-jointed", "dashpots"]
    assert rock.ns == 4.0 and 0.01 < rock.misfit < 1 and np.isnan(rock.everything)


def test_what_is_done_is_not_done_again(damped, known, tmp_path, monkeypatch):
    """NaN is read as such."""
    fractions: list[float] = []
    first = run(damped, tmp_path, fractions.append)
    for name in ("measure", "timed"):
        monkeypatch.setattr(effects, name, lambda *some: pytest.fail("measured again"))
    again = run(damped, tmp_path)
    pd.testing.assert_frame_equal(first, again)
    assert fractions[-1] == 1


def test_an_effect_that_stays_has_a_reason_and_no_number(pillar, known):
    """The wall that the load shakes; only rigid blocks have local damping."""
    load = {"shape": "sine", "amplitude": 0.1, "period": 0.01, "quantity": "velocity"}
    scene = pillar(ends__start="fixed", load=load, damping={"local": 0.1}, time__duration=0.01)
    point = ("a/b", scene), effects.BLOCKS
    rows = {one["effect"]: one for one in effects.timed(point, effects.measure(point))}
    fixed, local = rows["fixed ends"], rows["local damping"]
    assert "is the motion of a base" in fixed["reason"]
    assert not {"ns", "share", "misfit"} & {*fixed}
    assert local["reason"] == "" and np.isfinite(local["ns"])
    assert effects.measure((("a/b", scene), effects.ROCK)) == []


def row(effect, misfit, ns, share, steps=1.0, of=("set/one", "One", "", "dem"), **more):
    """Return a row of a scene whose step takes 4 ns, timed to 0.2 ns."""
    about = {"reason": "", "own": 4.0, "everything": 40.0, "ns": ns, "noise": 0.2, "share": share}
    about |= dict(zip(COLUMNS, (*of, effect), strict=False))
    return about | {"misfit": misfit, "steps": steps} | more


TWO = {"of": ("set/two", "Two", "hard", "dem"), "everything": 20.0}
SUBJECT = "is the subject of the scene"
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


def test_sentences_have_the_numbers_of_the_extremes():
    sets, nothing = sentences(FOUND)
    assert "10.0 % (set/one) to 20.0 % (set/two, hard)" in sets
    assert "the energy ledger: 75.0 % of a step of set/one" in nothing


def test_the_table_has_the_most_expensive_first_and_says_why_an_effect_stays():
    """A cost below the noise of its timing is said to be within it."""
    found = table(FOUND)
    assert "10.0 % of 40 ns" in found.index[0][0]
    effects = ["energy ledger", "joints that differ", "dashpots", "spatial motion", "dashpots"]
    assert found.index.get_level_values("effect").tolist() == effects
    assert found.iloc[1, 1:3].tolist() == ["within ±5", "within ±0.2"]
    assert found.iloc[2].tolist() == [5.0, 50.0, 2.0, 4.0, ""]
    assert found.iloc[3, -1] == SUBJECT and found.iloc[3, :-1].isna().all()
    assert found.index[4][0] == (
        "2. Two (set/two, hard): 4 ns per degree of freedom and step of jointed rock"
    )


def test_the_diagram_has_a_point_for_every_effect_that_can_be_left_out():
    """Effects without cost or influence are points at an edge."""
    ax = draw(FOUND).axes[0]
    points = {line.get_label(): line.get_xydata()[0] for line in ax.lines if line.get_gid()}
    assert set(points) == {"energy ledger", "joints that differ", "dashpots"}
    assert tuple(points["dashpots"]) == pytest.approx((50, 5))
    assert tuple(points["energy ledger"]) == pytest.approx((75, 0.01))
    assert tuple(points["joints that differ"]) == pytest.approx((0.5, 80))
    assert sorted(text.get_text() for text in ax.texts) == ["1", "1", "2"]


def test_files_hold_every_number(tmp_path):
    found = summarise(tmp_path, FOUND)
    frame = pd.read_csv(tmp_path / "effects.csv", keep_default_na=False)
    assert frame["effect"].tolist() == FOUND.effect.tolist()
    assert frame["everything"].tolist() == ["40", "40", "20", "20", ""]
    assert all(file.is_file() for file in found.files)


def test_the_command_prints_a_scene_and_keeps_its_files(command, tmp_path, monkeypatch):
    rows = [row("energy ledger", 0, 3, 0.75)]
    monkeypatch.setattr(Effects, "rows", lambda *of: [rows])
    scene = ["effects", "guo-li-2002/fig-09", "--variant", "no tension"]
    said = command(*scene).out
    assert "energy ledger" in said and "10.0 % of 40 ns" in said
    assert "effects.csv" in said and (tmp_path / "effects" / "effects.csv").is_file()
    facts = json.loads(command(*scene, "--json").out)
    assert facts["rows"][0]["misfit"] == 0 and facts["rows"][0]["ns"] == 3


def test_a_scene_without_effects_is_refused_in_one_line(command):
    scene = ["effects", "guo-li-2002/fig-03", "--set", "record.energy=false"]
    assert "has no effect to leave out" in (said := command(*scene, code=2).err)
    assert said.count("\n") == 1
