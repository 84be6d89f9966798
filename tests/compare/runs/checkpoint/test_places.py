"""Folders and files that cannot be written, or are in use: one line, and nothing is lost."""

import shutil
import signal
import subprocess
from contextlib import suppress

import pytest

from tests.compare.runs.checkpoint.commands import arguments, is_locked, refuse_difference, until

SHORT = ("--set", "time.duration=4e-3")


@pytest.fixture
def disk(tmp_path):
    place = tmp_path / "disk"
    place.mkdir()
    mount = ("mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", str(place))
    done = subprocess.run(mount, capture_output=True, text=True)
    if done.returncode:
        pytest.skip(f"no disk can be mounted here: {done.stderr.strip()}")
    yield place
    subprocess.run(("umount", str(place)), check=True)


def fill(place):
    filler = place / "filler"
    with filler.open("wb", buffering=0) as file, suppress(OSError):
        while True:
            file.write(bytes(4096))
    return filler


def test_full_or_read_only_disk_leaves_the_old_result(disk, said):
    """The new one has no room; what is read-only is said before anything is run."""
    run, result = arguments("axial", disk, *SHORT), disk / "dem.nc"
    assert said(*run) == []
    filler, before = fill(disk), result.read_bytes()
    there = {path.name for path in disk.iterdir()}
    (line,) = said(*run, "--fresh", code=2)
    assert line == f"jointwave: {result}: No space left on device"
    assert result.read_bytes() == before
    assert {path.name for path in disk.iterdir()} == there
    filler.unlink()
    assert said(*run, "--fresh") == []
    before = result.read_bytes()
    subprocess.run(("mount", "-o", "remount,ro", str(disk)), check=True)
    (line,) = said(*run, code=2)
    assert str(disk) in line and "Read-only file system" in line
    assert result.read_bytes() == before


def test_full_disk_costs_a_checkpoint_but_not_the_run(disk, start, finish, whole):
    """It is said once; when there is room again, checkpoints are there again."""
    filler = fill(disk)
    run = start(*arguments("axial", disk, "--checkpoint-every", "0.001"))
    line = run.stderr.readline()
    filler.unlink()
    assert until(run, lambda: list(disk.glob(".*.checkpoint-*-0.npz")))
    assert finish(run) == (0, [])
    assert "no checkpoint" in line and "No space left on device" in line
    refuse_difference(disk / "dem.nc", whole("axial"))


def test_result_that_cannot_be_replaced_is_refused_before_the_run(tmp_path, said):
    """Not when hours have passed: a protected file, and a folder in its place."""
    folder, protected = (tmp_path / name / "dem.nc" for name in ("a", "b"))
    folder.mkdir(parents=True)
    (line,) = said(*arguments("axial", folder.parent, *SHORT), code=2)
    assert f"{folder}: is a folder" in line
    if shutil.which("chattr") is None:
        pytest.skip("no file can be protected here: no chattr")
    protected.parent.mkdir()
    protected.write_bytes(b"CDF of an earlier run")
    done = subprocess.run(("chattr", "+i", str(protected)), capture_output=True, text=True)
    if done.returncode:
        pytest.skip(f"no file can be protected here: {done.stderr.strip()}")
    try:
        (line,) = said(*arguments("axial", protected.parent, *SHORT), code=2)
        assert str(protected) in line and "protected" in line
        assert protected.read_bytes() == b"CDF of an earlier run"
    finally:
        subprocess.run(("chattr", "-i", str(protected)), check=True)


def test_full_standard_output_is_one_line(start, finish):
    with open("/dev/full", "w") as full:
        process = start("list", out=full)
        code, (line,) = finish(process)
    assert code == 2 and "No space left on device" in line


def test_second_run_into_a_folder_is_refused_until_the_first_has_ended(
    tmp_path, start, said, finish
):
    """Results of two runs do not mix. The system releases the lock of a killed run."""
    for end in (signal.SIGCONT, signal.SIGKILL):
        out = tmp_path / end.name
        first = start(*arguments("axial", out, "--checkpoint-every", "0"))
        assert until(first, lambda out=out: is_locked(out))
        first.send_signal(signal.SIGSTOP)  # lest it ends before the second has started
        (line,) = said(*arguments("axial", out, *SHORT), code=2)
        assert f"{out}: another jointwave process is writing here" in line
        first.send_signal(end)
        assert finish(first) == (0 if end == signal.SIGCONT else -end, []) and not is_locked(out)
        assert said(*arguments("axial", out, *SHORT, "--fresh")) == []


def test_folder_of_a_refused_run_is_not_made(tmp_path, said):
    """A step above the critical one is found when the folder is held already."""
    out = tmp_path / "new" / "folder"
    refused = arguments("axial", out, "--set", "numerics.dem.step_fraction=1.5")
    (line,) = said(*refused, code=2)
    assert "critical" in line and not list(tmp_path.iterdir())
