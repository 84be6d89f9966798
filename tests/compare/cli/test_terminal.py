"""On a terminal there are colours and progress with the time that is left; elsewhere neither."""

import os
import pty
import re
import subprocess
import sys
from contextlib import suppress

import pandas as pd
import pytest

from jointwave.compare.cli import terminal

COLOUR = re.compile(r"\x1b\[[0-9;]*3[0-9][0-9;]*m")
SCENE = "guo-li-2002/fig-03"
RED = "from jointwave.compare.cli.terminal import say; say('would fail', 'red')"

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


def on_terminal(code, **environment):
    """Return a program's output to a terminal that is its stdout and stderr."""
    ours, theirs = pty.openpty()
    clean = {k: v for k, v in os.environ.items() if k not in ("NO_COLOR", "FORCE_COLOR")}
    told = {**clean, "TERM": "xterm-256color", "COLUMNS": "120", **environment}
    command = [sys.executable, "-c", code]
    process = subprocess.Popen(command, stdout=theirs, stderr=theirs, env=told)
    os.close(theirs)
    said = b""
    with suppress(OSError):  # the other end is closed
        while part := os.read(ours, 65536):
            said += part
    os.close(ours)
    assert process.wait() == 0
    return said.decode()


def piped(code, **environment):
    """Return a program that has run with pipes."""
    command, told = [sys.executable, "-c", code], os.environ | environment
    return subprocess.run(command, capture_output=True, text=True, env=told)


def test_progress_says_what_is_done_and_how_long_it_will_take():
    """Its bar is gone in the end; square brackets in a label are no markup."""
    said = on_terminal(CLOCKED)
    assert "[bold]ten parts" in said and re.search(r"[3-8]0%", said)
    left = [int(s) for s in re.findall(r"0:00:0(\d)\S* \S*left", said)]
    assert left and max(left) in (1, 2) and left == sorted(left, reverse=True)
    assert "\x1b[2K" in said.rsplit("100%")[-1]


def test_a_pipe_gets_a_line_now_and_then():
    """On standard error only, with the progress so far; none remains after the work has ended, and
    nothing reaches it of what is soon done, but what engines say, once."""
    done = piped(SLOW + "sleep(0.3)", JOINTWAVE_PROGRESS="0.1")
    assert done.stdout == ""
    lines = done.stderr.splitlines()
    said = [re.fullmatch(r"jointwave: \[bold\]ten parts: (\d+)% after \d s", x) for x in lines]
    assert said and all(said)
    shares = [int(one[1]) for one in said]
    assert shares == sorted(shares) and shares[0] < 100
    done = piped(SLOW)
    assert done.stdout == done.stderr == ""
    logged = "import logging" + 2 * "; logging.getLogger('jointwave').warning('a coarse mesh')"
    done = piped(SLOW.replace("sleep(0.05)", logged), JOINTWAVE_PROGRESS="30")
    assert done.stderr == "jointwave: a coarse mesh\n"


@pytest.mark.parametrize("close", ["sys.stderr.close()", "os.close(2)"])
def test_a_pipe_that_nobody_reads_does_not_end_the_work(close):
    code = f"import os, sys\n{close}\n{SLOW}print('whole')"
    assert piped(code, JOINTWAVE_PROGRESS="0.1").stdout == "whole\n"


@pytest.mark.parametrize("every", ["often", "-1", "nan", "inf"])
def test_an_interval_that_is_none_is_one_line(every, jointwave, monkeypatch):
    monkeypatch.setenv("JOINTWAVE_PROGRESS", every)
    done = jointwave("run", SCENE, "--out", "/nowhere/writable", code=2)
    message = f"JOINTWAVE_PROGRESS: must be a number of seconds, not {every!r}"
    assert done.err == f"jointwave: {message}\n"


def test_colours_are_for_a_terminal_that_wants_them():
    assert COLOUR.search(on_terminal(RED))
    assert not COLOUR.search(on_terminal(RED, NO_COLOR="1"))
    done = piped(RED)
    assert (done.stdout, done.stderr) == ("would fail\n", "")


def test_a_table_that_is_too_wide_is_turned(capsys, monkeypatch):
    """Where it has few rows: its columns become rows, and nothing of it is wrapped."""
    monkeypatch.setattr(terminal, "PIPE", 30)
    header, row = ["engine", "a number (m)", "a number (s)"], ["rigid blocks", "1", "2"]
    terminal.show_table(header, [row])
    assert [x.split("  ")[0] for x in capsys.readouterr().out.splitlines()] == header
    terminal.show_table(header, 5 * [row])
    assert capsys.readouterr().out.startswith("engine        a number (m)  a number (s)")


def test_a_long_column_is_folded_alone_and_equal_labels_stand_together(capsys, monkeypatch):
    monkeypatch.setattr(terminal, "PIPE", 30)
    labels = pd.MultiIndex.from_tuples([("far", 1), ("near", 2), ("far", 3), *[("far", 4)] * 3])
    terminal.show_frame(pd.DataFrame({"a pair of solutions": "jointed rock ~ " + 40 * "x"}, labels))
    first, *rows = (line.split() for line in capsys.readouterr().out.splitlines())
    assert "solutions" in first and [row[:4] for row in rows[:2]] == [
        ["far", "1", "jointed", "rock"],
        [40 * "x"],
    ]
    assert [row[-4] for row in rows[::2]] == ["1", "3", "4", "4", "4", "2"]


INTERRUPTED = """
import sys

class Interrupting:
    def find_spec(self, name, path=None, target=None):
        if name == "typer":
            raise KeyboardInterrupt

sys.meta_path.insert(0, Interrupting())
from jointwave.compare.cli.program import main
main()
"""


def test_ctrl_c_while_the_program_is_imported_is_one_line():
    done = piped(INTERRUPTED)
    assert (done.returncode, done.stdout) == (130, "")
    assert done.stderr == "jointwave: interrupted\n"


COLORAMA = """
__version__ = "1.0"

class Fore:
    def __getattr__(self, name):
        return ""

Fore = Style = Fore()
init = reinit = deinit = lambda *args, **more: print("colours")
"""

MESSAGE = """
import sys
from jointwave.compare.cli.program import main

sys.argv = ["jointwave", "--version"]
try:
    main()
except SystemExit:
    from numba.core.errors import termcolor
    print(termcolor().errmsg("a message"))
"""


def test_messages_of_numba_are_not_coloured(tmp_path):
    """colorama would append an escape sequence to all terminal output, also JSON."""
    (tmp_path / "colorama.py").write_text(COLORAMA)
    path = os.pathsep.join([str(tmp_path), *sys.path])
    done = piped(MESSAGE, PYTHONPATH=path)
    assert done.returncode == 0, done.stderr
    assert "colours" not in done.stdout and done.stdout.endswith("a message\n")


def test_pictures_are_drawn_whatever_backend_a_shell_names(tmp_path):
    picture = ["jointwave", "picture", SCENE, "--out", str(tmp_path / "a.png")]
    main = "from jointwave.compare.cli.program import main; main()"
    done = piped(f"import sys; sys.argv = {picture}; {main}", MPLBACKEND="none")
    assert (done.returncode, done.stderr) == (0, "") and (tmp_path / "a.png").exists()
