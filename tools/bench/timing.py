"""Rates measured in turn, so that drift of the machine's speed affects all of them equally."""

from collections.abc import Callable
from statistics import median
from time import perf_counter

ROUNDS = 9
SHORTEST = 0.03  # s

#: A function that takes steps and returns their seconds, or None if its whole time counts; and the
#: block-steps or freedom-steps of one call.
Timed = tuple[Callable[[], float | None], int]


def rate(take: Callable[[], float | None], steps: int) -> float:
    """Return steps per second, from as many calls as are needed for timing."""
    calls, spent = 0, 0.0
    while spent < SHORTEST:
        began = perf_counter()
        counted = take()
        calls, spent = calls + 1, spent + (perf_counter() - began if counted is None else counted)
    return calls * steps / spent


def in_turns(*rivals: Timed) -> list[tuple[float, ...]]:
    """Return the rates of all in every round, after one call of each that compiles."""
    for take, _ in rivals:
        take()
    return [tuple(rate(*one) for one in rivals) for _ in range(ROUNDS)]


def in_words(pairs: list[tuple[float, ...]]) -> str:
    """Return as text the medians of two rates, and the median and range of their ratios."""
    one, other = (median(rates) for rates in zip(*pairs, strict=True))
    ratios = [a / b for a, b in pairs]
    least, middle, most = (f"{f(ratios):.2f}" for f in (min, median, max))
    return f"{one:8.2e} over {other:8.2e}: {middle} ({least} to {most})"


def side_by_side(label: str, one: Timed, other: Timed) -> None:
    """Time two functions in turn; print both rates and the ratio one / other."""
    print(f"  {label:42s} {in_words(in_turns(one, other))}", flush=True)
