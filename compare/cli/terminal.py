"""The terminal: progress, tables that stay readable, or JSON.

Titles and names come from others: no text gets here that is not `printable`.
"""

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import zip_longest
from typing import Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table
from rich.text import Text

from cases.errors import printable

WIDEST = 220  # a pipe has no width to respect: a machine or a log gets whole lines


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """Show a bar on standard error while something runs, and clear it at the end.

    With what is done, the time that it took and the time that is left; on a terminal only.
    """
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    console = Console(stderr=True)
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal
    ) as bar:
        task = bar.add_task(printable(label), total=1.0)
        yield lambda fraction: bar.update(task, completed=fraction)


def say(text: str, style: str = "") -> None:
    """Print a line of text, or several."""
    _console().print("\n".join(map(printable, text.split("\n"))), style=style)


def show_table(columns: list[str], rows: list[list[str]], styles: Sequence[str] = ()) -> None:
    """Print a table of text, folded to the terminal's width; `styles` are those of the rows."""
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
    table = Table(box=None, pad_edge=False, padding=(0, 1, 0, 0))
    for i, column in enumerate(columns):
        table.add_column(printable(column), no_wrap=True, justify="right" if i else "left")
    for heading, rows in groups.items():
        table.add_row(Text(printable(heading), style="bold"))
        for row in rows:
            table.add_row(*map(printable, row))
    console = _console()
    wide = console.options.update_width(WIDEST)
    console.width = max(console.width, console.measure(table, options=wide).maximum)
    console.print(table, crop=False)


def print_json(value: Any) -> None:
    """Print a value as JSON."""
    # JSON has no nan and no infinity; null says as much. It escapes all but DEL.
    text = json.dumps(json.loads(json.dumps(value), parse_constant=lambda _: None), indent=2)
    print(text.replace("\x7f", "\\u007f"))


def _console() -> Console:
    plain: dict[str, Any] = {"markup": False, "highlight": False, "emoji": False}
    console = Console(**plain)
    return console if console.is_terminal else Console(width=WIDEST, **plain)
