"""The store of experiments: each point computed once, on any executor, saved as soon as done."""

import os
from dataclasses import replace
from functools import partial
from math import isnan, nan

import pytest

from jointwave.cases.errors import SceneError
from jointwave.compare import studies
from jointwave.compare.studies.store import Store, in_processes, key


def square(number):
    """Return a row with a number that JSON does not have."""
    return {"number": number, "square": float(number**2), "root": nan}


def dies(number):
    if number == 2:
        os._exit(1)
    return square(number)


def saved(store):
    return sorted(int(path.stem) for path in store.folder.iterdir())


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path, str)


def test_points_are_computed_once_in_their_order(store, tmp_path, monkeypatch):
    """Also one requested twice; the second time all that still hold are read from files, including
    NaN. Without a folder nothing is saved."""
    calls, fractions = [], []

    def counted(number):
        calls.append(number)
        return square(number)

    first = store.compute([3, 1, 3], counted, progress=fractions.append)
    again = store.compute([1, 3], counted)
    assert calls == [3, 1] and fractions == [0.5, 1.0] and saved(store) == [1, 3]
    assert [one["square"] for one in first] == [9.0, 1.0, 9.0]
    assert [one["square"] for one in again] == [1.0, 9.0] and isnan(again[0]["root"])
    doubting = replace(store, is_valid=lambda row: row["number"] != 3)
    doubting.compute([1, 3], counted)
    assert calls == [3, 1, 3]
    monkeypatch.chdir(tmp_path)
    assert Store(None, str).compute([2], square)[0]["square"] == 4.0 and saved(store) == [1, 3]


def test_an_interrupted_experiment_has_saved_what_was_done(store):
    def until_two(number):
        if number == 2:
            raise KeyboardInterrupt
        return square(number)

    with pytest.raises(KeyboardInterrupt):
        store.compute(range(5), until_two)
    assert saved(store) == [0, 1]


def test_a_point_whose_process_dies_is_lost_and_stops_nobody(store):
    """It is not saved. Where a study has no result for it, that is an error."""
    pool = partial(in_processes, 2)
    losing = replace(store, lost=lambda number: {"number": number, "square": nan})
    found = losing.compute(range(5), dies, pool)
    assert [one["number"] for one in found] == list(range(5))
    assert [isnan(one["square"]) for one in found] == [n == 2 for n in range(5)]
    assert saved(store) == [0, 1, 3, 4]
    with pytest.raises(MemoryError, match="its process ended early"):
        store.compute([2], dies, pool)


def test_a_damaged_file_is_one_line_that_names_it(store):
    (store.folder / "1.json").write_text("[1]")
    with pytest.raises(SceneError, match=r"1\.json.*is damaged, remove it") as error:
        store.compute([1], square)
    assert "\n" not in str(error.value)


def test_keys_tell_all_that_decides_a_point_apart(monkeypatch):
    assert key("a", {"x": 1, "y": 2}) == key("a", {"y": 2, "x": 1}) != key("a", {"x": 1, "y": 3})
    before = key("a")
    monkeypatch.setattr(studies.store, "program", lambda: "another")
    assert key("a") != before
