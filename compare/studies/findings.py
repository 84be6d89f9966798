"""What a study shows, as sentences made of its numbers."""

from compare.studies.measure import Row
from compare.studies.pareto import cheapest
from compare.studies.study import Study
from compare.tables import percent


def sentences(study: Study, rows: list[Row]) -> list[str]:
    """Return the findings of a timed study: what is cheapest within each misfit, and how much more
    the dearest that reaches it takes; and where every model's error ends."""
    if not study.timed or study.finest is None:
        return []
    found = [_cheapest(rows, target.misfit, target.row) for target in cheapest(rows)]
    failed = [row for row in rows if row.state == "failed"]
    if failed:
        found.append(f"{len(failed)} of {len(rows)} points failed; they are listed in the table.")
    return found


def _cheapest(rows: list[Row], misfit: float, row: Row) -> str:
    others: dict[str, float] = {}
    for other in rows:
        if other.state == "done" and other.total <= misfit and other.curve != row.curve:
            least = others.get(other.curve, float("inf"))
            others[other.curve] = min(least, other.seconds / row.seconds)
    text = (
        f"Within {percent(misfit)} % of the finest physics the cheapest is {row.curve} "
        f"({percent(row.total)} %)"
    )
    if not others:
        return f"{text}; no other curve reaches it."
    last = max(others, key=lambda curve: others[curve])
    times = f"{others[last]:.3g} times as long"
    return f"{text}; the dearest of {len(others)} others, {last}, takes {times}."
