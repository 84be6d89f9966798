"""The store of experiments: each point computed once, on any executor, saved as soon as done."""

import os
from dataclasses import replace
from functools import partial
from math import isnan, nan

import pytest

from jointwave.cases.errors import SceneError
from jointwave.compare import studies
from jointwave.compare.studies.experiment import Experiment
from jointwave.compare.studies.store import in_processes, key


def square(number):
    """Return a row with a number that JSON does not have."""
    return {"number": number, "square": float(number**2), "root": nan}


def dies(number):
    if number == 2:
        os._exit(1)
    return square(number)


def saved(folder):
    return sorted(int(path.stem) for path in folder.iterdir())


@pytest.fixture
def of(tmp_path):
    """Return a function that gives the study of some numbers, saved in a folder."""
    return lambda points, work=square: Experiment("", points, tmp_path, str, work, list)


def test_points_are_computed_once_in_their_order(of, tmp_path, monkeypatch):
    """Also one requested twice; the second time all that still hold are read from files, including
    NaN. Without a folder nothing is saved."""
    calls, fractions = [], []

    def counted(number):
        calls.append(number)
        return square(number)

    first = of([3, 1, 3], counted).rows(progress=fractions.append)
    again = of([1, 3], counted).rows()
    assert calls == [3, 1] and fractions == [0.5, 1.0] and saved(tmp_path) == [1, 3]
    assert [one["square"] for one in first] == [9.0, 1.0, 9.0]
    assert [one["square"] for one in again] == [1.0, 9.0] and isnan(again[0]["root"])
    replace(of([1, 3], counted), is_valid=lambda row: row["number"] != 3).rows()
    assert calls == [3, 1, 3]
    monkeypatch.chdir(tmp_path)
    assert replace(of([2]), folder=None).rows()[0]["square"] == 4.0 and saved(tmp_path) == [1, 3]


def test_an_interrupted_experiment_has_saved_what_was_done(of, tmp_path):
    def until_two(number):
        if number == 2:
            raise KeyboardInterrupt
        return square(number)

    with pytest.raises(KeyboardInterrupt):
        of(range(5), until_two).rows()
    assert saved(tmp_path) == [0, 1]


def test_a_point_whose_process_dies_is_lost_and_stops_nobody(of, tmp_path):
    """It is not saved. Where a study has no result for it, that is an error."""
    pool = partial(in_processes, 2)
    losing = replace(of(range(5), dies), lost=lambda number: {"number": number, "square": nan})
    found = losing.rows(pool)
    assert [one["number"] for one in found] == list(range(5))
    assert [isnan(one["square"]) for one in found] == [n == 2 for n in range(5)]
    assert saved(tmp_path) == [0, 1, 3, 4]
    with pytest.raises(MemoryError, match="its process ended early"):
        of([2]).rows(lambda work, points: ((name, None) for name in points))


def test_a_damaged_file_is_one_line_that_names_it(of, tmp_path):
    (tmp_path / "1.json").write_text("[1]")
    with pytest.raises(SceneError, match=r"1\.json.*is damaged, remove it") as error:
        of([1]).rows()
    assert "\n" not in str(error.value)


def test_keys_tell_all_that_decides_a_point_apart(monkeypatch):
    assert key("a", {"x": 1, "y": 2}) == key("a", {"y": 2, "x": 1}) != key("a", {"x": 1, "y": 3})
    before = key("a")
    monkeypatch.setattr(studies.store, "program", lambda: "another")
    assert key("a") != before
