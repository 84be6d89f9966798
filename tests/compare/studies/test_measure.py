"""A point measured: its references, its errors, and points that fail; the running of all points."""

import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from jointwave.compare.engines import applies, solve
from jointwave.compare.misfit.metrics import misfit, pairings
from jointwave.compare.studies.findings import judged, sentences
from jointwave.compare.studies.measure import finest_of, measure, own_of
from jointwave.compare.studies.store import alone
from jointwave.compare.studies.study import FineRun, load, shipped
from jointwave.compare.studies.work_precision import experiment, key

STEP = "numerics.dem.step_fraction"
FINE = {"method": "dem", "changes": {STEP: 0.01}, "coarser": {STEP: 0.02}}


def measured(study, number=0):
    return SimpleNamespace(**measure(study.points()[number]))


def test_the_floor_is_how_far_the_coarser_run_is_from_the_finer(study):
    """And bounds the finer run's own error: leapfrog of second order, it is a third of that. Errors
    from it are nearly those from the exact solution, exact to its round-off."""
    blocks = {"label": "blocks", "method": "dem", "own": "finest", "vary": {STEP: [0.4]}}
    asked = study([blocks], finest=FINE, timed=True, repeats=1)
    row, exact_row = measured(asked), measured(study())
    runs = [solve("dem", asked.changed({STEP: f})) for f in (0.01, 0.02, 0.4)]
    exact = solve("lattice", asked.changed({}))
    assert row.total_floor == row.numerical_floor == misfit(runs[1], runs[0])
    assert row.measured == row.numerical == misfit(runs[2], runs[0]) and row.modelling == 0
    assert row.total == row.numerical + row.numerical_floor
    assert misfit(runs[0], exact) < row.total_floor < 4 * misfit(runs[0], exact)
    assert row.numerical == pytest.approx(exact_row.numerical, rel=0.02)
    assert 0 < exact_row.numerical_floor < 1e-11
    said = " ".join(sentences(asked, judged([vars(row)])))
    assert "The finest physics is a fine run of dem; a coarser one is 0.0" in said


def test_errors_are_measured_by_the_one_ranking(study):
    """Where the file is silent: own model and finest physics, of what applies to the scene."""
    asked = study([{"label": "a", "method": name} for name in ("dem", "series")])
    assert finest_of(asked) == "jointed-bar" and finest_of(study(finest="none")) is None
    assert [own_of(point) for point in asked.points()] == ["lattice", "images"]
    soft = study(changes=study().changes | {"joints.tension": False})
    assert finest_of(soft) is None  # jointed rock, of which no exact solution holds


def test_modelling_error_is_that_of_the_own_model_whatever_the_step(study):
    asked = study(finest="jointed-bar")
    rows = [measured(asked, number) for number in (0, 1)]
    lattice, rock = (solve(name, asked.changed({})) for name in ("lattice", "jointed-bar"))
    assert [row.modelling for row in rows] == [misfit(lattice, rock)] * 2
    for row in rows:
        assert row.total == row.numerical + row.modelling + row.total_floor
        assert row.numerical_floor < row.total_floor < 1e-4  # bars have an error of 1e-8 inside
    assert rows[0].measured == misfit(solve("dem", asked.points()[0].scene), rock)


def test_an_error_is_that_of_the_waveform_furthest_off_or_of_one_quantity_in_space(study):
    """Receivers are pooled only where a study asks for the norm that orders are of in theory."""
    places = study().changes | {"record.stress": [0.5, 2.0], "record.velocity": [1.0, 5.0]}
    asked = study(changes=places)
    pairs = pairings(solve("dem", asked.points()[0].scene), solve("lattice", asked.changed({})))
    assert measured(asked).numerical == max(p.misfit for p in pairs)
    of = [p for p in pairs if p.place.quantity == "velocity"]
    off = sum(np.sum((p.one - p.other) ** 2) for p in of)
    size = sum(np.sum(p.other**2) for p in of)
    row = measured(study(changes=places, quantity="velocity"))
    assert len(of) == 2 and row.numerical == pytest.approx(np.sqrt(off / size))


@pytest.mark.parametrize("name", shipped())
def test_every_point_of_shipped_studies_can_be_run(name):
    study, held = load(name), set()
    for point in study.points():
        answer = applies(point.curve.method, point.scene)
        assert answer, (point.settings, answer.reason)
        own, finest = own_of(point), finest_of(study)
        assert own is not None
        for against, physics in ((own, point.physics), (finest, {})):
            if against is None or (key := repr((against, physics))) in held:
                continue
            held.add(key)
            name, runs = against, [{}]
            if isinstance(against, FineRun):
                name, runs = against.method, [against.changes, against.changes | against.coarser]
            assert all(applies(name, study.changed(physics | changes)) for changes in runs)


def test_another_scene_curve_or_setting_is_another_point(study):
    points = [*study().points(), *study(changes={}).points(), *study(repeats=4).points()]
    assert len({key(point) for point in points}) == len(points)
    assert key(study(title="another").points()[0]) == key(points[0])


def test_points_that_cannot_be_run_say_why(study, tmp_path):
    """Above the critical step, and where the exact solution does not hold: rows, not crashes."""
    vary = {STEP: [0.1, 1.5]}
    curve = {"label": "blocks", "method": "dem", "own": "lattice", "vary": vary}
    none = {"label": "series", "method": "series"}
    good, unstable, wrong = experiment(study([curve, none]), tmp_path).rows()
    assert [one["state"] for one in (good, unstable, wrong)] == ["done", "failed", "failed"]
    assert "step_fraction" in unstable["message"] and "not a sine" in wrong["message"]
    assert good["numerical"] < 0.01 and "numerical" not in unstable


def test_timed_points_are_run_one_at_a_time_whatever_the_pool(study, tmp_path):
    """A pool that cannot be made is not asked for; a second timed study waits for the first,
    and says so once."""
    timed = experiment(study(timed=True, repeats=2), tmp_path)
    rows = timed.rows(lambda work, points: 1 / 0)
    assert all(row["seconds"] > 0 and row["spread"] >= 0 for row in rows)
    program = "import logging; logging.basicConfig(level='INFO')\n"
    program += "from jointwave.compare.studies.store import alone\nwith alone(): print('in')"
    with alone():
        both = dict.fromkeys(("stdout", "stderr"), subprocess.PIPE)
        waiting = subprocess.Popen([sys.executable, "-c", program], text=True, **both)
        with pytest.raises(subprocess.TimeoutExpired):
            waiting.communicate(timeout=3)
    said, told = waiting.communicate(timeout=600)
    assert said == "in\n" and told.count("waiting for another process, which times runs") == 1
