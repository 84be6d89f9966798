"""The summary of a study: its table, its orders of convergence, its findings, its files."""

from contextlib import nullcontext
from pathlib import Path

from compare.engines import Progress
from compare.experiments.cost.timings import machine
from compare.experiments.study.diagram import write_diagram
from compare.experiments.study.findings import digits_per_second, judged, orders, sentences
from compare.experiments.study.measure import PointRow, measure
from compare.experiments.study.study import Study, StudyPoint, load
from compare.studies import store
from compare.studies.store import Pool, Store, alone
from compare.studies.summary import Summary, frame, number, text_table, write_tables

#: The studies of the report, in its order.
REPORTED = ("free-pillar", "convergence", "uniform-chain", "one-joint")
CANCELS = "×"
COLUMNS = [
    *("point", "numerical, %", "modelling, %", "sum, %", "measured, %", "steps", "work", "kB"),
    *("set-up, s", "compiling, s", "stepping, s", "±", "digits/s"),
]
LEGEND = (
    "Sum: numerical and modelling error with what their references are not known to; it counts. "
    f"Measured: from the finest physics; {CANCELS} where errors cancel, or a finer point is worse."
)


def summarise(folder: Path, name: str, study: Study, rows: list[PointRow]) -> Summary:
    """Return the summary of a study; write NAME.csv, NAME.nc and the diagram into `folder`."""
    table = frame(rows, PointRow)
    data = table.rename_axis("point").to_xarray()
    data = data.assign_attrs(title=study.title, study=study.model_dump_json(), **machine())
    files = write_tables(folder, name, table, data)
    figure = write_diagram(folder, name, study, rows)
    files += figure.drawings if figure else []
    found = orders(study, rows)
    in_words = [
        f"{one.curve}: order {one.measured:.2f} with {one.key}, in theory {one.theory:g}."
        for one in found
    ]
    return Summary(
        name,
        study.title,
        text_table(COLUMNS, ((row.curve, cells(row)) for row in rows)),
        sentences(study, rows) + in_words,
        [
            f"{', '.join(filter(None, [r.curve, _settings(r)]))}: {r.message}"
            for r in rows
            if r.state == "failed"
        ],
        files,
        {"rows": rows, "orders": found, "files": [str(file) for file in files]},
        figure,
        study.note,
        LEGEND if any(row.total == row.total for row in rows) else "",
        study.quantity or "",
        study.timed,
    )


def reported(
    out: Path,
    names: tuple[str, ...] = REPORTED,
    progress: Progress | None = None,
    pool: Pool | None = None,
) -> list[tuple[Path, str, Study, list[PointRow]]]:
    """Run studies one after the other, because they are timed; return the arguments of `summarise`
    for each. Points are saved in `out`."""
    measured, folder = [], out / "studies"
    for i, name in enumerate(names):
        study = load(name)
        measured.append((folder, name, study, run(study, folder / name, pool)))
        if progress:
            progress((i + 1) / len(names))
    return measured


def cells(row: PointRow) -> list[str]:
    """Return a row as text, under `COLUMNS`."""
    return [
        _settings(row) or "base scene",
        *(number(100 * error, ".3g") for error in (row.numerical, row.modelling, row.total)),
        number(100 * row.measured, ".3g") + (f" {CANCELS}" if row.cancels else ""),
        number(row.steps, ".0f"),
        number(row.work, ".2e"),
        number(row.bytes / 1e3, ".3g"),
        number(row.setup, ".2g"),
        number(row.compile, ".2g"),
        number(row.seconds, ".3g"),
        number(row.spread, ".1g"),
        number(digits_per_second(row), ".3g"),
    ]


def _settings(row: PointRow) -> str:
    return ", ".join(f"{k.rpartition('.')[2]} {v}" for k, v in row.settings.items())


def run(
    study: Study, folder: Path, pool: Pool | None = None, progress: Progress | None = None
) -> list[PointRow]:
    """Return the rows of all points of a study, in its order; they are saved in `folder`.

    Points of a timed study are run one at a time in this process, regardless of `pool`, and only
    one timed study runs on a machine at a time.
    """
    rows: Store[PointRow] = Store(PointRow, folder)
    with alone() if study.timed else nullcontext():
        pool = None if study.timed else pool
        return judged(rows.compute(study.points(), key, measure, pool, progress, rate(study)))


def rate(study: Study) -> str:
    """Return the key of the timings of a study's points."""
    return f"point of {study.title}"


def key(point: StudyPoint) -> str:
    """Return the key of a point: everything that determines its row."""
    study = point.study.model_dump(mode="json", exclude={"title", "curves"})
    return store.key(study, point.curve.model_dump(mode="json"), point.settings)
