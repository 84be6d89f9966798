"""What a study has found, on the terminal."""

from math import isfinite, isnan
from pathlib import Path

from compare.cli.terminal import print_json, say, show_numbers
from compare.experiments.study.findings import sentences
from compare.experiments.study.measure import Row
from compare.experiments.study.orders import Order, orders
from compare.experiments.study.pareto import digits_per_second
from compare.experiments.study.study import Study

CANCELS = "×"
COLUMNS = [
    *("point", "numerical, %", "modelling, %", "sum, %", "measured, %", "steps", "work", "kB"),
    *("set-up, s", "compiling, s", "stepping, s", "±", "digits/s"),
]
LEGEND = (
    "Sum: numerical and modelling error with what their references are not known to; it counts. "
    f"Measured: from the finest physics; {CANCELS} where errors cancel, or a finer point is worse."
)


def show_study(study: Study, rows: list[Row], files: tuple[Path, ...], as_json: bool) -> None:
    """Print the table of a study, its orders, and what failed."""
    found = orders(study, rows)
    if as_json:
        print_json(
            {
                "rows": [_without_nan(row._asdict()) for row in rows],
                "orders": [_without_nan(order._asdict()) for order in found],
                "files": [str(file) for file in files],
            }
        )
        return
    groups: dict[str, list[list[str]]] = {}
    for row in rows:
        groups.setdefault(row.curve, []).append(cells(row))
    show_numbers(COLUMNS, groups)
    if any(isfinite(row.total) for row in rows):
        say(LEGEND)
    for line in [sentence(order) for order in found] + sentences(study, rows):
        say(line)
    for row in rows:
        if row.state == "failed":
            say(f"failed: {row.curve}, {_settings(row)}: {row.message}")
    if study.note:
        say(study.note)
    say(f"written: {', '.join(map(str, files))}")


def _without_nan(facts: dict) -> dict:
    """Return facts as JSON can say them."""
    return {k: None if isinstance(v, float) and isnan(v) else v for k, v in facts.items()}


def sentence(order: Order) -> str:
    """Return what was measured beside what theory says."""
    return f"{order.curve}: order {order.measured:.2f} with {order.key}, in theory {order.theory:g}"


def cells(row: Row) -> list[str]:
    """Return a row as text, under `COLUMNS`."""
    return [
        _settings(row) or "as it stands",
        _number(100 * row.numerical, ".3g"),
        _number(100 * row.modelling, ".3g"),
        _number(100 * row.total, ".3g"),
        _number(100 * row.measured, ".3g") + (f" {CANCELS}" if row.cancels else ""),
        _number(row.steps, ".0f"),
        _number(row.work, ".2e"),
        _number(row.bytes / 1e3, ".3g"),
        _number(row.setup, ".2g"),
        _number(row.compile, ".2g"),
        _number(row.seconds, ".3g"),
        _number(row.spread, ".1g"),
        _number(digits_per_second(row), ".3g"),
    ]


def _settings(row: Row) -> str:
    return ", ".join(f"{k.rpartition('.')[2]} {v}" for k, v in row.settings.items())


def _number(value: float, form: str) -> str:
    return f"{value:{form}}" if isfinite(value) else ""
