"""Comparison with other codes on the free pillar, from the table that `make bench-peers` writes.

Every row is a run of a whole process on one core; runs of jointwave and other codes alternate.
"""

import io
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from jointwave.cases.errors import SceneError
from jointwave.cases.files import read_text
from jointwave.compare.figures.export import blank, save
from jointwave.compare.studies.experiment import Summary
from jointwave.compare.text import span

PLACE = Path("out/peers/points.csv")  # where `make bench-peers` writes
LARGEST_FILE = 1_000_000  # bytes; the table has a row for each run
TITLE = "The free pillar in other codes"
LEGEND = "Over ours: seconds over those of our run that it is compared with, median."
TEXTS = ("curve", "solves", "settings", "state", "message", "beside", "machine")
NUMBERS = {  # columns of the file, and their headings on the page
    "misfit": "own model (%)",
    "total_misfit": "finest physics (%)",
    "stepping_over_ours": "stepping over ours",
    "whole_over_ours": "whole process over ours",
    "seconds": "stepping (s)",
    "whole": "whole process (s)",
    "rate": "freedom-steps a second",
}


def read(file: Path | None) -> pd.DataFrame | None:
    """Return the table of a file; None: of the default file, None if that does not exist.

    Raises SceneError if the file cannot be read or is no such table.
    """
    path = file or PLACE
    if file is None and not path.is_file():
        return None
    try:
        types = dict.fromkeys(TEXTS, str) | dict.fromkeys(NUMBERS, float)
        text = io.StringIO(read_text(path, LARGEST_FILE))
        table = pd.read_csv(text, dtype=types, usecols=list(types))
    except ValueError as error:
        raise SceneError(
            str(path), "", None, f"is not a table of make bench-peers: {error}"
        ) from error
    return table.fillna(dict.fromkeys(TEXTS, ""))


def summarise(found: pd.DataFrame, folder: Path) -> Summary:
    """Return the summary of all runs, with failures; draw the figure into `folder`."""
    done, missing = found[found.state == "done"], found[found.state != "done"]
    failed = [f"{one.curve} ({one.solves}): {one.message}" for one in missing.itertuples()]
    machine = "; ".join(dict.fromkeys(filter(None, found.machine))) or "an unnamed machine"
    figure = save(_draw(done), folder, "peers", TITLE, found)
    point = done.settings.str.replace(r'[{}"]', "", regex=True).str.replace("_", " ")
    table = done[list(NUMBERS)].rename(columns=NUMBERS)
    table[["own model (%)", "finest physics (%)"]] *= 100
    table = table.set_index([(done.curve + ": " + done.solves).rename("curve"), point])
    shown = table, sentences(done), failed, figure.drawings
    return Summary("peers", TITLE, *shown, figure=figure, legend=LEGEND, about=machine)


def sentences(done: pd.DataFrame) -> list[str]:
    """Return for each other code its time over ours, in a sentence."""
    groups = done[done.stepping_over_ours.notna()].groupby("curve", sort=False)
    found = [
        f"{curve} beside {rows.beside.iloc[0]}: stepping {span(rows.stepping_over_ours)} times, "
        f"whole process {span(rows.whole_over_ours)} times as long, with equal mesh and step."
        for curve, rows in groups
    ]
    return found or ["No other code ran: there is nothing to compare with."]


def _draw(done: pd.DataFrame) -> Figure:
    with blank(4.0) as figure:
        axes = figure.subplots()
        for (curve, solves), rows in done.groupby(["curve", "solves"], sort=False):
            axes.loglog(rows.whole, 100 * rows.total_misfit, "o-", label=f"{curve}: {solves}")
        axes.set_xlabel(NUMBERS["whole"])
        axes.set_ylabel("misfit from the finest physics, %")
        if len(done):
            axes.legend(loc="center left", bbox_to_anchor=(1, 0.5), frameon=False)
    return figure
