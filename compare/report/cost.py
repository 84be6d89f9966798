"""Cost of each engine's run, timed alone."""

from time import perf_counter

from compare.engines import ENGINES, solve
from compare.misfit.pairs import Comparison

REPEATS = 5
LONG = 0.5  # s: a run that has taken so long is not repeated
ENOUGH = 0.2  # s: of repeats, their set-up included


def seconds(comparison: Comparison) -> dict[str, float]:
    """Return the seconds of stepping of each engine on a variant that it has solved.

    The least of a few repeats, while no other process should be computing; of a run that has
    taken long before, what it took then.
    """
    engines = [name for name in ENGINES if name in comparison.results]
    return {name: _least(name, comparison) for name in engines}


def _least(name: str, comparison: Comparison) -> float:
    known = _stepping(comparison.results[name])
    if known > LONG:
        return known
    found: list[float] = []
    began = perf_counter()
    while not found or (len(found) < REPEATS and perf_counter() - began < ENOUGH):
        found.append(_stepping(solve(name, comparison.scene)))
    return min(found)


def _stepping(result) -> float:
    return float(result.attrs["seconds_stepping"])
