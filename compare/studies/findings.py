"""What a study shows, as sentences made of its numbers."""

from compare.studies.measure import Row
from compare.studies.pareto import cheapest, digits_per_second, floor, most_digits_per_second
from compare.studies.study import Reference, Study
from compare.tables import percent


def sentences(study: Study, rows: list[Row]) -> list[str]:
    """Return the findings of a timed study: what is cheapest within each misfit, and how much more
    the dearest that reaches it takes; what gives the most digits a second; and how well the finest
    physics is known, where it is a fine run."""
    if not study.timed or study.finest is None:
        return []
    found = [_cheapest(rows, target.misfit, target.row) for target in cheapest(rows)]
    if best := most_digits_per_second(rows):
        found.append(
            f"The most digits a second, {digits_per_second(best):.2g}, are those of {best.curve} "
            f"at {percent(best.total)} %."
        )
    if isinstance(study.finest, Reference):
        found.append(
            f"The finest physics is a fine run of {study.finest.method}; a coarser one is "
            f"{percent(floor(rows, 'total'))} % from it."
        )
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
