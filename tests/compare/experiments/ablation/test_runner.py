"""Effects of many scenes: kept when done, whichever process prepared them, and shown whole."""

import json
import re
from math import nan

import pandas as pd
import pytest

from compare.experiments.ablation import runner
from compare.experiments.ablation.ablation import Ablation, Dropped, EffectCost
from compare.experiments.ablation.diagram import draw
from compare.experiments.ablation.runner import Variant, all_shipped, reported, run
from compare.experiments.ablation.summary import sentences, summarise, table

NOISE = {"alone": 0.05, "cost": 0.2, "rock": 0.1}
LEDGER = EffectCost("energy ledger", 1.0, 3.0, 0.75, 1.0, nan, 0.0, "", NOISE)
LAYER = EffectCost("joints that differ", 0.1, -0.1, -0.025, 1.0, nan, 0.8, "", NOISE)
DAMPED = EffectCost("dashpots", 0.2, 2.0, 0.5, 4.0, 1.5, 0.05, "", NOISE)
SPACE = EffectCost(
    "spatial motion", nan, nan, nan, nan, nan, nan, "is the subject of the scene", NOISE
)
FOUND = [
    Ablation("set/one", "One", "", 0.5, 4.0, 40.0, nan, [LAYER, LEDGER]),
    Ablation("set/two", "Two", "hard", 0.5, 4.0, 20.0, 3.0, [SPACE, DAMPED]),
]


@pytest.fixture
def counted(monkeypatch):
    """Replace solving and timing by stubs; return the list of timed cases."""
    timed = []
    monkeypatch.setattr(
        runner, "prepare", lambda scene: [Dropped("energy ledger", 0.0, 1.0, True, False, "")]
    )

    def ablate(name, scene, dropped):
        timed.append((name, dropped))
        return FOUND[0]._replace(scene=name, effects=[LEDGER, SPACE])

    monkeypatch.setattr(runner, "ablate", ablate)
    return timed


def test_what_is_done_is_not_done_again(counted, pillar, tmp_path):
    """The second run reads the files of the first, including nan, and measures only new cases."""
    wanted = [Variant("a/b", pillar())]
    first, fractions = run(wanted, tmp_path, None, None), []
    more = [*wanted, Variant("a/c", pillar(time__duration=0.01))]
    again = run(more, tmp_path, None, fractions.append)
    assert [name for name, _ in counted] == ["a/b", "a/c"]
    assert repr(again[0]) == repr(first[0])
    assert fractions == sorted(fractions) and fractions[-1] == 1
    names = [f"{case.key}{end}.json" for case in more for end in ("", "-prepared")]
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted(names)


def test_an_interrupted_run_keeps_what_was_solved(counted, pillar, tmp_path, monkeypatch):
    """Existing answers are used; only the timing remains."""
    wanted = [Variant("a/b", pillar())]
    timed = runner.ablate
    monkeypatch.setattr(runner, "ablate", lambda *case: (_ for _ in ()).throw(KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        run(wanted, tmp_path)
    monkeypatch.setattr(runner, "prepare", lambda scene: pytest.fail("solved again"))
    monkeypatch.setattr(runner, "ablate", timed)
    run(wanted, tmp_path)
    assert counted[0][1] == [Dropped("energy ledger", 0.0, 1.0, True, False, "")]


def test_cases_are_told_apart_by_all_that_decides_them(pillar):
    one, other = Variant("a/b", pillar()), Variant("a/b", pillar(joints__damping_ratio=0.01))
    assert one.key == Variant("a/b", pillar()).key
    assert len({one.key, other.key, one._replace(name="a/c").key}) == 3


def test_every_variant_of_every_shipped_scene_is_taken():
    every = {(case.name, case.scene.name) for case in all_shipped()}
    assert {("beyond/spall", ""), ("beyond/spall", "strong joints")} <= every
    assert {(case.name, case.scene.name) for case in reported()} <= every


def test_sentences_have_the_numbers_of_the_extremes():
    sets, nothing, some = sentences(FOUND)
    assert "10.0 % (set/one) to 20.0 % (set/two, hard)" in sets
    assert "the energy ledger: 75.0 % of a step of set/one" in nothing
    assert (
        "most expensive is dashpots in set/two, hard (50.0 % of a step, misfit 5.00 % without)"
        in some
    )
    assert "influential is joints that differ in set/one (no measurable cost, misfit 80.0 %" in some


def test_a_sentence_says_what_costs_less_with_an_effect():
    held = DAMPED._replace(cost=-2.0, share=-0.5)
    _, some = sentences([FOUND[1]._replace(effects=[held])])
    assert some == (
        "The only one that changes it is dashpots in set/two, hard (50.0 % of a step less with it, "
        "misfit 5.00 % without)."
    )


def test_table_has_the_dearest_first_and_says_why_an_effect_stays():
    found = table(FOUND)
    effects = ["energy ledger", "joints that differ", "dashpots", "spatial motion"]
    assert found.index.get_level_values("effect").tolist() == effects
    two = found.to_numpy().tolist()[2:]
    assert two[1] == [*[""] * 6, "is the subject of the scene"]
    assert two[0] == ["5.00", "50", "+2", "+0.2", "4", "+1.5", ""]
    assert "10.0 % of 40 ns" in found.index[0][0]
    assert list(table(FOUND[:1])) == list(found)[:-1]


def test_table_says_what_is_not_resolved():
    """A cost below the noise of its timing, negative or not; a motion that only round-off has."""
    stirred = LAYER._replace(misfit=nan, stirred="velocity x at 3 m")
    rows = table([FOUND[0]._replace(effects=[LAYER, stirred])]).to_numpy().tolist()
    hidden = ["not resolved", "not resolved (within ±0.2)", "+0.1", "1"]
    assert rows[0][:5] == ["80.0", *hidden]
    assert rows[1][0] == "velocity x at 3 m is at rest with it: not resolved"


def test_diagram_has_a_point_for_every_effect_that_can_be_left_out():
    """Effects without cost or influence are hollow points at an edge; the others are filled."""
    ax = draw(FOUND).axes[0]
    points = {line.get_label(): line.get_xydata()[0] for line in ax.lines if line.get_gid()}
    assert set(points) == {"energy ledger", "joints that differ", "dashpots"}
    assert tuple(points["dashpots"]) == pytest.approx((50, 5))
    assert tuple(points["energy ledger"]) == pytest.approx((75, 0.01))
    assert tuple(points["joints that differ"]) == pytest.approx((0.5, 80))
    filled = [line for line in ax.lines if not line.get_gid()]
    assert len(filled) == 1 and tuple(filled[0].get_xydata()[0]) == pytest.approx((50, 5))
    assert sorted(text.get_text() for text in ax.texts) == ["1", "1", "2"]


def test_files_hold_every_number(tmp_path):
    section = summarise(tmp_path, FOUND)
    frame = pd.read_csv(tmp_path / "effects.csv", keep_default_na=False)
    assert frame["effect"].tolist() == [w.effect for b in FOUND for w in b.effects]
    assert frame["ns_everything"].tolist() == [40, 40, 20, 20]
    assert len(re.findall(r'id="effects-points-\d"', section.figure.svg)) == 3
    assert all(file.is_file() for file in section.files)


def test_command_prints_a_scene_and_keeps_its_files(counted, command, tmp_path):
    scene = ["effects", "guo-li-2002/fig-09", "--variant", "no tension", "--workers", "1"]
    said = command(*scene).out
    assert "energy ledger" in said and "10.0 % of 40 ns" in said
    assert "effects.csv" in said and (tmp_path / "effects" / "effects.csv").is_file()
    facts = json.loads(command(*scene, "--json").out)
    assert facts[0]["effects"][0]["misfit"] == 0 and facts[0]["effects"][1]["cost"] is None
    assert len(counted) == 1


@pytest.mark.parametrize("option", [("--variant", "x"), ("--set", "joints.tension=false")])
def test_options_of_a_scene_need_one(option, command):
    said = command("effects", *option, code=2).err
    assert said.count("\n") == 1 and option[0] in said and "needs a scene" in said


def test_wrong_table_of_other_codes_is_one_line(tmp_path, command):
    """Before anything is solved."""
    said = command("report", "--peers", "none.csv", code=2).err
    assert said.count("\n") == 1 and "none.csv" in said and "cannot be read" in said
    assert not (tmp_path / "report").exists()
