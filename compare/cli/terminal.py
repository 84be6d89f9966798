"""The terminal: progress, tables that stay readable, or JSON; rich is imported where it is used.

Titles and names come from others: no text gets here that is not `printable`.
"""

import json
import logging
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import zip_longest
from threading import TIMEOUT_MAX, Event, Thread
from time import monotonic
from typing import Any

from jointwave.cases.errors import SceneError, printable
from jointwave.cases.files import is_number

EVERY = "JOINTWAVE_PROGRESS"  # in the environment: s from one line to the next, 0 for none
WIDEST, UNFOLDED = 220, 10_000  # of a pipe, which has no width, and of a table of numbers


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """Show on standard error what is being done, while it runs.

    On a terminal a bar, with the time that it took and the time that is left, cleared at the end;
    elsewhere a line every half minute, or as many seconds as `EVERY` says; 0: none.
    """
    shown = _bar(label) if _console(stderr=True).is_terminal else _lines(label)
    with shown as advance, _log_shown():
        yield advance


@contextmanager
def _log_shown() -> Iterator[None]:
    """Show what the engines log, such as that kernels are being compiled, on standard error."""
    if os.environ.get(EVERY) == "0":
        yield
        return
    log, handler = logging.getLogger("jointwave"), logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("jointwave: %(message)s"))
    before = log.level
    log.addHandler(handler)
    log.setLevel(logging.INFO)
    try:
        yield
    finally:
        log.setLevel(before)
        log.removeHandler(handler)


@contextmanager
def _bar(label: str) -> Iterator[Callable[[float], None]]:
    from rich import progress as rich

    columns = (
        rich.TextColumn("{task.description}", markup=False),
        rich.BarColumn(),
        rich.TaskProgressColumn(),
        rich.TimeElapsedColumn(),
        rich.TextColumn("left"),
        rich.TimeRemainingColumn(),
    )
    with rich.Progress(*columns, console=_console(stderr=True), transient=True) as bar:
        task = bar.add_task(printable(label), total=1.0)
        yield lambda fraction: bar.update(task, completed=fraction)


@contextmanager
def _lines(label: str) -> Iterator[Callable[[float], None]]:
    done, ended, began = [0.0], Event(), monotonic()
    text = os.environ.get(EVERY, "30")
    if not (is_number(text) and 0 <= float(text) <= TIMEOUT_MAX):
        raise SceneError(EVERY, "", None, f"must be a number of seconds, not {text!r}")

    def tell() -> None:
        while not ended.wait(float(text)):
            line = f"{printable(label)}: {done[0]:.0%} after {monotonic() - began:.0f} s"
            with suppress(OSError, ValueError):  # nobody may be there to read it
                print(f"jointwave: {line}", file=sys.stderr, flush=True)

    if float(text):
        Thread(target=tell, daemon=True).start()
    try:
        yield lambda fraction: done.__setitem__(0, fraction)
    finally:
        ended.set()


def say(text: str, style: str = "") -> None:
    """Print a line of text, or several."""
    _console().print("\n".join(map(printable, text.split("\n"))), style=style)


def say_warnings(lines: Iterable[str]) -> None:
    """Print warnings, a line each, beside what a command prints."""
    for line in lines:
        print(f"jointwave: warning: {printable(line)}", file=sys.stderr)


def show_table(columns: list[str], rows: list[list[str]], styles: Sequence[str] = ()) -> None:
    """Print a table of text, folded to the terminal's width; `styles` are those of the rows."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    for column in columns:
        table.add_column(printable(column), overflow="fold")
    for row, style in zip_longest(rows, styles, fillvalue=""):
        table.add_row(*map(printable, row), style=style or None)
    _console().print(table)


def show_numbers(columns: list[str], groups: dict[str, list[list[str]]]) -> None:
    """Print a table of numbers under group headings; text comes first in a row, never folded.

    A terminal that is too narrow wraps whole lines, which can still be read and copied.
    """
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0))
    for i, column in enumerate(columns):
        table.add_column(printable(column), no_wrap=True, justify="right" if i else "left")
    for heading, rows in groups.items():
        table.add_row(Text(printable(heading), style="bold"))
        for row in rows:
            table.add_row(*map(printable, row))
    _console(UNFOLDED).print(table, crop=False)


def print_json(value: Any) -> None:
    """Print a value as JSON."""
    # JSON has no nan and no infinity; null says as much. It escapes all but DEL.
    text = json.dumps(json.loads(json.dumps(value), parse_constant=lambda _: None), indent=2)
    print(text.replace("\x7f", "\\u007f"))


def _console(width: int | None = None, stderr: bool = False) -> Any:
    from rich.console import Console

    console = Console(markup=False, highlight=False, emoji=False, stderr=stderr)
    if width or not console.is_terminal:
        console.width = width or WIDEST
    return console
