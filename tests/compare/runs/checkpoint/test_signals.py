"""Ctrl-C and similar signals end every command cleanly, settings completed results."""

import os
import signal
import subprocess
import sys
import time

import pytest
import xarray as xr

from jointwave.compare.runs.checkpoint.signals import Ended, Signals
from jointwave.compare.scenes import find
from tests.compare.runs.checkpoint.commands import arguments, is_locked, refuse_difference, until

EVERY = ("--checkpoint-every", "0.01")


def members(group):
    """Return the processes of a group that still run."""
    command = ["ps", "-eo", "pgid=,stat=,args="]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    found = [line.split(None, 2) for line in lines]
    return [args for gid, state, args in found if gid == str(group) and state[0] != "Z"]


def test_run_that_is_stopped_keeps_what_is_there_and_goes_on(tmp_path, stopped, said, whole):
    """One line; the waveforms until then are those of the whole run; --resume ends with the rest,
    and nothing but the result is left."""
    out, undisturbed = tmp_path / "out", whole("axial")
    ended, (line,) = stopped(arguments("axial", out, *EVERY), out, signal.SIGINT)
    assert ended == 130 and "interrupted at t = 0." in line and "--resume" in line
    assert str(out / "dem.stopped.nc") in line and not (out / "dem.nc").exists()
    with xr.open_dataset(out / "dem.stopped.nc") as part, xr.open_dataset(undisturbed) as all_of_it:
        count, shots = part.sizes["time"], part.sizes["field_time"]
        assert 1 < count < all_of_it.sizes["time"] and shots > 1
        until_then = {"time": slice(count), "field_time": slice(shots)}
        xr.testing.assert_equal(part, all_of_it.isel(until_then))
    (line,) = said(*arguments("axial", out, "--resume"))
    assert "continues at t = 0." in line
    refuse_difference(out / "dem.nc", undisturbed)
    assert {p.name for p in out.iterdir()} == {p.name for p in undisturbed.parent.iterdir()}


def test_processes_that_share_a_run_stop_together(tmp_path, start, finish, whole):
    """A signal that reaches one of two stops both, at the same sample."""
    out = tmp_path / "out"
    run = start(*arguments("shared", out, *EVERY), ranks=2)
    assert until(run, lambda: len(list(out.glob(".*.checkpoint-*-[01].npz"))) > 1)
    # Of the launcher, its helpers where it has any, and the processes, the last was started last.
    named = ["pgrep", "-f", str(out)]
    one = subprocess.run(named, capture_output=True, text=True, check=True).stdout.split()[-1]
    os.kill(int(one), signal.SIGTERM)
    code, (line,) = finish(run)
    assert code == 143 and "terminated at t = 0." in line and "--resume" in line
    assert finish(start(*arguments("shared", out, "--resume"), ranks=2))[0] == 0
    refuse_difference(out / whole("shared").name, whole("shared"))


def test_resume_goes_on_with_the_first_variant_that_is_not_whole(tmp_path, stopped, said):
    """Of several runs those that ended stay; the one that was killed goes on."""
    text = find("guo-li-2002/fig-03").read_text(encoding="utf-8")
    two, (first, second, *_) = tmp_path / "two.toml", text.split("[[variants]]")
    two.write_text(f"{first}[[variants]]{second}", encoding="utf-8")
    _, _, _, _, *options = arguments("axial", tmp_path, *EVERY)  # but for the scene and its variant
    every = ("run", two, *options)
    first, folder = tmp_path / "dem.nc", tmp_path / "zeta 0.02"
    assert stopped(every, folder, signal.SIGKILL) == (-signal.SIGKILL, [])
    before = first.stat().st_mtime_ns
    (line,) = said(*every, "--resume")
    assert f"{folder / 'dem.nc'} continues" in line
    assert first.stat().st_mtime_ns == before and (folder / "dem.nc").is_file()


@pytest.mark.parametrize(
    ("command", "number"),
    [
        (("study", "convergence"), signal.SIGINT),
        (("report",), signal.SIGTERM),
        (("run", "guo-li-2002/fig-03", "--engine", "exact"), signal.SIGINT),
    ],
)
def test_what_has_no_checkpoints_ends_in_a_line(command, number, tmp_path, start, finish):
    """Ctrl-C reaches the workers too, SIGTERM does not: neither says anything, none is left."""
    out = tmp_path / "out"
    process = start(*command, "--out", out)
    assert until(process, lambda: any(map(is_locked, (out, *out.rglob("*")))))
    if number == signal.SIGINT:
        os.killpg(process.pid, number)
    else:
        process.send_signal(number)
    code, said = finish(process)
    assert code == 128 + number and len(said) == 1
    end = time.monotonic() + 60.0  # for a machine that has much else to do
    while left := members(process.pid):
        assert time.monotonic() < end, left
        time.sleep(0.05)


def test_second_signal_does_not_wait(monkeypatch):
    monkeypatch.setattr(signal, "signal", lambda *handler: None)
    signals = Signals(patient=True)
    signals._arrived(signal.SIGINT, None)
    assert signals.asked == signal.SIGINT
    with pytest.raises(Ended, match="interrupted"):
        signals._arrived(signal.SIGINT, None)


CALLED_BACK = """
import ctypes, os, signal
from jointwave.compare.cli import program

def compiling(arguments):
    ctypes.CFUNCTYPE(None)(lambda: os.kill(os.getpid(), signal.SIGTERM))()
    raise RuntimeError("no compiled object yet")

program.run = compiling
program.main()
"""


def test_a_signal_in_a_callback_of_a_compiler_ends_the_program_in_one_line():
    """ctypes takes no exception out of a callback, and LLVM has no object then."""
    done = subprocess.run([sys.executable, "-c", CALLED_BACK], capture_output=True, text=True)
    assert (done.stderr, done.returncode) == ("jointwave: terminated\n", 143)
