"""Verdicts on engines, from synthetic results with known distances."""

from math import nan
from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from jointwave.compare.misfit.metrics import Worst
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.report.overview import lead
from jointwave.compare.report.scenes import SolvedScene
from jointwave.compare.report.verdict import (
    NOT_CHECKED,
    EngineScore,
    VariantScore,
    engine_scores,
)
from jointwave.compare.text import in_seconds


@pytest.fixture
def compared(pillar):
    """Return a function that gives a comparison: by name how far each result is from one wave."""

    def make(expect=None, **far):
        wave = np.sin(np.linspace(0, 9, 200))[None]
        results = {
            name.replace("_", "-"): xr.Dataset(
                {"stress": (("stress_y", "time"), (1 + x) * wave)},
                {"stress_y": [20.0], "time": np.arange(200.0)},
            )
            for name, x in far.items()
        }
        return Comparison(pillar().model_copy(update={"expect": expect or {}}), results)

    return make


def test_an_engine_is_held_to_its_own_model_and_to_the_finest(compared):
    found = engine_scores(
        [compared(dem=0.03, lattice=0.029, continuum_jointed=1e-4, jointed_bar=0.0)]
    )
    assert found["dem"].total.judged == pytest.approx(0.03)
    assert found["dem"].variants[0].own.judged == pytest.approx(0.001 / 1.029)
    assert found["dem"].variants[0].against == "jointed-bar"
    assert found["dem"].verdict.word == "close"
    assert found["continuum-jointed"].verdict.word == "agrees"
    assert "continuum-equivalent" not in found


def test_the_largest_misfit_of_the_variants_counts(compared):
    found = engine_scores([compared(dem=x, jointed_bar=0.0) for x in (0.3, 0.01, 0.06)])
    assert found["dem"].total.judged == pytest.approx(0.3)
    assert found["dem"].verdict.word == "far off"
    assert np.isnan(found["dem"].variants[0].own.judged)


def test_without_an_exact_solution_the_resolved_joints_are_the_finest(compared):
    found = engine_scores([compared(dem=0.1, continuum_jointed=0.0, lattice=0.1)])
    assert found["dem"].variants[0].against == "continuum-jointed"
    assert found["dem"].verdict.word == "differs"
    jointed = found["continuum-jointed"]
    assert jointed.variants[0].against == "" and np.isnan(jointed.total.judged)
    assert found["continuum-jointed"].verdict == NOT_CHECKED


def test_one_variant_that_nothing_checks_takes_the_tick_from_all(compared):
    checked = compared(continuum_jointed=1e-4, jointed_bar=0.0)
    alone = compared(continuum_jointed=0.0, dem=0.1)
    found = engine_scores([checked, alone])["continuum-jointed"]
    assert [one.verdict.word for one in found.variants] == ["agrees", NOT_CHECKED.word]
    assert found.verdict == NOT_CHECKED and len(found.unchecked) == 1
    worse = compared(continuum_jointed=0.5, jointed_bar=0.0)
    assert engine_scores([worse, alone])["continuum-jointed"].verdict.word == "far off"


def test_what_is_below_ten_times_the_error_of_the_reference_is_no_agreement(compared):
    comparison = compared(dem=1e-4, jointed_bar=0.0)
    bar = comparison.results["jointed-bar"]
    rms = float(np.sqrt((bar.stress**2).mean()))
    bar["stress_error"] = ("stress_y", [3e-3 * rms])
    found = engine_scores([comparison])["dem"]
    assert found.total.judged == pytest.approx(0.03) and found.verdict.word == "close"


def test_of_a_reference_that_stands_still_nothing_is_known(compared):
    found = engine_scores([compared(dem=0.1, spatial_lattice=-1.0)])
    assert np.isnan(found["dem"].total.judged) and found["dem"].verdict == NOT_CHECKED


def test_a_bound_of_the_scene_that_is_not_met_outdoes_every_misfit(compared):
    """A pair that was not run breaks none; a quantity that was not recorded does."""
    expect = {"dem ~ jointed-bar": 1e-4, "dem ~ lattice": 1.0, "dem ~ images": 1e-9}
    expect |= {"dem ~ lattice: peak stress": 1e-4, "dem ~ lattice: velocity": 1.0}
    found = engine_scores([compared(expect, dem=0.002, jointed_bar=0.0, lattice=0.0)])
    broken = ["dem ~ jointed-bar", "dem ~ lattice: peak stress", "dem ~ lattice: velocity"]
    assert found["dem"].broken == broken
    assert found["dem"].verdict.sign == "✗" and found["dem"].verdict.word == "out of bounds"


def scored(total, against):
    one = VariantScore("", Worst(nan), Worst(total), against, "", ())
    return EngineScore((one,))


def ranked(seconds, **total):
    found = {engine.replace("_", "-"): scored(x, "jointed-bar") for engine, x in total.items()}
    return solved(found, dict(zip(found, seconds, strict=True)))


def solved(scores, seconds, kind="pillar"):
    scene = SimpleNamespace(kind=kind)
    return SolvedScene(None, scene, seconds, None, [], [], {}, {}, scores, None, {})


def test_costs_are_ratios_to_the_cheapest_of_each_scene():
    scenes = [
        ranked([2e-3, 3e-2], dem=0.04, continuum_jointed=1e-6),
        ranked([4e-3, 2e-3], dem=0.002, continuum_jointed=0.0),
        ranked([1e-3], dem=0.01),
    ]
    said = lead(scenes)
    assert list(said) == ["dem", "continuum-jointed"]
    assert [[*one.costs.values()] for one in scenes] == [[1, pytest.approx(15)], [2, 1], [1]]
    assert said["dem"] == (
        "Rigid blocks are within 4.0 % of the exact jointed bar; 1.0× to 2.0× the time of the "
        "cheapest."
    )
    assert "within 0.001 % of the exact jointed bar" in said["continuum-jointed"]


def test_the_cheapest_everywhere_says_its_seconds():
    said = lead([ranked([2e-3], dem=0.04), ranked([3.14], dem=0.04)])
    assert said["dem"].endswith("the cheapest: 2 ms to 3.1 s a run.")


def test_pillars_and_rock_masses_have_each_their_own_distance():
    near, far = ({"dem": scored(x, "jointed-bar")} for x in (0.04, 0.28))
    said = lead([solved(near, {"dem": 1.0}), solved(far, {"dem": 1.0}, "rock mass")])
    assert said["dem"].startswith(
        "Rigid blocks are within 4.0 % of the exact jointed bar for the pillar and up to 28 % from "
        "the exact jointed bar for the rock mass"
    )


def test_an_engine_without_a_distance_is_not_given_one():
    there = {"dem": scored(nan, "lattice"), "continuum-jointed": scored(nan, "")}
    said = lead([solved(there, dict.fromkeys(there, 1.0))])
    assert all(NOT_CHECKED.word in sentence for sentence in said.values())


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        *((7200.0, "2 h"), (90.0, "1.5 min"), (12.3, "12 s"), (1.234, "1.2 s")),
        *((0.0123, "12 ms"), (4.5e-5, "45 µs")),
    ],
)
def test_seconds_are_written_in_the_unit_that_suits_them(seconds, text):
    assert in_seconds(seconds) == text
