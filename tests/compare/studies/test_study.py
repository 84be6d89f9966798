"""Files of studies, the command, and its output files."""

import json
import subprocess
import sys

import pandas as pd
import pytest
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.compare.studies.findings import judged
from jointwave.compare.studies.study import load
from jointwave.compare.studies.work_precision import COSTS, draw, experiment

GOOD = """
title = "two steps"
scene = "guo-li-2002/fig-03"
changes = { "pillar.length" = 5.0, "record.stress" = [2.0], "time.duration" = 0.01 }
finest = "lattice"

[[curves]]
label = "blocks"
method = "dem"
own = "lattice"
vary = { "numerics.dem.step_fraction" = [0.1, 0.05] }
order = 2
"""
MANY = [*range(1, 200)]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("order = 2", 'order = "two"', "curves.0.order = 'two'"),
        ("order = 2", "oder = 2", "curves.0.oder"),
        ("[0.1, 0.05]", "[]", "step_fraction: list should have at least 1 item"),
        ("[0.1, 0.05]", "[" * 3000, "not valid TOML"),
        ('method = "dem"', 'method = "den"', "curves.0.method = 'den'"),
        ('finest = "lattice"', 'finest = "truth"', "finest = 'truth'"),
        ("[0.1, 0.05]", "[2026-01-01]", "dates are no values"),
        ("[0.1, 0.05]", "[0x" + "f" * 9999 + "]", "4300 digits"),
        ("vary = {", f"vary = {{ 'load.period' = {MANY}, 'pillar.side' = {MANY},", "at most 10000"),
    ],
)
def test_a_mistake_in_a_study_is_one_line(tmp_path, old, new, words):
    path = tmp_path / "study.toml"
    path.write_text(GOOD.replace(old, new, 1))
    with pytest.raises(SceneError, match=words) as error:
        load(str(path))
    assert "\n" not in str(error.value)


def test_a_curve_for_each_value_is_one_as_written_out(study):
    one = {"label": "order {order}", "method": "continuum-jointed", "changes": {"a": 1}}
    found = study([{**one, "each": {"numerics.continuum.order": [2, 3]}}])
    assert [curve.label for curve in found.curves] == ["order 2", "order 3"]
    assert found.curves[1].changes == {"a": 1, "numerics.continuum.order": 3}
    assert not any(curve.each for curve in found.curves)
    with pytest.raises(ValueError, match=r"give 1e\+06 points, at most 10000"):
        study([{**one, "each": {"a": list(range(1000)), "b": list(range(1000))}}])


def test_a_study_that_is_not_there_names_those_that_are(command):
    said = command("study", "no-such", code=2).err
    assert said.startswith("jointwave: no-such: is not a file, nor one of column-3d")
    assert "oblique-joint" in said


def test_command_writes_what_it_prints_and_two_ranks_the_same(command, tmp_path, mpiexec):
    (mine := tmp_path / "mine.toml").write_text(GOOD)
    facts = json.loads(command("study", mine, "--out", "out", "--workers", 1, "--json").out)
    table, data = pd.read_csv(tmp_path / "out/mine.csv"), xr.load_dataset(tmp_path / "out/mine.nc")
    assert [r["numerical"] for r in facts["rows"]] == pytest.approx(list(table.numerical), rel=1e-8)
    assert list(data.numerical.values) == pytest.approx(list(table.numerical), rel=1e-8)
    assert data.attrs["processor"] and json.loads(data.attrs["study"])["title"] == "two steps"
    assert facts["orders"][0]["measured"] == pytest.approx(2, abs=0.1)
    launcher, env = mpiexec
    study = ("study", mine, "--out", tmp_path / "two", "--json")
    two = [*launcher, "-n", "2", sys.executable, "-m", "jointwave", *map(str, study)]
    done = subprocess.run(two, capture_output=True, text=True, env=env)
    assert done.returncode == 0, done.stderr
    keys = ("numerical", "total", "steps", "work")
    both = [facts["rows"], json.loads(done.stdout)["rows"]]
    one, two = ([[row[key] for key in keys] for row in rows] for rows in both)
    assert one == two


def test_a_point_is_measured_anew_where_its_scene_has_changed(study, pillar, tmp_path, in_toml):
    """The file that a study names, also in a key that all of its points set: the reference has it
    as the file says."""
    file, found = tmp_path / "mine.toml", []
    curve = {"label": "stronger", "method": "dem", "changes": {"load.amplitude": 2e6}}
    one = study([curve], scene=str(file), finest="lattice")
    for amplitude in (1e6, 1e6, 1.6e6):
        load = {"load": {"shape": "sine", "period": 0.01, "amplitude": amplitude}}
        tables = pillar().model_dump(exclude_none=True, include={"title", "pillar", "rock", "time"})
        file.write_text(in_toml(tables | load | {"record": {"stress": [2.0]}}))
        again = one.model_copy(update={"changes": {"pillar.length": 5.0, "time.duration": 0.01}})
        (row,) = experiment(again, tmp_path / "points").rows()
        found.append(row["modelling"])
    assert found == pytest.approx([1.0, 1.0, 0.25], rel=1e-9)
    assert len(list((tmp_path / "points").iterdir())) == 2


def test_every_point_is_drawn_where_it_was_measured(study, tmp_path):
    timed = study(timed=True, repeats=1, finest="jointed-bar")
    table = judged(experiment(timed, tmp_path).rows())
    figure = draw("wp", table, COSTS)
    lines = {line.get_gid(): line for ax in figure.axes for line in ax.lines}
    for i, error in enumerate(("numerical", "total")):
        for j, cost in enumerate(("seconds", "work")):
            shown = lines[f"wp-{i}-{j}-0"].get_xydata()
            assert (shown == table[[cost, error]].to_numpy()).all()
    assert all(ax.get_xscale() == ax.get_yscale() == "log" for ax in figure.axes)


def test_points_whose_errors_cancel_are_crossed_where_they_measure():
    """And curves of one model have one colour, with markers of their own."""
    about = {"settings": {}, "state": "done", "message": "", "numerical": 0.01, "modelling": 0.02}
    about |= {"total": 0.03, "steps": 1.0, "freedoms": 1.0, "work": 1.0, "total_floor": 0.0}
    points = (("a", 0.03), ("b", 0.005))
    rows = [about | {"curve": name, "method": "dem", "measured": far} for name, far in points]
    (_, total) = draw("wp", judged(rows), {"work": "work"}).axes
    (crosses,) = [line for line in total.lines if line.get_marker() == "x"]
    assert list(crosses.get_ydata()) == [0.005]
    one, other = total.lines[:2]
    assert one.get_color() == other.get_color() and one.get_marker() != other.get_marker()
