"""Where an engine stands on a scene: its misfits, what they cost, and the verdict in one word."""

from __future__ import annotations

from collections.abc import Iterable
from math import isfinite, isnan, nan
from typing import NamedTuple

from compare.engines import ENGINES
from compare.metrics import misfit
from compare.pairs import NUMERICAL, PAIRS, Comparison

#: What knows the physics of a scene best, the first that is there: elastic rock with every joint,
#: exact before computed, then one mechanism alone, then rigid blocks.
FINEST = (
    *("jointed-bar", "continuum-jointed", "slip-joint", "sliding-block", "no-tension-chain"),
    *("spatial-lattice", "lattice", "kelvin-voigt", "equivalent-bar"),
)


class Verdict(NamedTuple):
    """A word and a sign; `grade` is how it is coloured, "a" (best) to "d", "x" for a failure."""

    sign: str
    word: str
    grade: str


#: By the misfit from the finest physics that each is given up to.
VERDICTS = (
    (0.01, Verdict("✓", "agrees", "a")),
    (0.05, Verdict("≈", "close", "b")),
    (0.20, Verdict("△", "differs", "c")),
    (float("inf"), Verdict("▲", "far off", "d")),
)
UNKNOWN = Verdict("?", "not known", "n")
BROKEN = Verdict("✗", "out of bounds", "x")


class Standing(NamedTuple):
    """One engine on all variants of a scene, each misfit the largest of them.

    own : from the exact solution of the engine's own model. total : from the finest physics, whose
    names are `finest`. broken : bounds of [expect] not met.
    """

    own: float
    total: float
    finest: tuple[str, ...]
    broken: tuple[str, ...]

    @property
    def verdict(self) -> Verdict:
        """What the numbers come to."""
        if self.broken:
            return BROKEN
        if isnan(self.total):
            return UNKNOWN
        return next(verdict for most, verdict in VERDICTS if self.total <= most)


def standings(comparisons: list[Comparison]) -> dict[str, Standing]:
    """Return where each engine stands that has run on some variant."""
    found = {}
    for engine in ENGINES:
        own = [c for c in comparisons if engine in c.results]
        if own:
            found[engine] = _standing(engine, own)
    return found


def _standing(engine: str, comparisons: list[Comparison]) -> Standing:
    finest = [finest_of(c) for c in comparisons]
    pairs = zip(comparisons, finest, strict=True)
    return Standing(
        _largest(_own(engine, c) for c in comparisons),
        _largest(_apart(c, engine, name) for c, name in pairs if name != engine),
        tuple(dict.fromkeys(name for name in finest if name != engine)),
        tuple(text for c in comparisons for text in _broken(engine, c)),
    )


def finest_of(comparison: Comparison) -> str:
    """Return the name of the result that knows the scene's physics best."""
    return next(name for name in (*FINEST, *ENGINES) if name in comparison.results)


def _own(engine: str, comparison: Comparison) -> float:
    """Return the numerical error; nan where no exact solution of the engine's model applies."""
    exact = [p.other for p in PAIRS if p.one == engine and p.kind == NUMERICAL]
    return _largest(_apart(comparison, engine, name) for name in exact)


def _apart(comparison: Comparison, one: str, other: str) -> float:
    """Return a misfit; nan where one of the two is not there, or the other stands still."""
    results = comparison.results
    found = misfit(results[one], results[other]) if other in results else nan
    return found if isfinite(found) else nan


def _broken(engine: str, comparison: Comparison) -> list[str]:
    """Return the pairs of [expect] that an engine is first in and that lie beyond their bound."""
    found = []
    for pair, bound in comparison.scene.expect.items():
        one, other = pair.split(" ~ ")
        if one == engine and _apart(comparison, one, other) > bound:
            found.append(pair)
    return found


def _largest(values: Iterable[float]) -> float:
    known = [x for x in values if not isnan(x)]
    return max(known, default=nan)
