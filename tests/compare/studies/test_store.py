"""The store of experiments: each point computed once, on any executor, saved as soon as done."""

import gc
import os
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from math import isnan, nan
from multiprocessing import get_context

import pytest

from jointwave.cases.errors import SceneError
from jointwave.compare import studies
from jointwave.compare.studies.store import Store, in_processes, key, on_executor


def square(number):
    """Return a row with a number that JSON does not have."""
    return {"number": number, "square": float(number**2), "root": nan}


def dies(number):
    if number == 2:
        os._exit(1)
    return square(number)


def kept(number):
    """Return how many objects a process no longer looks through for garbage."""
    return {"square": gc.get_freeze_count()}


def has(store, name):
    return (store.folder / f"{name}.json").is_file()


@pytest.fixture
def store(tmp_path):
    return Store(tmp_path, str)


def test_points_are_computed_once_in_their_order(store):
    """Also one requested twice; the second time all are read from files, including NaN."""
    calls, fractions = [], []

    def counted(number):
        calls.append(number)
        return square(number)

    first = store.compute([3, 1, 3], counted, progress=fractions.append)
    again = store.compute([1, 3], counted)
    assert calls == [3, 1] and fractions == [0.5, 1.0]
    assert [one["square"] for one in first] == [9.0, 1.0, 9.0]
    assert [one["square"] for one in again] == [1.0, 9.0] and isnan(again[0]["root"])
    assert has(store, "1") and not has(store, "2")


def test_workers_look_for_garbage_in_what_a_point_has_made_only():
    """Not again among all that earlier ones have left; this process is as it was."""
    here, points = gc.get_freeze_count(), {str(k): k for k in range(6)}
    found = [one["square"] for _, one in in_processes(2, kept, points)]
    assert sorted(found)[2] > 10_000 and gc.get_freeze_count() <= here


def test_processes_and_executors_give_what_one_process_gives(tmp_path):
    """In the order of the points, whichever is done first."""
    with ProcessPoolExecutor(2, get_context("spawn")) as executor:
        for pool in (partial(in_processes, 2), partial(on_executor, executor)):
            store = Store(tmp_path / str(id(pool)), str)
            found = store.compute(range(5), square, pool)
            assert [one["number"] for one in found] == list(range(5)) and has(store, "4")


def test_an_interrupted_experiment_has_saved_what_was_done(store):
    def until_two(number):
        if number == 2:
            raise KeyboardInterrupt
        return square(number)

    with pytest.raises(KeyboardInterrupt):
        store.compute(range(5), until_two)
    assert [has(store, str(n)) for n in range(5)] == [True, True, False, False, False]


def test_a_point_whose_process_dies_is_lost_and_stops_nobody(store):
    """It is not saved. Where a study has no result for it, that is an error."""
    pool = partial(in_processes, 2)
    losing = replace(store, lost=lambda number: {"number": number, "square": nan})
    found = losing.compute(range(8), dies, pool)
    assert [one["number"] for one in found] == list(range(8))
    assert [isnan(one["square"]) for one in found] == [n == 2 for n in range(8)]
    assert [has(store, str(n)) for n in range(8)] == [n != 2 for n in range(8)]
    with pytest.raises(MemoryError, match="its process ended early"):
        store.compute([2], dies, pool)


def test_a_result_that_no_longer_holds_is_computed_anew(tmp_path):
    Store(tmp_path, str).compute([1], lambda number: square(5))
    store = Store(tmp_path, str, lambda one: one["number"] == 1)
    assert store.compute([1], square)[0]["square"] == 1.0
    assert store.compute([1], dies)[0]["number"] == 1


def test_without_a_folder_nothing_is_saved(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    store = Store(None, str)
    assert store.compute([2], square)[0]["square"] == 4.0
    assert not list(tmp_path.iterdir())


def test_a_damaged_file_is_one_line_that_names_it(store):
    (store.folder / "1.json").write_text("[1]")
    with pytest.raises(SceneError, match=r"1\.json.*is damaged, remove it") as error:
        store.compute([1], square)
    assert "\n" not in str(error.value)


def test_keys_tell_all_that_decides_a_point_apart(monkeypatch):
    """The program too, but not the order of settings."""
    assert key("a", {"x": 1, "y": 2}) == key("a", {"y": 2, "x": 1})
    assert len({key("a", 1), key("a", 2), key("b", 1), key("a", [1])}) == 4
    before = key("a")
    monkeypatch.setattr(studies.store, "program", lambda: "another")
    assert key("a") != before
