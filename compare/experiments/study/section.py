"""A study's section of the report: its diagrams, its table, and what it shows."""

from pathlib import Path
from typing import NamedTuple

from compare.engines import Progress
from compare.experiments.study.diagram import draw
from compare.experiments.study.findings import sentences
from compare.experiments.study.measure import Row
from compare.experiments.study.orders import orders
from compare.experiments.study.runner import run
from compare.experiments.study.show import COLUMNS, cells, sentence
from compare.experiments.study.study import load
from compare.experiments.study.table import machine, write_table
from compare.figures.export import Drawn, save
from compare.report.tables import Table

#: The studies of the report, in its order.
REPORTED = ("free-pillar", "convergence", "uniform-chain")


class StudySection(NamedTuple):
    """One study of the page; `name` is that of its files, `quantity` that of its misfits, "" where
    all count."""

    name: str
    title: str
    note: str
    quantity: str
    timed: bool
    figure: Drawn
    sentences: list[str]
    table: Table
    failed: list[str]


def make_sections(
    out: Path, names: tuple[str, ...] = REPORTED, progress: Progress | None = None
) -> list[StudySection]:
    """Run studies one after the other, here and alone; write figures and tables into `out`."""
    found = []
    for i, name in enumerate(names):
        found.append(_section(out / "studies", name))
        if progress:
            progress((i + 1) / len(names))
    return found


def _section(folder: Path, name: str) -> StudySection:
    study = load(name)
    rows = run(study, folder / name)
    write_table(folder, name, study, rows)
    figure = save(draw(name, study, rows), folder, name, study.title)
    said = sentences(study, rows) + [sentence(order) + "." for order in orders(study, rows)]
    failed = [f"{row.curve}: {row.message}" for row in rows if row.state == "failed"]
    about = study.title, study.note, study.quantity or "", study.timed
    return StudySection(name, *about, figure, said, _table(rows), failed)


def _table(rows: list[Row]) -> Table:
    groups: dict[str, list[list[str]]] = {}
    for row in rows:
        groups.setdefault(row.curve, []).append(cells(row))
    return Table(COLUMNS, groups)


def measured_on() -> str:
    """Return the machine that seconds were measured on, in words."""
    about = machine()
    return f"{about['processor']}, {about['cores']} cores, numba {about['numba']}"
