"""Running studies: resuming, timing one at a time, failures."""

import json
import subprocess
import sys

import pytest

from compare.experiments.study import measure, summary
from compare.experiments.study.summary import run
from compare.studies.store import alone

TIMED = ("seconds", "spread", "setup", "compile")


def counted(rows):
    """Return the columns that are equal in every run of a study."""
    found = [{k: v for k, v in row._asdict().items() if k not in TIMED} for row in rows]
    return json.dumps(found)


def test_an_interrupted_study_ends_with_the_same_table(study, tmp_path, monkeypatch):
    """Completed points are kept, including seconds; only the rest is run, to the same counts."""
    whole, calls = run(study(), tmp_path / "whole"), []

    def until_third(point):
        if len(calls) == 2:
            raise KeyboardInterrupt
        calls.append(point.settings)
        return measure.measure(point)

    monkeypatch.setattr(summary, "measure", until_third)
    with pytest.raises(KeyboardInterrupt):
        run(study(), tmp_path / "resumed")
    kept = {p.name: p.read_text() for p in (tmp_path / "resumed").iterdir()}
    assert len(kept) == 2
    monkeypatch.setattr(
        summary, "measure", lambda p: calls.append(p.settings) or measure.measure(p)
    )
    assert counted(run(study(), tmp_path / "resumed")) == counted(whole)
    assert len(calls) == len(whole) == 4
    assert all((tmp_path / "resumed" / name).read_text() == text for name, text in kept.items())


def test_another_scene_curve_or_setting_is_another_point(study, tmp_path):
    """Kept points are taken only where everything that decides them is the same."""
    points = [*study().points(), *study(changes={}).points(), *study(repeats=4).points()]
    assert len({summary.key(point) for point in points}) == len(points)
    assert summary.key(study(title="another").points()[0]) == summary.key(points[0])


def test_points_that_cannot_be_run_say_why(study, tmp_path):
    """Above the critical step, and where the exact solution does not hold: rows, not crashes."""
    vary = {"numerics.dem.step_fraction": [0.1, 1.5]}
    curve = {"label": "blocks", "method": "dem", "own": "lattice", "vary": vary}
    none = {"label": "series", "method": "series"}
    good, unstable, wrong = run(study([curve, none]), tmp_path)
    assert (good.state, unstable.state, wrong.state) == ("done", "failed", "failed")
    assert "step_fraction" in unstable.message and "not a sine" in wrong.message
    assert good.numerical < 0.01 and unstable.numerical != unstable.numerical


def test_timed_points_are_run_one_at_a_time_whatever_the_pool(study, tmp_path):
    """A pool that cannot be made is not asked for."""
    rows = run(study(timed=True, repeats=2), tmp_path, pool=lambda: 1 / 0)
    assert all(row.seconds > 0 and row.spread >= 0 for row in rows)


def test_two_timed_studies_do_not_run_at_once(study, tmp_path):
    """The second waits for the lock of the first."""
    program = "from compare.studies.store import alone\nwith alone(): print('in')"
    with alone():
        waiting = subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE)
        with pytest.raises(subprocess.TimeoutExpired):
            waiting.communicate(timeout=3)
    assert waiting.communicate(timeout=600)[0] == b"in\n"
