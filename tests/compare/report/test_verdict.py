"""Verdicts on engines, from synthetic results with known distances: on the page, and in the answer
of `jointwave compare`."""

import json
import re
from math import nan
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from jointwave.compare.cli.compare import show_comparisons
from jointwave.compare.engines import label_of
from jointwave.compare.figures.tables import misfit_table
from jointwave.compare.misfit.alignment import AlignedCurve
from jointwave.compare.misfit.external import read_curves
from jointwave.compare.misfit.metrics import Worst
from jointwave.compare.misfit.pairs import Comparison, measure, measure_curves
from jointwave.compare.report.scenes import SolvedScene, lead
from jointwave.compare.report.verdict import NOT_CHECKED, EngineScore, VariantScore, engine_scores
from jointwave.compare.text import in_seconds, mean_and_worst

WAVE = np.sin(np.linspace(0, 9, 200))
ABOUT = {"seconds_stepping": 0.02, "warnings": '["a slip"]', "steps": 100}
ABOUT |= {"degrees_of_freedom": 1, "dt": 1e-3, "critical_dt": 2e-3}
FAR = {"dem": 0.03, "continuum_jointed": 1e-4, "continuum_equivalent": 0.3, "jointed_bar": 0.0}


@pytest.fixture
def compared(pillar):
    """Return a function that gives a comparison: by name how far each result is from one wave."""

    def make(name="", expect=None, **far):
        results = {
            one.replace("_", "-"): xr.Dataset(
                {"stress": (("stress_y", "time"), (1 + x) * WAVE[None])},
                {"stress_y": [20.0], "time": 1e-3 * np.arange(200.0)},
                ABOUT,
            )
            for one, x in far.items()
        }
        scene = pillar().model_copy(update={"expect": expect or {}, "name": name})
        return Comparison(scene, results, {"series": "its reason"}, measure(results))

    return make


@pytest.fixture
def answer(capsys):
    """Return a function that gives what `jointwave compare` prints of comparisons."""

    def print_all(found, every=False, as_json=False):
        show_comparisons(found, every, as_json)
        return capsys.readouterr().out

    return print_all


@pytest.mark.parametrize(
    ("far", "engine", "judged", "own", "against", "word"),
    [
        # An engine is held to its own model and to the finest.
        (FAR | {"lattice": 0.029}, "dem", 0.03, 0.001 / 1.029, "jointed-bar", "close"),
        (FAR, "continuum-jointed", 1e-4, 1e-4, "jointed-bar", "agrees"),
        (FAR, "continuum-equivalent", 0.3, nan, "jointed-bar", "far off"),
        # Without an exact solution the resolved joints are the finest.
        ({"dem": 0.1, "continuum_jointed": 0.0}, "dem", 0.1, nan, "continuum-jointed", "differs"),
        ({"continuum_jointed": 0.0}, "continuum-jointed", nan, nan, "", NOT_CHECKED.word),
        # Of a reference that stands still nothing is known.
        ({"dem": 0.1, "spatial_lattice": -1.0}, "dem", nan, nan, None, NOT_CHECKED.word),
        ({"dem": -1.0, "lattice": -1.0}, "dem", nan, nan, None, NOT_CHECKED.word),
    ],
)
def test_an_engine_is_judged_by_the_finest_physics(
    compared, far, engine, judged, own, against, word
):
    found = engine_scores([compared(**far)])[engine]
    (variant,) = found.variants
    assert found.total.judged == pytest.approx(judged, nan_ok=True)
    assert variant.own.judged == pytest.approx(own, nan_ok=True)
    assert found.verdict.word == word and against in (None, variant.against)


def test_the_worst_variant_counts_and_one_that_nothing_checks_takes_the_tick_from_all(compared):
    found = engine_scores([compared(dem=x, jointed_bar=0.0) for x in (0.3, 0.01, 0.06)])
    assert found["dem"].total.judged == pytest.approx(0.3)
    assert list(found) == ["dem"] and found["dem"].verdict.word == "far off"
    near, worse = (compared(continuum_jointed=x, jointed_bar=0.0) for x in (1e-4, 0.5))
    alone = compared(continuum_jointed=0.0, dem=0.1)
    found = engine_scores([near, alone])["continuum-jointed"]
    assert [one.verdict.word for one in found.variants] == ["agrees", NOT_CHECKED.word]
    assert found.verdict == NOT_CHECKED and len(found.unchecked) == 1
    assert engine_scores([worse, alone])["continuum-jointed"].verdict.word == "far off"


def test_what_is_below_ten_times_the_error_of_the_reference_is_no_agreement(compared):
    comparison = compared("", {"dem ~ jointed-bar": 0.01}, dem=1e-4, jointed_bar=0.0)
    bar = comparison.results["jointed-bar"]
    rms = float(np.sqrt((bar.stress**2).mean()))
    bar["stress_error"] = ("stress_y", [3e-3 * rms])
    found = engine_scores([comparison])["dem"]
    assert found.total.judged == pytest.approx(0.03) and found.broken == ["dem ~ jointed-bar"]
    comparison.scene.expect.clear()
    assert engine_scores([comparison])["dem"].verdict.word == "close"


def test_a_bound_of_the_scene_that_is_not_met_outdoes_every_misfit(compared):
    """A pair that was not run breaks none; a quantity that was not recorded does."""
    expect = {"dem ~ jointed-bar": 1e-4, "dem ~ lattice": 1.0, "dem ~ images": 1e-9}
    expect |= {"dem ~ lattice: peak stress": 1e-4, "dem ~ lattice: velocity": 1.0}
    found = engine_scores([compared("", expect, dem=0.002, jointed_bar=0.0, lattice=0.0)])
    broken = ["dem ~ jointed-bar", "dem ~ lattice: peak stress", "dem ~ lattice: velocity"]
    assert found["dem"].broken == broken
    assert found["dem"].verdict.sign == "✗" and found["dem"].verdict.word == "out of bounds"


def test_every_component_at_a_receiver_has_a_column_of_its_own(pillar):
    """Of motion in space; they are 1, 2 and 3 % off."""
    wave = WAVE[None, :, None] * [1.0, 1.0, 1.0]
    results = {
        name: xr.Dataset(
            {"velocity": (("velocity_y", "time", "axis"), wave * off)},
            {"velocity_y": [20.0], "time": 1e-3 * np.arange(200.0), "axis": ["x", "y", "z"]},
        )
        for name, off in {"dem": [1.01, 1.02, 1.03], "continuum-jointed": 1.0}.items()
    }
    (row,) = misfit_table([Comparison(pillar(), results, {}, measure(results))]).to_dict("records")
    found = {name.rpartition(", ")[2]: misfit for name, misfit in row.items()}
    names = [f"velocity {axis} at 20 m (%)" for axis in "xyz"]
    assert found == pytest.approx(dict(zip(names, (1, 2, 3), strict=True)))
    places = 20.0 + np.arange(6)  # many columns are rows
    many = {name: x.sel(velocity_y=[20.0] * 6) for name, x in results.items()}
    many = {name: x.assign_coords(velocity_y=places) for name, x in many.items()}
    table = misfit_table([Comparison(pillar(), many, {}, measure(many))])
    assert len(table) == 18
    assert table.loc["base scene, velocity y at 21 m"].item() == pytest.approx(2)


def test_the_answer_names_the_worst_of_each_engine_and_the_verdict(compared, answer):
    found = [compared(**FAR | {"lattice": 0.029}), compared("soft", **FAR | {"dem": 0.08})]
    lines = answer(found).splitlines()
    scores = engine_scores(found)
    assert lines[1].split()[0] == "engine" and len(lines) < 10
    for engine, line in zip(scores, lines[2:], strict=False):
        assert line.startswith(label_of(engine)) and scores[engine].verdict.word in line
    assert " ".join(lines[2].split()) == (
        "rigid blocks soft 8.00 stress at 20 m 8, ≤ 8 jointed bar, exact modelling error – "
        "△ differs 0.02"
    )
    assert "jointed bar, exact (deformable rock with every joint, exact)" in lines[5]
    assert lines[-1].endswith("--all; as JSON: --json") and "its reason" not in " ".join(lines)


def test_the_answer_names_what_is_not_checked_and_exceeds_its_bound(compared, answer):
    found = [compared(f"v{i}", {"dem ~ continuum-jointed": 1e-3}, **FAR) for i in range(2)]
    del found[1].results["jointed-bar"]
    said = answer(found)
    assert "exceeds the scene's bound: dem ~ continuum-jointed" in said
    assert "not checked independently: jointed rock (v1)" in said


def test_curves_are_data_over_model(compared, answer, tmp_path):
    """A measured curve that is half as large again."""
    one, file = compared(**FAR), tmp_path / "gauge.csv"
    time = one.results["dem"].time.values
    np.savetxt(file, np.column_stack([time, 1.5 * WAVE]), delimiter=",")
    (curves,) = read_curves([f"{file}:stress@20"], [one.scene])
    one.besides.append(AlignedCurve(curves, None, time, True, 0.0))
    one.rows += measure_curves(one.besides[0], one.results)
    ratio = f"{1.5 / 1.03:.4g}"
    (line,) = (x for x in answer([one]).splitlines() if "gauge.csv ~ rigid blocks  " in x)
    assert line.split()[-2:] == ["45.6", ratio]
    said = answer([one], every=True)
    assert "given curves" in said and ratio in said


def test_everything_is_there_on_request_and_in_json(compared, answer):
    one = compared(expect={"dem ~ continuum-jointed": 1e-3}, **FAR)
    said = answer([one], every=True)
    assert re.search("series +all +its reason", said) and "dem ~ continuum-jointed" in said
    (facts,) = json.loads(answer([one], as_json=True))
    assert facts["does_not_apply"] == one.reasons and facts["warnings"] == ["a slip"]
    assert len(facts["rows"]) == len(one.rows) > 3
    dem = facts["engines"]["dem"]
    assert dem["misfit"] == pytest.approx(0.03) and dem["at"] == "stress at 20 m"
    assert dem["against"] == "jointed-bar" and dem["seconds_stepping"] == 0.02
    assert dem["verdict"] == "out of bounds" and dem["out_of_bounds"] == list(one.scene.expect)
    assert facts["engines"]["continuum-equivalent"]["verdict"] == "far off"


def scene_of(seconds, against="jointed-bar", kind="pillar", **total):
    """Return a solved scene with the seconds and the misfit of each engine."""
    variants = (VariantScore("", Worst(nan), Worst(x), against, "", ()) for x in total.values())
    engines = [name.replace("_", "-") for name in total]
    scores = {name: EngineScore((one,)) for name, one in zip(engines, variants, strict=True)}
    scene, costs = SimpleNamespace(kind=kind), dict(zip(engines, seconds, strict=True))
    return SolvedScene(None, scene, costs, None, [], [], {}, {}, scores, None, {})


def test_costs_are_ratios_to_the_cheapest_of_each_scene():
    scenes = [
        scene_of([2e-3, 3e-2], dem=0.04, continuum_jointed=1e-6),
        scene_of([4e-3, 2e-3], dem=0.002, continuum_jointed=0.0),
        scene_of([1e-3], dem=0.01),
    ]
    said = lead(scenes)
    assert list(said) == ["dem", "continuum-jointed"]
    assert [[*one.costs.values()] for one in scenes] == [[1, pytest.approx(15)], [2, 1], [1]]
    assert said["dem"] == (
        "Rigid blocks are within 4.0 % of the exact jointed bar; 1.0× to 2.0× the time of the "
        "cheapest."
    )
    assert "within 0.001 % of the exact jointed bar" in said["continuum-jointed"]


@pytest.mark.parametrize(
    ("scenes", "words"),
    [
        (
            [scene_of([2e-3], dem=0.04), scene_of([3.14], dem=0.04)],
            "the cheapest: 2 ms to 3.1 s a run.",
        ),
        (
            [scene_of([1.0], dem=0.04), scene_of([1.0], kind="rock mass", dem=0.28)],
            "Rigid blocks are within 4.0 % of the exact jointed bar for the pillar and up to 28 % "
            "from the exact jointed bar for the rock mass",
        ),
        ([scene_of([1.0], "lattice", dem=nan)], NOT_CHECKED.word),
    ],
)
def test_an_engine_has_its_distance_for_each_kind_of_scenes(scenes, words):
    assert words in lead(scenes)["dem"]


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        *((7200.0, "2 h"), (90.0, "1.5 min"), (12.3, "12 s"), (1.234, "1.2 s")),
        *((0.0123, "12 ms"), (4.5e-5, "45 µs")),
    ],
)
def test_seconds_are_written_in_the_unit_that_suits_them(seconds, text):
    assert in_seconds(seconds) == text


def test_large_differences_of_peaks_are_no_powers_of_ten():
    assert mean_and_worst(SimpleNamespace(mean=0.1234, worst=7.2)) == "12, ≤ 720"
    assert mean_and_worst(None) == ""
