"""Output on the terminal: progress, readable tables, or JSON.

Titles and names come from files: all text is made `printable`.
"""

import json
import logging
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from itertools import pairwise
from math import inf
from textwrap import fill
from time import monotonic
from typing import TYPE_CHECKING, Any

from rich import progress as rich
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from jointwave.cases.errors import SceneError, printable
from jointwave.cases.files import is_number
from jointwave.compare.engines import in_words
from jointwave.compare.text import cell, grouped, table_cell

if TYPE_CHECKING:
    import pandas as pd

EVERY = "JOINTWAVE_PROGRESS"  # environment variable: s between lines of progress, 0 for none
PIPE = 220  # width of a pipe in characters
TURNED = 4  # most rows of a table that may be transposed
LONGEST = 40  # characters of cells of a column that is not folded


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """Show progress, and messages that the engines log, on standard error.

    On a terminal this is a bar with the remaining time, cleared at the end; elsewhere a line every
    30 s, or as many seconds as the variable `EVERY` says; 0: none.
    """
    every = os.environ.get(EVERY, "30")
    if not (is_number(every) and 0 <= float(every) < inf):
        raise SceneError(EVERY, "", None, f"must be a number of seconds, not {every!r}")
    log, handler = logging.getLogger("jointwave"), logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("jointwave: %(message)s"))
    handler.addFilter(_once())
    before = log.level
    if float(every):
        log.addHandler(handler)
        log.setLevel(logging.INFO)
    try:
        if (console := _console(stderr=True)).is_terminal:
            columns = *rich.Progress.get_default_columns(), rich.TextColumn("left")
            with rich.Progress(*columns, console=console, transient=True) as bar:
                task = bar.add_task(escape(printable(label)), total=1.0)
                yield lambda fraction: bar.update(task, completed=fraction)
        else:
            yield _lines(label, float(every))
    finally:
        log.setLevel(before)
        log.removeHandler(handler)


def _once() -> Callable[[logging.LogRecord], bool]:
    """Return a filter that passes each message once."""
    passed: set[str] = set()

    def is_new(record: logging.LogRecord) -> bool:
        count = len(passed)
        passed.add(record.getMessage())
        return len(passed) > count

    return is_new


def _lines(label: str, every: float) -> Callable[[float], None]:
    """Return a function that prints a line of progress if the last is at least `every` s old."""
    began = last = monotonic()

    def advance(fraction: float) -> None:
        nonlocal last
        if every and (now := monotonic()) - last >= every:
            last = now
            line = f"{printable(label)}: {fraction:.0%} after {now - began:.0f} s"
            with suppress(OSError, ValueError):  # standard error may be closed
                print(f"jointwave: {line}", file=sys.stderr, flush=True)

    return advance


def say(text: str, style: str = "") -> None:
    """Print a line of text, or several."""
    _console().print("\n".join(map(printable, text.split("\n"))), style=style)


def say_wrapped(text: str, indent: str) -> None:
    """Print text wrapped to the terminal's width; all lines except the first are indented."""
    width = _console().width
    say(fill(text, width, subsequent_indent=indent, break_on_hyphens=False))


def say_warnings(lines: Iterable[str]) -> None:
    """Print warnings on standard error, a line each."""
    for line in lines:
        print(f"jointwave: warning: {printable(line)}", file=sys.stderr)


def show_table(columns: list[str], rows: list[list[str]]) -> None:
    """Print a table of text.

    A table wider than the terminal with few rows is transposed. Columns with long cells are folded;
    others are not: a narrow terminal then wraps whole lines, which can still be read and copied.
    """
    room = _console().width
    cells = [[*map(printable, row)] for row in (columns, *rows)]
    if len(rows) <= TURNED and sum(width + 2 for width in _widths(cells)) - 2 > room:
        cells = [list(column) for column in zip(*cells, strict=True)]
    table, widths = Table(box=None, pad_edge=False), _widths(cells)
    for name, width in zip(cells[0], widths, strict=True):
        table.add_column(name, overflow="fold", no_wrap=width <= LONGEST)
    for row in cells[1:]:
        table.add_row(*row)
    needed = sum(min(width, LONGEST) + 2 for width in widths)
    _console(max(room, needed)).print(table, crop=False)


def _widths(cells: list[list[str]]) -> list[int]:
    """Return the length of the longest cell of each column."""
    return [max(map(len, column)) for column in zip(*cells, strict=True)]


def show_frame(table: "pd.DataFrame") -> None:
    """Print a table, if it has rows: row labels first (equal outermost labels once and together,
    long ones above their rows), with names of solutions in words."""
    if table.index.nlevels > 1 and max(map(len, map(str, table.index.unique(0)))) > LONGEST:
        for heading, rows in table.groupby(level=0, sort=False):
            say(str(heading))
            show_frame(rows.droplevel(0))
        return
    table = grouped(table)
    named = table if table.index.names == [None] else table.reset_index()
    columns = [*map(in_words, named.columns)]
    cells = (map(table_cell, row, columns) for row in named.itertuples(False, None))
    rows = [list(map(in_words, row)) for row in cells]
    if table.index.nlevels > 1:
        for before, row in reversed(list(pairwise(rows))):
            row[0] = "" if row[0] == before[0] else row[0]
    if rows:
        show_table(columns, rows)


def show_facts(facts: Mapping[str, Any], labels: Mapping[str, str] | None = None) -> None:
    """Print facts: records by name, or in a list, as a table, others as a line; None and empty ones
    are left out. labels : of facts, with unit, if not their names."""

    def label(name: str) -> str:
        return (labels or {}).get(name, name).replace("_", " ")

    for name, value in facts.items():
        if isinstance(value, Mapping) and any(isinstance(x, Mapping) for x in value.values()):
            value = [{name: key, **(x or {})} for key, x in value.items()]
        if isinstance(value, list):
            keys = list(dict.fromkeys(key for row in value for key in row))
            rows = [[fact(row.get(key)) for key in keys] for row in value]
            if rows:
                show_table([*map(label, keys)], rows)
        elif value not in (None, {}):
            if isinstance(value, Mapping):
                value = {label(key): one for key, one in value.items()}
            say(f"{label(name)}: {fact(value)}")


def fact(value: Any) -> str:
    """Return a fact as text: yes or no, a number, a name, or several of these."""
    match value:
        case None:
            return "-"
        case bool():
            return "yes" if value else "no"
        case int():
            return f"{value:,}"
        case Mapping():
            return "; ".join(f"{key} {fact(one)}" for key, one in value.items())
        case list() | tuple():
            return ", ".join(map(fact, value))
    return cell(value)


def print_json(value: Any) -> None:
    """Print a value as JSON."""
    # JSON has no nan and infinity: null replaces them. json escapes all control characters but DEL.
    text = json.dumps(json.loads(json.dumps(value), parse_constant=lambda _: None), indent=2)
    print(text.replace("\x7f", "\\u007f"))


def _console(width: int | None = None, stderr: bool = False) -> Console:
    console = Console(markup=False, highlight=False, emoji=False, stderr=stderr)
    if width or not console.is_terminal:
        console.width = width or PIPE
    return console
