"""The terminal: progress, tables that stay readable, or JSON.

Titles and names come from others: no text gets here that is not `printable`.
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
from jointwave.compare.text import cell, table_cell

if TYPE_CHECKING:
    import pandas as pd

EVERY = "JOINTWAVE_PROGRESS"  # in the environment: s from one line to the next, 0 for none
PIPE, UNFOLDED = 220, 10_000  # characters: of a pipe, which has no width, and of short cells
TURNED = 4  # rows: tables of more are not turned
LONGEST = 40  # characters of a cell that is not folded


@contextmanager
def progress(label: str) -> Iterator[Callable[[float], None]]:
    """Show on standard error what is being done, while it runs, and what the engines log.

    On a terminal a bar, with the time that it took and the time that is left, cleared at the end;
    elsewhere a line every half minute, or as many seconds as `EVERY` says; 0: none.
    """
    every = os.environ.get(EVERY, "30")
    if not (is_number(every) and 0 <= float(every) < inf):
        raise SceneError(EVERY, "", None, f"must be a number of seconds, not {every!r}")
    log, handler = logging.getLogger("jointwave"), logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("jointwave: %(message)s"))
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


def _lines(label: str, every: float) -> Callable[[float], None]:
    """Return what prints a line of progress where the last one is so many seconds old."""
    began = told = monotonic()

    def advance(fraction: float) -> None:
        nonlocal told
        if every and (now := monotonic()) - told >= every:
            told = now
            line = f"{printable(label)}: {fraction:.0%} after {now - began:.0f} s"
            with suppress(OSError, ValueError):  # nobody may be there to read it
                print(f"jointwave: {line}", file=sys.stderr, flush=True)

    return advance


def say(text: str, style: str = "") -> None:
    """Print a line of text, or several."""
    _console().print("\n".join(map(printable, text.split("\n"))), style=style)


def say_wrapped(text: str, indent: str) -> None:
    """Print a text in lines no longer than the terminal's, all but the first indented."""
    width = _console().width
    say(fill(text, width, subsequent_indent=indent, break_on_hyphens=False))


def say_warnings(lines: Iterable[str]) -> None:
    """Print warnings, a line each, beside what a command prints."""
    for line in lines:
        print(f"jointwave: warning: {printable(line)}", file=sys.stderr)


def show_table(columns: list[str], rows: list[list[str]]) -> None:
    """Print a table of text.

    A table that is wider than the terminal and has few rows is turned: its columns become rows.
    Long cells are folded to the terminal's width. Short ones are not: a terminal that is too narrow
    wraps whole lines, which can still be read and copied.
    """
    widths = (max(map(len, column)) + 2 for column in zip(columns, *rows, strict=True))
    if len(rows) <= TURNED and sum(widths) - 2 > _console().width:
        (first, *columns), *rows = map(list, zip(columns, *rows, strict=True))
        columns = [first, *columns]
    is_short = all(len(text) <= LONGEST for row in rows for text in row)
    table = Table(box=None, pad_edge=False)
    for column in columns:
        table.add_column(printable(column), overflow="fold", no_wrap=is_short)
    for row in rows:
        table.add_row(*map(printable, row))
    _console(UNFOLDED if is_short else None).print(table, crop=False)


def show_frame(table: "pd.DataFrame") -> None:
    """Print a table, if it has rows; what labels them comes first, an outermost label once;
    solutions and pairs of them are in words. Long labels stand above the rows that have them."""
    if table.index.nlevels > 1 and max(map(len, map(str, table.index.unique(0)))) > LONGEST:
        for heading, rows in table.groupby(level=0, sort=False):
            say(str(heading))
            show_frame(rows.droplevel(0))
        return
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
    """Print facts: records by name, or in a list, as a table, all others as a line; nothing of what
    is None or empty. labels : what a fact is called, with its unit, where not by its own name."""

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
    """Return a fact as text: a yes or no, a number, a name, or several of them."""
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
    # JSON has no nan and no infinity; null says as much. It escapes all but DEL.
    text = json.dumps(json.loads(json.dumps(value), parse_constant=lambda _: None), indent=2)
    print(text.replace("\x7f", "\\u007f"))


def _console(width: int | None = None, stderr: bool = False) -> Console:
    console = Console(markup=False, highlight=False, emoji=False, stderr=stderr)
    if width or not console.is_terminal:
        console.width = width or PIPE
    return console
