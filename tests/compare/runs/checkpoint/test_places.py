"""Folders and files that cannot be written, or are in use: one line, and nothing is lost."""

import shutil
import signal
import subprocess

import pytest

SHORT = ("--set", "time.duration=4e-3")


@pytest.fixture
def disk(tmp_path):
    """Return a small disk of its own."""
    place = tmp_path / "disk"
    place.mkdir()
    mount = ("mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", str(place))
    done = subprocess.run(mount, capture_output=True, text=True)
    if done.returncode:
        pytest.skip(f"no disk can be mounted here: {done.stderr.strip()}")
    yield place
    subprocess.run(("umount", str(place)), check=True)


def fill(place):
    """Fill a disk to its last byte; returns the file that does."""
    filler = place / "filler"
    with filler.open("wb", buffering=0) as file:
        while True:
            try:
                file.write(bytes(4096))
            except OSError:
                return filler


def test_full_disk_leaves_the_old_result(disk, said, arguments):
    """The new one has no room."""
    run = arguments("axial", disk, *SHORT)
    assert said(*run) == []
    filler, before = fill(disk), (disk / "dem.nc").read_bytes()
    there = {path.name for path in disk.iterdir()}
    (line,) = said(*run, "--fresh", code=2)
    assert line == f"jointwave: {disk / 'dem.nc'}: No space left on device"
    assert (disk / "dem.nc").read_bytes() == before
    assert {path.name for path in disk.iterdir()} == there
    filler.unlink()
    assert said(*run, "--fresh") == []


def test_full_disk_costs_a_checkpoint_but_not_the_run(
    disk, start, finish, until, arguments, whole, refuse_difference
):
    """It is said once; when there is room again, checkpoints are there again."""
    filler = fill(disk)
    run = start(*arguments("axial", disk, "--checkpoint-every", "0.001"))
    line = run.stderr.readline()
    filler.unlink()
    assert until(run, lambda: list(disk.glob(".*.checkpoint-*-0.npz")))
    assert finish(run) == (0, [])
    assert "no checkpoint" in line and "No space left on device" in line
    refuse_difference(disk / "dem.nc", whole("axial") / "dem.nc")


def test_read_only_folder_is_one_line(disk, said, arguments):
    """It is said before anything is run."""
    run = arguments("axial", disk, *SHORT)
    assert said(*run) == []
    before = (disk / "dem.nc").read_bytes()
    subprocess.run(("mount", "-o", "remount,ro", str(disk)), check=True)
    (line,) = said(*run, code=2)
    assert str(disk) in line and "Read-only file system" in line
    assert (disk / "dem.nc").read_bytes() == before


def test_protected_result_is_refused_before_the_run(tmp_path, said, arguments):
    """Not when hours have passed."""
    if shutil.which("chattr") is None:
        pytest.skip("no file can be protected here: no chattr")
    result = tmp_path / "dem.nc"
    result.write_bytes(b"CDF of an earlier run")
    done = subprocess.run(("chattr", "+i", str(result)), capture_output=True, text=True)
    if done.returncode:
        pytest.skip(f"no file can be protected here: {done.stderr.strip()}")
    try:
        (line,) = said(*arguments("axial", tmp_path, *SHORT), code=2)
        assert str(result) in line and "protected" in line
        assert result.read_bytes() == b"CDF of an earlier run"
    finally:
        subprocess.run(("chattr", "-i", str(result)), check=True)


def test_folder_in_place_of_a_result_is_refused_before_the_run(tmp_path, said, arguments):
    """A file cannot take its place."""
    (tmp_path / "dem.nc").mkdir()
    (line,) = said(*arguments("axial", tmp_path, *SHORT), code=2)
    assert f"{tmp_path / 'dem.nc'}: is a folder" in line


def test_full_standard_output_is_one_line(start, finish):
    """The table has nowhere to go."""
    with open("/dev/full", "w") as full:
        process = start("list", out=full)
        code, (line,) = finish(process)
    assert code == 2 and "No space left on device" in line


def test_second_run_into_a_folder_is_refused_and_the_first_goes_on(
    tmp_path, start, said, finish, until, arguments, is_locked
):
    """Results of two runs do not mix; those who only read are let in."""
    out = tmp_path / "out"
    first = start(*arguments("axial", out, "--checkpoint-every", "0"))
    assert until(first, lambda: is_locked(out))
    first.send_signal(signal.SIGSTOP)  # lest it ends before the second has started
    (line,) = said(*arguments("axial", out, *SHORT), code=2)
    assert f"{out}: another jointwave process is writing here" in line
    first.send_signal(signal.SIGCONT)
    assert finish(first) == (0, []) and not is_locked(out)


def test_lock_of_a_killed_run_is_nobodys(tmp_path, start, said, until, arguments, is_locked):
    """The system releases it, and the next run takes it."""
    first = start(*arguments("axial", tmp_path))
    assert until(first, lambda: is_locked(tmp_path))
    first.kill()
    first.communicate()
    assert not is_locked(tmp_path)
    assert said(*arguments("axial", tmp_path, *SHORT)) == []


def test_folder_of_a_refused_run_is_not_made(tmp_path, said, arguments):
    """A step above the critical one is found when the folder is held already."""
    out = tmp_path / "new" / "folder"
    refused = arguments("axial", out, "--set", "numerics.dem.step_fraction=1.5")
    (line,) = said(*refused, code=2)
    assert "critical" in line and not list(tmp_path.iterdir())
