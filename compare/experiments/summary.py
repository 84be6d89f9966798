"""The summary of an experiment, the same for the terminal, the page and JSON."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from compare.cli.terminal import print_json, say, show_numbers
from compare.experiments.store import plain
from compare.figures.export import Drawn
from compare.report.tables import Table


class Summary(NamedTuple):
    """An experiment as it is shown.

    name : of its files, and of its section of the page. table : rows of text under headings.
    sentences : its findings. failed : a line for each row that failed. facts : for a machine.
    note : about all of it. legend : of the table, on the terminal. about : for the caption of the
    figure: what it shows, the quantity of its misfits, or its scenes. timed : whether it has
    seconds.
    """

    name: str
    title: str
    table: Table
    sentences: Sequence[str]
    failed: Sequence[str]
    files: Sequence[Path]
    facts: Any
    figure: Drawn | None = None
    note: str = ""
    legend: str = ""
    about: str = ""
    timed: bool = False


def show(found: Summary, as_json: bool, texts: Sequence[str] = ()) -> None:
    """Print a summary; texts : the columns of the table that are no numbers, beside the first."""
    if as_json:
        print_json(plain(found.facts))
        return
    if found.table.groups:
        show_numbers(found.table.header, found.table.groups, texts)
    for line in filter(None, [found.legend, *found.sentences]):
        say(line)
    for line in found.failed:
        say(f"failed: {line}", "red")
    if found.note:
        say(found.note)
    if found.files:
        say(f"written: {', '.join(map(str, found.files))}")
