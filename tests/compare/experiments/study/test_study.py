"""Files of studies, the command, and its output files."""

import json
import subprocess
import sys

import pandas as pd
import pytest
import xarray as xr

from cases.errors import SceneError
from compare.experiments.study.methods import adaptive
from compare.experiments.study.reference import reference
from compare.experiments.study.study import load
from compare.misfit.metrics import misfit

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


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("scene =", "scen =", "scene"),
        ("order = 2", 'order = "two"', "curves.0.order = 'two'"),
        ("order = 2", "oder = 2", "curves.0.oder"),
        ("[0.1, 0.05]", "[]", "step_fraction = []"),
        ("title", "title = ", "not valid TOML"),
        ("[0.1, 0.05]", "[" * 3000, "not valid TOML"),
        ('method = "dem"', 'method = "den"', "curves[0].method = 'den'"),
        ('own = "lattice"', 'own = "truth"', "curves[0].own = 'truth'"),
        ('finest = "lattice"', 'finest = "truth"', "finest = 'truth'"),
        ("[0.1, 0.05]", "[2026-01-01]", "a number, a text, or true or false"),
        ("[0.1, 0.05]", "[0x" + "f" * 99 + "]", "at most 64 bits"),
        ("vary = {", "vary = { n_terms = [9],", "is an argument of series, kelvin-voigt"),
        (
            '"dem"\nown',
            '"series"\nchanges = { n_terms = 1.5 }\nown',
            "n_terms = 1.5: must be a whole",
        ),
        (
            "vary = {",
            f"vary = {{ 'load.period' = {[*range(1, 200)]}, 'pillar.side' = {[*range(1, 200)]},",
            "give 79202 points, at most 10000",
        ),
    ],
)
def test_a_mistake_in_a_study_is_one_line(tmp_path, old, new, words):
    path = tmp_path / "study.toml"
    path.write_text(GOOD.replace(old, new, 1))
    with pytest.raises(SceneError, match=words.replace("[", r"\[").replace("]", r"\]")):
        load(str(path))


def test_a_curve_for_each_value_is_one_as_written_out(study):
    """With the value in its label and its changes; the others of its keys stay."""
    one = {"label": "order {order}", "method": "continuum-jointed", "changes": {"a": 1}}
    found = study([{**one, "each": {"numerics.continuum.order": [2, 3]}}])
    assert [curve.label for curve in found.curves] == ["order 2", "order 3"]
    assert found.curves[1].changes == {"a": 1, "numerics.continuum.order": 3}
    assert not any(curve.each for curve in found.curves)
    with pytest.raises(ValueError, match=r"give 1e\+06 curves, at most 10000"):
        study([{**one, "each": {"a": list(range(1000)), "b": list(range(1000))}}])


def test_a_study_that_is_not_there_names_those_that_are(command):
    said = command("study", "no-such", code=2).err
    assert said.startswith("jointwave: no-such: is not a file, nor one of column-3d")
    assert "oblique-joint" in said


@pytest.fixture
def made(once, command):
    """Return the folder of a study run by the command, and its output; made once."""

    def make(folder):
        (mine := folder / "mine.toml").write_text(GOOD)
        done = command("study", mine, "--out", folder / "out", "--workers", 1, "--json")
        return folder, json.loads(done.out)

    return once("study-mine", make)


def test_command_writes_what_it_prints(made):
    folder, facts = made
    table = pd.read_csv(folder / "out" / "mine.csv")
    data = xr.load_dataset(folder / "out" / "mine.nc")
    assert [r["numerical"] for r in facts["rows"]] == pytest.approx(list(table.numerical), rel=1e-8)
    assert list(data.numerical.values) == pytest.approx(list(table.numerical), rel=1e-8)
    assert data.attrs["processor"] and json.loads(data.attrs["study"])["title"] == "two steps"
    assert facts["orders"][0]["measured"] == pytest.approx(2, abs=0.1)


def test_two_ranks_give_the_table_of_one_process(made, tmp_path, mpiexec):
    (folder, facts), (launcher, env) = made, mpiexec
    study = ("study", folder / "mine.toml", "--out", tmp_path, "--json")
    two = [*launcher, "-n", "2", sys.executable, "-m", "compare", *map(str, study)]
    done = subprocess.run(two, capture_output=True, text=True, env=env)
    assert done.returncode == 0, done.stderr
    ranks = json.loads(done.stdout)
    keys = ("numerical", "total", "steps", "work")
    one, two = ([[row[key] for key in keys] for row in f["rows"]] for f in (facts, ranks))
    assert one == two


@pytest.mark.parametrize("damping", [{}, {"joints__damping_ratio": 0.05}])
def test_adaptive_steps_reach_the_exact_chain_as_their_tolerance_shrinks(pillar, damping):
    """Some digits for every digit of the tolerance."""
    load = {"shape": "ricker", "amplitude": 1e6, "period": 0.01}
    scene = pillar(load=load, time__duration=0.03, **damping)
    exact = reference("lattice", scene).result
    coarse, fine = (misfit(adaptive.solve(scene, rtol), exact) for rtol in (1e-4, 1e-8))
    assert coarse < 1e-2 and fine < 1e-5 and fine < 1e-2 * coarse
