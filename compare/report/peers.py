"""Other codes beside ours on the free pillar: the table that `make bench-peers` writes, as curves,
cells and sentences.

Every row is a run of a whole process on one core; ours are among them, taken in turns with theirs.
"""

import io
import json
from math import isfinite, nan
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from cases.errors import SceneError
from cases.files import read_text
from compare.experiments.study.diagram import draw as draw_study
from compare.experiments.study.findings import assured
from compare.experiments.study.study import Curve, Study
from compare.figures.export import save
from compare.runs.output import write_csv
from compare.solvers.continuum import EQUIVALENT_ROCK, JOINTED_ROCK
from compare.solvers.dem import DEM
from compare.studies.summary import Summary, text_table
from compare.text import percent

PLACE = Path("out/peers/points.csv")  # where `make bench-peers` writes
NAME = "peers"
TEXTS = ("curve", "settings", "state", "message", "solves", "beside")
NUMBERS = (
    *("misfit", "total_misfit", "seconds", "whole", "rate", "work"),
    *("stepping_over_ours", "whole_over_ours"),
)
NEEDED = (*TEXTS, *NUMBERS)
LARGEST_FILE = 1_000_000  # bytes; the table has a row for each run
HEADER = [
    "point",
    "own model, %",
    "finest physics, %",
    "stepping over ours",
    "whole process over ours",
    "stepping (s)",
    "whole process (s)",
    "freedom-steps a second",
]
COSTS = {"seconds": "seconds of stepping", "whole": "seconds of the whole process"}
OURS = {  # jointwave's curves have the colours of their engines
    "jointwave blocks": DEM.name,
    "jointwave blocks in space": DEM.name,
    "jointwave bar": EQUIVALENT_ROCK.name,
    "jointwave hexahedra": EQUIVALENT_ROCK.name,
    "jointwave hexahedra of order 2": EQUIVALENT_ROCK.name,
    "jointwave jointed bar": JOINTED_ROCK.name,
}


def read(file: Path | None) -> pd.DataFrame | None:
    """Return the table of a file, or of where it is written; None where there is none.

    Raises SceneError where the file that is named cannot be read or is no such table.
    """
    path = file or PLACE
    if file is None and not path.is_file():
        return None
    try:
        table = pd.read_csv(io.StringIO(read_text(path, LARGEST_FILE)))
    except ValueError as error:
        raise SceneError(str(path), "", None, f"cannot be read: {error}") from error
    if fault := _fault(table):
        raise SceneError(str(path), "", None, f"is not a table of make bench-peers: {fault}")
    return table


def _fault(table: pd.DataFrame) -> str:
    """Return what is wrong with a table, or nothing."""
    for name in NEEDED:
        if name not in table:
            return f"it has no column {name}"
    for name in NUMBERS:
        if not pd.api.types.is_numeric_dtype(table[name]):
            return f"its column {name} does not hold numbers"
    for row in table[table["state"] == "done"].to_dict("records"):
        try:
            dict(json.loads(row["settings"]))
        except (TypeError, ValueError, RecursionError):
            return f"its settings {str(row['settings'])[:60]!r} are not a JSON object"
        if not all(isinstance(row[name], str) for name in ("curve", "solves")):
            return "a run lacks its curve or what it solves"
    return ""


def write_section(folder: Path, found: pd.DataFrame, name: str = NAME) -> Summary:
    """Write NAME.csv and the diagram into `folder`; return the section, `about` its machine."""
    file = write_csv(folder / f"{name}.csv", found)
    title, rows = "The free pillar in other codes", found.to_dict("records")
    figure = save(draw(name, title, rows), folder, name, title)
    missing = [
        f"{row['curve']} ({row['solves']}): {row['state']}, {row['message']}"
        for row in rows
        if row["state"] != "done"
    ]
    machines = found["machine"].dropna().unique() if "machine" in found else []
    machine = "; ".join(machines) or "an unnamed machine"
    files = [file, figure.file("svg")]
    return Summary(
        name, title, table(found), sentences(found), missing, files, rows, figure, about=machine
    )


def table(found: pd.DataFrame) -> pd.DataFrame:
    """Return every run, those of a curve under what it solves; a missing peer says why."""
    rows = []
    for row in found.to_dict("records"):
        undone = [f"{row['state']}: {row['message']}", *[""] * (len(HEADER) - 1)]
        cells = _cells(row) if row["state"] == "done" else undone
        rows.append((_label(row), cells))
    return text_table(HEADER, rows)


def _cells(row: dict) -> list[str]:
    settings = ", ".join(f"{k} {v}" for k, v in json.loads(row["settings"]).items())
    return [
        settings.replace("_", " "),
        *(percent(row[name]) for name in ("misfit", "total_misfit")),
        *(_ratio(row, name) for name in ("stepping", "whole")),
        *(f"{row[name]:.2g}" for name in ("seconds", "whole", "rate")),
    ]


def _ratio(row: dict, kind: str) -> str:
    value = row[f"{kind}_over_ours"]
    if not isfinite(value):
        return ""
    least, most = row.get(f"{kind}_over_ours_least"), row.get(f"{kind}_over_ours_most")
    spread = "" if least is None or most is None else f" ({least:.3g} to {most:.3g})"
    return f"{value:.3g}{spread}"


def sentences(found: pd.DataFrame) -> list[str]:
    """Return over all peers, then for each, how many times as long as ours they take."""
    held = found[(found["state"] == "done") & found["stepping_over_ours"].notna()]
    if held.empty:
        return ["No other code ran: there is nothing to compare with."]
    over = held["stepping_over_ours"]
    low, high = held.loc[over.idxmin()], held.loc[over.idxmax()]
    whole = held["whole_over_ours"]
    said = [
        f"On the same chain or mesh, at the same step, stepping takes {over.min():.3g} "
        f"({low['curve']}) to {over.max():.3g} times ({high['curve']}) as long as here; the whole "
        f"process, start-up included, {whole.min():.2g} to {whole.max():.2g} times."
    ]
    for curve, rows in held.groupby("curve", sort=False):
        said.append(
            f"{curve} beside {rows['beside'].iloc[0]}: stepping {_span(rows['stepping_over_ours'])}"
            f" times, whole process {_span(rows['whole_over_ours'])} times as long."
        )
    return said


def _span(values: pd.Series) -> str:
    low, high = (f"{x:.3g}" if x >= 100 else f"{x:.2g}" for x in (values.min(), values.max()))
    return low if low == high else f"{low} to {high}"


def draw(name: str, title: str, rows: list[dict[str, Any]]) -> Figure:
    """Return the diagram of the completed rows, each curve with its equations."""
    done = [row for row in rows if row["state"] == "done"]
    methods = {_label(row): OURS.get(row["curve"], row["curve"]) for row in done}
    curves = [Curve(label=label, method=method) for label, method in methods.items()]
    study = Study(title=title, scene="", timed=True, curves=curves)
    points: Any = [_point(row) for row in done]
    for point, error in zip(points, assured(points, "total"), strict=True):
        point.held = error
    return draw_study(name, study, points, COSTS)


def _label(row: dict[str, Any]) -> str:
    return f"{row['curve']}: {row['solves']}"


def _point(row: dict[str, Any]) -> SimpleNamespace:
    """Return a row of the table as a row of a study, for the diagram."""
    counted = ("freedoms", "steps", "seconds", "whole", "work")
    return SimpleNamespace(
        curve=_label(row),
        state="done",
        settings={},
        numerical=float(row.get("misfit", nan)),
        total=float(row.get("total_misfit", nan)),
        measured=nan,
        cancels=False,
        numerical_floor=0.0,
        total_floor=0.0,
        **{name: float(row.get(name, nan)) for name in counted},
    )
