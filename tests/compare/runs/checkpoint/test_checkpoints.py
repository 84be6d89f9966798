"""Checkpoints restore the saved arrays, or report in one line why they cannot; every engine shows
all that changes."""

import signal
from itertools import count

import numpy as np
import pytest

from jointwave.cases.errors import InterruptedRun, SceneError
from jointwave.compare.engines import solve
from jointwave.compare.runs.checkpoint.files import Checkpoints
from jointwave.compare.runs.checkpoint.resume import CheckpointSettings
from jointwave.compare.runs.checkpoint.signals import Signals
from jointwave.compare.runs.jobs import Job
from jointwave.compare.runs.processes import ALONE, Processes
from jointwave.compare.runs.run import execute
from jointwave.results.arrays import arrays, copied
from tests.compare.runs.checkpoint.commands import arguments

SIGNATURE = {"scene": "a", "engine": "dem", "number of processes": "1", "program": "1"}


class Share(Processes):
    """One of two processes, in a test that is all of them."""

    def __init__(self, rank):
        super().__init__()
        self.rank, self.size, self.is_first = rank, 2, rank == 0


@pytest.fixture
def parts():
    """Return a state such as an engine's: nested, with absent parts, of several types."""
    rng = np.random.default_rng(7)
    broken = np.array([True, False])
    return (rng.random((3, 2)), None, [np.arange(4, dtype=np.int32), broken], (np.zeros((0, 3)),))


@pytest.fixture
def files(tmp_path):
    return Checkpoints(tmp_path / "dem.nc", SIGNATURE, ALONE)


def emptied(parts):
    empty = copied(parts)
    for array in arrays(empty):
        array[...] = 0
    return empty


def restored(files, samples, parts):
    """Return the bytes of the arrays that come back, and of those that were saved."""
    files.load(samples, back := emptied(parts))
    return [[one.tobytes() for one in arrays(of)] for of in (back, parts)]


def test_parts_come_back_as_they_were(tmp_path, files, parts):
    """Every bit, of every kind; the older checkpoint is gone, and at the end all are. Those of
    other results in the folder are left alone."""
    assert files.newest() == 0
    files.save(5, emptied(parts))
    files.save(12, parts)
    (path,) = tmp_path.iterdir()
    assert path.name.startswith(".dem.checkpoint-") and files.newest() == 12
    back, saved = restored(files, 12, parts)
    assert back == saved
    others = Checkpoints(tmp_path / "continuum-jointed.nc", SIGNATURE, ALONE)
    others.save(3, parts)
    files.remove()
    assert files.newest() == 0 and others.newest() == 3 and len([*tmp_path.iterdir()]) == 1


@pytest.mark.parametrize("key", ["scene", "program", "number of processes"])
def test_checkpoint_of_another_run_is_refused(key, tmp_path, files, parts):
    files.save(5, parts)
    other = Checkpoints(tmp_path / "dem.nc", SIGNATURE | {key: "2"}, ALONE)
    with pytest.raises(SceneError, match=f"is from another {key}: remove it"):
        other.newest()
    assert len(list(tmp_path.iterdir())) == 1
    other.save(2, parts)
    assert other.newest() == 2 and len(list(tmp_path.iterdir())) == 1


def test_no_flipped_bit_changes_what_comes_back(tmp_path, files, parts):
    files.save(5, parts)
    (path,) = tmp_path.iterdir()
    whole, refused = path.read_bytes(), 0
    for at in range(0, len(whole), 7):
        path.write_bytes(whole[:at] + bytes([whole[at] ^ 16]) + whole[at + 1 :])
        try:
            files.newest()
        except SceneError as error:
            refused += "is damaged" in str(error)
        else:
            back, saved = restored(files, 5, parts)
            assert back == saved
    assert refused > len(whole) / 7 / 3
    for end in (0, 1, 63, 64, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:end])
        with pytest.raises(SceneError, match="is damaged"):
            files.newest()
    path.write_bytes(whole)
    assert files.newest() == 5


def test_set_that_a_kill_has_left_incomplete_does_not_count(tmp_path, parts, monkeypatch):
    """Of two processes one had written its new file: both go on from the older set."""
    first, second = (Checkpoints(tmp_path / "c.nc", SIGNATURE, Share(rank)) for rank in (0, 1))
    first.save(4, parts)
    assert first.newest() == 0  # the second has none yet
    second.save(4, parts)
    assert first.newest() == second.newest() == 4
    with monkeypatch.context() as patch:
        patch.setattr(first, "_remove_but", lambda samples: None)  # killed before it came to this
        first.save(9, parts)
    assert first.newest() == second.newest() == 4


def test_damaged_checkpoint_is_one_line_of_the_command(tmp_path, stopped, said):
    """Nothing is touched; without --resume the run starts anew and clears it away."""
    run = arguments("axial", tmp_path, "--checkpoint-every", "0.01")
    assert stopped(run, tmp_path, signal.SIGTERM)[0] == 143
    (path,) = tmp_path.glob(".*.npz")
    path.write_bytes(path.read_bytes()[:-1000])
    left = sorted(tmp_path.iterdir())
    (line,) = said(*arguments("axial", tmp_path, "--resume"), code=2)
    assert f"{path}: is damaged" in line and sorted(tmp_path.iterdir()) == left
    assert said(*arguments("axial", tmp_path)) == []
    assert not path.exists() and (tmp_path / "dem.nc").is_file()


SHORT = {
    "pillar__length": 10.0,
    "time__duration": 4e-3,
    "record": {"stress": [0.0, 5.0], "velocity": [0.25], "interval": 1e-4, "fields": 1e-3},
    "joints": {"damping_ratio": 0.02, "tension": False},
    "ends__end": "quiet",
}
SLIPS, FREE = {"friction_angle": 30.0, "cohesion": 1e5}, {"ends__end": "free"}
RUNS = {
    "chain": {},
    "chain of fourth order": FREE | {"joints": {}, "numerics__dem__scheme": "fourth-order"},
    "row in space": FREE | {"joints": SLIPS, "load__direction": [0.6, 0.8, 0.0]},
}


@pytest.mark.parametrize("changes", RUNS.values(), ids=RUNS)
def test_blocks_go_on_to_the_same_bits(pillar, keeper_at, changes):
    """With dashpots, joints that open or slip, ends, the ledger and snapshots."""
    scene, keeper = pillar(**SHORT | changes), keeper_at(15)
    with pytest.raises(InterruptedRun):
        solve("dem", scene, keeper=keeper)
    assert 15 <= keeper.done < 40
    assert solve("dem", scene, keeper=keeper).equals(solve("dem", scene))


def test_a_continued_run_has_the_cost_of_all_its_steps(pillar, tmp_path, monkeypatch):
    """By a clock that moves at each look by a second, which each part of a run takes."""
    monkeypatch.setattr("jointwave.dem.run.perf_counter", count().__next__)
    stop, job = Signals(), Job(pillar(**SHORT), "dem", tmp_path / "dem.nc")
    stop.asked = signal.SIGTERM
    with pytest.raises(InterruptedRun):
        execute([job], lambda fraction: None, settings=CheckpointSettings(60.0, False, stop))
    ((_, _, samples, _),) = (path.stem.split("-") for path in tmp_path.glob(".dem.*"))
    go_on = CheckpointSettings(60.0, True, Signals())
    (done,) = execute([job], lambda fraction: None, settings=go_on)
    # 41 samples, of which the first is the beginning.
    assert done.facts["seconds_stepping"] == pytest.approx(40 / (41 - int(samples)))
    assert 1 < int(samples) < 41
