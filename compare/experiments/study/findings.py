"""The findings of a study, as sentences made of its numbers."""

from math import isfinite, isnan

from compare.experiments.study.measure import PointRow
from compare.experiments.study.pareto import (
    Cheapest,
    cheapest,
    digits_per_second,
    floor,
    most_digits_per_second,
)
from compare.experiments.study.study import FineRun, Study
from compare.report.tables import percent


def sentences(study: Study, rows: list[PointRow]) -> list[str]:
    """Return the findings of a timed study: what is cheapest within each misfit, and how much more
    the next best curve takes; what gives the most digits a second; where errors cancel; and how
    well the finest physics is known, where it is a fine run."""
    if not study.timed or all(isnan(row.total) for row in rows):
        return []
    found = [_cheapest(target) for target in cheapest(rows)]
    if best := most_digits_per_second(rows):
        found.append(
            f"The most digits a second, {digits_per_second(best):.2g}, are those of {best.curve} "
            f"at {percent(best.held)} %."
        )
    found += _cancelling([row for row in rows if row.cancels])
    if isinstance(study.finest, FineRun):
        found.append(
            f"The finest physics is a fine run of {study.finest.method}; a coarser one is "
            f"{percent(floor(rows, 'total'))} % from it."
        )
    failed = [row for row in rows if row.state == "failed"]
    if failed:
        found.append(f"{len(failed)} of {len(rows)} points failed; they are listed in the table.")
    return found


def _cheapest(target: Cheapest) -> str:
    row, other = target.row, target.next_best
    text = (
        f"Within {percent(target.misfit)} % of the finest physics the cheapest is {row.curve} "
        f"({_errors(row)}; {_costs(row)})"
    )
    if other is None:
        return f"{text}; no other curve reaches it."
    times = f"{other.seconds / row.seconds:.3g} times as long"
    return (
        f"{text}; the next best, {other.curve} ({_errors(other)}; {_costs(other)}), steps {times}."
    )


def _errors(row: PointRow) -> str:
    """Return the errors of a point, in words that add up."""
    parts = f"numerical {percent(row.numerical)} % + modelling {percent(row.modelling)} %"
    return f"{parts} = {percent(row.total)} %"


def _costs(row: PointRow) -> str:
    """Return what a point costs: each run its set-up and steps, the first one its compiling."""
    named = {"set-up": row.setup, "compiling": row.compile, "stepping": row.seconds}
    said = {name: _seconds(value) for name, value in named.items() if isfinite(value)}
    return ", ".join(f"{name} {value}" for name, value in said.items())


def _seconds(value: float) -> str:
    return f"{value:.2g} s" if value >= 0.1 else f"{max(1e3 * value, 0.1):.2g} ms"


def _cancelling(rows: list[PointRow]) -> list[str]:
    """Return that errors cancel at some points, and where they do so most."""
    near = [row for row in rows if row.measured > 0]
    if not near:
        return []
    most = min(near, key=lambda row: row.measured / row.held)
    return [
        f"At {len(rows)} points errors cancel, or a finer step is worse; they are marked, and "
        f"count for what all finer points of their curve hold: {most.curve} measures "
        f"{percent(most.measured)} % from the finest physics and counts for {percent(most.held)} %."
    ]
