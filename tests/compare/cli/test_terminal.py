"""On a terminal there are colours and progress with the time that is left; elsewhere neither."""

import os
import pty
import re
import subprocess
import sys

import pytest

from jointwave.compare.cli import terminal

COLOUR = re.compile(r"\x1b\[[0-9;]*3[0-9][0-9;]*m")
#: A point that would fail, which is said in red.
RED = ("run", "guo-li-2002/fig-03", "--sweep", "joints.damping_ratio=-1,0.1", "--dry-run")

SLOW = """
from time import sleep
from jointwave.compare.cli.terminal import progress
with progress("[bold]ten parts") as advance:
    for i in range(10):
        sleep(0.05)
        advance((i + 1) / 10)
"""

#: The same by a clock of its own, which no load of the machine slows down.
CLOCKED = """
import rich.console
clock = [0.0]
rich.console.monotonic = lambda: clock[0]
""" + SLOW.replace("sleep(0.05)", "sleep(0.15); clock[0] += 0.15")


def on_terminal(command, **environment):
    """Return a command's output to a terminal that is its stdout and stderr."""
    ours, theirs = pty.openpty()
    clean = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "FORCE_COLOR")}
    told = {**clean, "TERM": "xterm-256color", "COLUMNS": "120", **environment}
    process = subprocess.Popen(command, stdout=theirs, stderr=theirs, env=told)
    os.close(theirs)
    said = b""
    while True:
        try:
            part = os.read(ours, 65536)
        except OSError:  # the other end is closed
            break
        if not part:
            break
        said += part
    os.close(ours)
    assert process.wait() == 0
    return said.decode()


def command(*arguments):
    return [sys.executable, "-m", "jointwave", *arguments]


def test_progress_says_what_is_done_and_how_long_it_will_take():
    """Its bar is gone in the end; square brackets in a label are no markup."""
    said = on_terminal([sys.executable, "-c", CLOCKED])
    assert "[bold]ten parts" in said and re.search(r"[3-8]0%", said)
    left = [int(s) for s in re.findall(r"0:00:0(\d)\S* \S*left", said)]
    assert left and max(left) in (1, 2) and left == sorted(left, reverse=True)
    assert "\x1b[2K" in said.rsplit("100%")[-1]


def test_nothing_of_what_is_soon_done_reaches_a_pipe():
    done = subprocess.run([sys.executable, "-c", SLOW], capture_output=True, text=True)
    assert done.stdout == done.stderr == ""


def piped(code, every):
    """Return a program that has run with pipes, and with a progress line at an interval (s)."""
    environment = os.environ | {"JOINTWAVE_PROGRESS": every}
    command = [sys.executable, "-c", code]
    return subprocess.run(command, capture_output=True, text=True, env=environment)


def test_a_pipe_gets_a_line_now_and_then():
    """On standard error only, with the progress so far; none remains after the work has ended."""
    done = piped(SLOW + "sleep(0.3)", "0.1")
    assert done.stdout == ""
    lines = done.stderr.splitlines()
    said = [re.fullmatch(r"jointwave: \[bold\]ten parts: (\d+)% after \d s", x) for x in lines]
    assert said and all(said)
    shares = [int(one[1]) for one in said]
    assert shares == sorted(shares) and shares[0] < 100


@pytest.mark.parametrize("close", ["sys.stderr.close()", "os.close(2)"])
def test_a_pipe_that_nobody_reads_does_not_end_the_work(close):
    assert piped(f"import os, sys\n{close}\n{SLOW}print('whole')", "0.1").stdout == "whole\n"


@pytest.mark.parametrize("every", ["often", "-1", "nan", "inf"])
def test_an_interval_that_is_none_is_one_line(every, jointwave, monkeypatch):
    monkeypatch.setenv("JOINTWAVE_PROGRESS", every)
    done = jointwave("run", "guo-li-2002/fig-03", "--out", "/nowhere/writable", code=2)
    message = f"JOINTWAVE_PROGRESS: must be a number of seconds, not {every!r}"
    assert done.err == f"jointwave: {message}\n"


def test_colours_are_for_a_terminal_that_wants_them():
    """Red on a terminal; none with NO_COLOR, none in a pipe."""
    assert COLOUR.search(on_terminal(command(*RED)))
    assert not COLOUR.search(on_terminal(command(*RED), NO_COLOR="1"))
    done = subprocess.run(command(*RED), capture_output=True, text=True)
    assert "would fail" in done.stdout and "\x1b" not in done.stdout and done.stderr == ""


def test_a_run_shows_its_progress_on_a_terminal(tmp_path):
    run = command("run", "guo-li-2002/fig-03", "--set", "time.duration=0.01", "--out", tmp_path)
    assert re.search(r"4 runs.*left", on_terminal(run))


def test_a_table_that_is_too_wide_is_turned(capsys, monkeypatch):
    """Where it has few rows: its columns become rows, and nothing of it is wrapped."""
    monkeypatch.setattr(terminal, "PIPE", 30)
    wide = ["engine", *(f"a number ({unit})" for unit in ("m", "s"))], [["rigid blocks", "1", "2"]]
    terminal.show_table(*wide)
    lines = [line.split("  ") for line in capsys.readouterr().out.splitlines()]
    assert [line[0] for line in lines] == ["engine", "a number (m)", "a number (s)"]
    terminal.show_table(wide[0], 5 * wide[1])
    assert capsys.readouterr().out.startswith("engine        a number (m)  a number (s)")
