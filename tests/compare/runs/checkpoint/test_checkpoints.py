"""Checkpoints restore the saved arrays, or report in one line why they cannot."""

import shutil
import signal
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from jointwave import cases
from jointwave.cases.errors import SceneError
from jointwave.compare.runs.checkpoint.files import Checkpoints
from jointwave.compare.runs.processes import ALONE, Processes
from jointwave.results.arrays import arrays, copied

SIGNATURE = {"scene": "a", "engine": "dem", "number of processes": "1", "program": "1"}
BEYOND = Path(cases.__file__).parent / "beyond"


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


def emptied(parts):
    """Return parts of the same shapes with nothing in them."""
    empty = copied(parts)
    for array in (empty[0], *empty[2], *empty[3]):
        array[...] = 0
    return empty


def test_parts_come_back_as_they_were(tmp_path, parts):
    """Every bit, of every kind; the older checkpoint is gone, and at the end all are."""
    files = Checkpoints(tmp_path / "dem.nc", SIGNATURE, ALONE)
    assert files.newest() == 0
    files.save(5, emptied(parts))
    files.save(12, parts)
    (path,) = tmp_path.iterdir()
    assert path.name.startswith(".dem.checkpoint-") and files.newest() == 12
    back = emptied(parts)
    files.load(12, back)
    assert back[0].tobytes() == parts[0].tobytes()
    assert all((a == b).all() for a, b in zip(back[2], parts[2], strict=True))
    files.remove()
    assert not list(tmp_path.iterdir())


def test_checkpoints_of_other_results_are_left_alone(tmp_path, parts):
    """Those of the continuum in the same folder, say."""
    others = Checkpoints(tmp_path / "continuum-jointed.nc", SIGNATURE, ALONE)
    others.save(3, parts)
    files = Checkpoints(tmp_path / "dem.nc", SIGNATURE, ALONE)
    files.save(5, parts)
    files.remove()
    assert others.newest() == 3


@pytest.mark.parametrize("key", ["scene", "program", "number of processes"])
def test_checkpoint_of_another_run_is_refused(key, tmp_path, parts):
    """The line names the differences, and the file is kept; a run without --resume replaces it."""
    Checkpoints(tmp_path / "dem.nc", SIGNATURE, ALONE).save(5, parts)
    other = Checkpoints(tmp_path / "dem.nc", SIGNATURE | {key: "2"}, ALONE)
    with pytest.raises(SceneError, match=f"is from another {key}: remove it"):
        other.newest()
    assert len(list(tmp_path.iterdir())) == 1
    other.save(2, parts)
    assert other.newest() == 2 and len(list(tmp_path.iterdir())) == 1


def test_checkpoint_of_other_shapes_is_refused(tmp_path, parts):
    """numpy would spread one number over all of an array."""
    files = Checkpoints(tmp_path / "dem.nc", SIGNATURE, ALONE)
    files.save(5, (np.ones(1),))
    with pytest.raises(SceneError, match="does not fit this run"):
        files.load(5, (np.zeros(3),))


def test_no_flipped_bit_changes_what_comes_back(tmp_path, parts):
    """Wherever it is: in the zip's directory, in an array, in a checksum."""
    files = Checkpoints(tmp_path / "dem.nc", SIGNATURE, ALONE)
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
            back = emptied(parts)
            files.load(5, back)
            for one, other in zip(arrays(back), arrays(parts), strict=True):
                assert one.tobytes() == other.tobytes()
    assert refused > len(whole) / 7 / 3
    for end in (0, 1, 63, 64, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:end])
        with pytest.raises(SceneError, match="is damaged"):
            files.newest()
    path.write_bytes(whole)
    assert files.newest() == 5


@settings(max_examples=60, deadline=None, derandomize=True)
@given(at=st.integers(0, 2000), new=st.binary(max_size=4), about=st.sampled_from(["", "1", "{}"]))
def test_content_of_another_form_is_one_line(tmp_path_factory, at, new, about):
    """It is restored or refused."""
    folder = tmp_path_factory.mktemp("checkpoint")
    files = Checkpoints(folder / "dem.nc", SIGNATURE, ALONE)
    parts = (np.arange(6.0).reshape(3, 2), np.array([True]))
    files.save(5, parts)
    (path,) = folder.iterdir()
    body = path.read_bytes()
    path.write_bytes(body[:at] + new + body[at + len(new) :])
    if about:
        np.savez(path, about=np.array(about), **{"00000": parts[0], "00001": parts[1]})
    with suppress(SceneError):
        files.newest()
        files.load(5, emptied_of(parts))
    with pytest.raises(SceneError) as error:
        Checkpoints(folder / "dem.nc", SIGNATURE | {"engine": "x"}, ALONE).newest()
    assert len(str(error.value).splitlines()) == 1


def emptied_of(parts):
    return tuple(np.zeros_like(part) for part in parts)


def test_set_that_a_kill_has_left_incomplete_does_not_count(tmp_path, parts):
    """Of two processes one had written its new file: both go on from the older set."""
    first, second = (Checkpoints(tmp_path / "c.nc", SIGNATURE, Share(rank)) for rank in (0, 1))
    first.save(4, parts)
    assert first.newest() == 0  # the second has none yet
    second.save(4, parts)
    assert first.newest() == second.newest() == 4
    removed = first._remove_but
    first._remove_but = lambda samples: None  # killed before it came to this
    first.save(9, parts)
    first._remove_but = removed
    assert first.newest() == second.newest() == 4


def test_input_that_has_vanished_is_one_line_and_the_checkpoint_stays(
    tmp_path, start, said, finish, until
):
    """The load's history is gone when the run is to go on; back again, it goes on."""
    scene, table, out = (tmp_path / name for name in ("blast.toml", "table.csv", "out"))
    shutil.copy(BEYOND / "blast-two-delays.csv", table)
    text = (BEYOND / "blast-history.toml").read_text(encoding="utf-8")
    scene.write_text(text.replace("blast-two-delays.csv", table.name), encoding="utf-8")
    run = ("run", scene, "--variant", "", "--out", out, "--resume", "--checkpoint-every", "0.01")
    changes = ("--set", "numerics.dem.step_fraction=1e-4", "--set", "record.fields=1e-3")
    process = start(*run, *changes)
    assert until(process, lambda: list(out.glob(".*.checkpoint-*-0.npz")))
    process.send_signal(signal.SIGINT)
    assert finish(process)[0] == 130
    left, gone = sorted(out.iterdir()), table.rename(tmp_path / "gone.csv")
    (line,) = said(*run, *changes, code=2)
    assert table.name in line and sorted(out.iterdir()) == left
    gone.rename(table)
    (line,) = said(*run, *changes)
    assert "continues at t = " in line


def test_damaged_checkpoint_is_one_line_of_the_command(
    tmp_path, start, said, finish, until, arguments
):
    """Nothing is touched; without --resume the run starts anew and clears it away."""
    process = start(*arguments("axial", tmp_path, "--checkpoint-every", "0.01"))
    assert until(process, lambda: list(tmp_path.glob(".*.checkpoint-*-0.npz")))
    process.send_signal(signal.SIGTERM)
    assert finish(process)[0] == 143
    (path,) = tmp_path.glob(".*.npz")
    path.write_bytes(path.read_bytes()[:-1000])
    left = sorted(tmp_path.iterdir())
    (line,) = said(*arguments("axial", tmp_path, "--resume"), code=2)
    assert f"{path}: is damaged" in line and sorted(tmp_path.iterdir()) == left
    assert said(*arguments("axial", tmp_path)) == []
    assert not path.exists() and (tmp_path / "dem.nc").is_file()
