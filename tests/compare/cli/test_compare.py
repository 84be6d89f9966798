"""The output of `jointwave compare`: a line for each engine, and all facts on request."""

import json
import re

import numpy as np
import pytest
import xarray as xr

from jointwave.compare.cli.compare import show_comparisons
from jointwave.compare.engines import label_of
from jointwave.compare.misfit.alignment import AlignedCurve
from jointwave.compare.misfit.pairs import Comparison, measure, measure_curves
from jointwave.compare.report.verdict import engine_scores


@pytest.fixture
def compared(pillar):
    """Return a function that gives a comparison: by name how far each result is from one wave."""

    def make(name="", expect=None, **far):
        wave = np.sin(np.linspace(0, 9, 200))[None]
        results = {
            one.replace("_", "-"): xr.Dataset(
                {"stress": (("stress_y", "time"), (1 + x) * wave)},
                {"stress_y": [20.0], "time": 1e-3 * np.arange(200.0)},
                ABOUT,
            )
            for one, x in far.items()
        }
        scene = pillar().model_copy(update={"expect": expect or {}, "name": name})
        reasons = {"series": "its reason"}
        return Comparison(scene, results, reasons, measure(results))

    return make


ABOUT = {"seconds_stepping": 0.02, "warnings": '["a slip"]', "steps": 100}
ABOUT |= {"degrees_of_freedom": 1, "dt": 1e-3, "critical_dt": 2e-3}
FAR = {"dem": 0.03, "continuum_jointed": 1e-4, "continuum_equivalent": 0.3, "jointed_bar": 0.0}


def test_the_answer_names_the_worst_of_each_engine_and_the_verdict_of_the_page(compared, capsys):
    found = [compared(**FAR | {"lattice": 0.029}), compared("soft", **FAR | {"dem": 0.08})]
    show_comparisons(found, False, False)
    lines = capsys.readouterr().out.splitlines()
    stand = engine_scores(found)
    assert lines[1].split()[0] == "engine" and len(lines) < 10
    for engine, line in zip(stand, lines[2:], strict=False):
        assert line.startswith(label_of(engine)) and stand[engine].verdict.word in line
    dem = " ".join(lines[2].split())
    assert dem == (
        "rigid blocks soft 8.00 stress at 20 m 8, ≤ 8 jointed bar, exact modelling error – "
        "△ differs 0.02"
    )
    assert "jointed bar, exact (deformable rock with every joint, exact)" in lines[5]
    assert lines[-1].endswith("--all; as JSON: --json") and "its reason" not in " ".join(lines)


def test_the_answer_names_what_is_not_checked_and_exceeds_its_bound(compared, capsys):
    found = [compared(f"v{i}", {"dem ~ continuum-jointed": 1e-3}, **FAR) for i in range(2)]
    del found[1].results["jointed-bar"]
    show_comparisons(found, False, False)
    said = capsys.readouterr().out
    assert "exceeds the scene's bound: dem ~ continuum-jointed" in said
    assert "not checked independently: jointed rock (v1)" in said


@pytest.fixture
def curve(tmp_path):
    """Return a function that puts a measured curve, half as large again, beside a comparison."""
    from jointwave.compare.misfit.external import read_curves

    def add(comparison, factor=1.5):
        time = comparison.results["dem"].time.values
        file = tmp_path / "gauge.csv"
        wave = factor * np.sin(np.linspace(0, 9, 200))
        np.savetxt(file, np.column_stack([time, wave]), delimiter=",")
        (curves,) = read_curves([f"{file}:stress@20"], [comparison.scene])
        beside = AlignedCurve(curves, None, time, True, 0.0)
        comparison.besides.append(beside)
        comparison.rows += measure_curves(beside, comparison.results)

    return add


def test_curves_are_data_over_model(compared, curve, capsys):
    one = compared(**FAR)
    curve(one)
    show_comparisons([one], False, False)
    said = capsys.readouterr().out
    ratio = f"{1.5 / 1.03:.4g}"
    (line,) = (line for line in said.splitlines() if "gauge.csv ~ rigid blocks  " in line)
    assert line.split()[-2:] == ["45.6", ratio]
    show_comparisons([one], True, False)
    said = capsys.readouterr().out
    assert "given curves" in said and f"{1.5 / 1.03:.4g}" in said


def test_everything_is_there_on_request_and_in_json(compared, capsys):
    one = compared(expect={"dem ~ continuum-jointed": 1e-3}, **FAR)
    show_comparisons([one], True, False)
    said = capsys.readouterr().out
    assert re.search("series +all +its reason", said) and "dem ~ continuum-jointed" in said
    show_comparisons([one], False, True)
    (facts,) = json.loads(capsys.readouterr().out)
    assert facts["does_not_apply"] == one.reasons and facts["warnings"] == ["a slip"]
    assert len(facts["rows"]) == len(one.rows) > 3
    dem = facts["engines"]["dem"]
    assert dem["misfit"] == pytest.approx(0.03) and dem["at"] == "stress at 20 m"
    assert dem["against"] == "jointed-bar" and dem["seconds_stepping"] == 0.02
    assert dem["verdict"] == "out of bounds" and dem["out_of_bounds"] == list(one.scene.expect)
    assert facts["engines"]["continuum-equivalent"]["verdict"] == "far off"
