"""The full study that plans are held against: it leaves out only what costs more."""

from math import isnan
from pathlib import Path

import pytest

from compare.experiments.planner import families
from compare.experiments.planner.reference import References

TOOLS = Path(__file__).parents[1] / "tools" / "plan"
SHORT = {"pillar__length": 10.0, "time__duration": 0.03, "record__stress": [4.0]}
MISFITS = [0.01, 0.001]


@pytest.fixture
def tools(modules_of, monkeypatch):
    """Return a function that imports one module of tools/plan; two families make its study."""
    module = modules_of(TOOLS)
    all_of = families.families_of
    monkeypatch.setattr(module("full_study"), "families_of", lambda scene: all_of(scene)[:4])
    return module


@pytest.fixture
def scene(pillar):
    return pillar(**SHORT, joints__damping_ratio=0.02)


def test_each_family_ends_where_it_meets_all_or_is_too_dear(tools, scene):
    """Points are two to a doubling; what meets every misfit is followed by one finer point."""
    full = tools("full_study")
    study = full.Study(scene, References(scene, min(MISFITS)), MISFITS)
    by_family = {}
    for point in study.points:
        by_family.setdefault(point.family.label, []).append(point)
    for points in by_family.values():
        assert all(point.misfit > min(MISFITS) for point in points[:-2])
    assert any("fourth" in label for label in study.skipped)
    for misfit in MISFITS:
        best = study.best(misfit)
        assert all(point.misfit <= misfit for point in best)
        assert best == sorted(best, key=lambda point: point.seconds)


def test_a_plan_that_is_the_studys_best_costs_as_much(tools, scene):
    """Equal configurations are one run, timed once in every round."""
    for row in tools("full_study").rows_of(scene, [0.01], 3):
        assert row["met"] and row["ratio"] > 0
        if row["chosen"] == row["best"]:
            assert row["ratio"] == 1


def test_a_scene_that_cannot_be_planned_is_a_miss_with_its_reason(tools, scene, monkeypatch):
    from compare.experiments.planner import reference

    monkeypatch.setattr(reference, "LEVELS", 1)
    local = scene.model_copy(update={"damping": scene.damping.model_copy(update={"local": 0.5})})
    (row,) = tools("full_study").rows_of(local, [0.01], 3)
    assert not row["met"] and isnan(row["ratio"]) and "no exact solution" in row["message"]
    table = tools("table")
    assert "missed" in table.line({"scene": "x", **row})
    assert "met in 0 of 1 scenes" in table.sentence([{"scene": "x", **row}], 0.01)
