"""Verdict on an engine for a scene: its misfits, their cost, and one word."""

from collections.abc import Mapping
from math import isfinite, isnan, nan
from types import MappingProxyType
from typing import Any, NamedTuple

from compare.engines import ENGINES
from compare.figures.panels import variant_names
from compare.misfit.differences import (
    STRESS,
    VELOCITY,
    PeakDifference,
    peak_differences,
    static_difference,
)
from compare.misfit.metrics import Worst, worst
from compare.misfit.pairs import Comparison
from compare.misfit.ranking import kind_of, own_exact, reference_of


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
NOT_CHECKED = Verdict("?", "not checked independently", "n")
BROKEN = Verdict("✗", "out of bounds", "x")
#: From the best to the worst: the worst variant decides.
ORDER = (*(verdict for _, verdict in VERDICTS[:2]), NOT_CHECKED, *(v for _, v in VERDICTS[2:]))

NOTHING = Worst(nan)
STATIC = 0.01  # of the largest static stress: a difference of static states that is said


class Held(NamedTuple):
    """One engine on one variant.

    own : from the exact solution of the engine's own model. total : from the reference, `against`,
    empty where nothing has checked it independently; `reason` says what the reference is, `meaning`
    what their distance is. peaks : "PPV" and "peak stress" beside the reference's. static : of the
    two static states.
    """

    variant: str
    own: Worst
    total: Worst
    against: str
    reason: str
    broken: tuple[str, ...]
    meaning: str = ""
    peaks: Mapping[str, PeakDifference] = MappingProxyType({})
    static: Worst = Worst(0.0)

    @property
    def verdict(self) -> Verdict:
        """What the numbers come to."""
        if self.broken:
            return BROKEN
        if isnan(self.total.judged):
            return NOT_CHECKED
        return next(verdict for most, verdict in VERDICTS if self.total.judged <= most)

    @property
    def static_words(self) -> str:
        """By how much the static state differs from the reference's; "" if by less than 1 %."""
        if not self.static.misfit > STATIC:
            return ""
        off = f"{100 * self.static.misfit:.2g} % of the largest static stress"
        return f"differs from that of {self.against} by {off} ({self.static.where})"

    @property
    def facts(self) -> dict[str, Any]:
        """All of it, machine-readable; None where there is none."""
        named = {VELOCITY: "ppv", STRESS: "peak_stress"}
        peaks = {
            f"{short}_{part}": getattr(self.peaks[name], part) if name in self.peaks else None
            for name, short in named.items()
            for part in ("mean", "worst", "at")
        }
        return {
            "misfit": self.total.misfit,
            "floor": self.total.floor,
            "at": self.total.where if self.total.place else None,
            **peaks,
            "against": self.against or None,
            "reason": self.reason,
            "meaning": self.meaning or None,
            "own_error": self.own.misfit,
            "static_difference": self.static.misfit,
            "verdict": self.verdict.word,
        }


class Standing(NamedTuple):
    """One engine on all variants of a scene."""

    variants: tuple[Held, ...]

    @property
    def own(self) -> float:
        """Largest numerical error; nan where no variant has an exact solution of the model."""
        return _largest(held.own for held in self.variants).judged

    @property
    def total(self) -> float:
        """Largest misfit from the references; nan where no variant has one."""
        return _largest(held.total for held in self.variants).judged

    @property
    def peaks(self) -> dict[str, PeakDifference]:
        """The largest differences of peaks by name."""
        found: dict[str, PeakDifference] = {}
        for name in (VELOCITY, STRESS):
            if there := [held.peaks[name] for held in self.variants if name in held.peaks]:
                found[name] = max(there, key=lambda peak: peak.worst)
        return found

    @property
    def where(self) -> str:
        """The receiver and quantity of the largest misfit."""
        return _largest(held.total for held in self.variants).where

    @property
    def finest(self) -> tuple[str, ...]:
        """The references of the variants."""
        return tuple(dict.fromkeys(held.against for held in self.variants if held.against))

    @property
    def meanings(self) -> tuple[str, ...]:
        """What the distances from the references are."""
        return tuple(dict.fromkeys(held.meaning for held in self.variants if held.meaning))

    @property
    def static_words(self) -> str:
        """By how much the static states differ in the worst variant; "" if by less than 1 %."""
        return max(self.variants, key=lambda held: held.static.misfit).static_words

    @property
    def unchecked(self) -> tuple[str, ...]:
        """The variants that nothing has checked independently."""
        return tuple(held.variant for held in self.variants if isnan(held.total.judged))

    @property
    def broken(self) -> tuple[str, ...]:
        """Bounds of [expect] that are not met."""
        return tuple(text for held in self.variants for text in held.broken)

    @property
    def explanation(self) -> str:
        """What the engine is held against, where nothing checks it, and which bounds are broken."""
        parts = [f"compared with {' and '.join(self.finest)}: {self.where}"] if self.finest else []
        parts += [f"static state {self.static_words}"] if self.static_words else []
        if self.unchecked:
            named = [name for name in self.unchecked if name] if len(self.variants) > 1 else []
            parts.append(": ".join([NOT_CHECKED.word, *([", ".join(named)] if named else [])]))
        if self.broken:
            parts.append(f"exceeds the scene's bound: {', '.join(self.broken)}")
        return "; ".join(parts)

    @property
    def verdict(self) -> Verdict:
        """That of the worst variant."""
        verdicts = [held.verdict for held in self.variants]
        return BROKEN if BROKEN in verdicts else max(verdicts, key=ORDER.index)


def standings(comparisons: list[Comparison]) -> dict[str, Standing]:
    """Return where each engine stands that has run on some variant."""
    found: dict[str, Standing] = {}
    for engine in ENGINES:
        held = [
            held_to(engine, comparison, name)
            for name, comparison in zip(variant_names(comparisons), comparisons, strict=True)
            if engine in comparison.results
        ]
        if held:
            found[engine] = Standing(tuple(held))
    return found


def held_to(engine: str, comparison: Comparison, variant: str = "") -> Held:
    """Return how far an engine is from what it is held against in one variant."""
    names, scene = comparison.results, comparison.scene
    reference = reference_of(engine, names, scene)
    against, reason = reference or ("", "")
    own = own_exact(engine, names, scene)
    found = Held(
        variant,
        _apart(comparison, engine, own),
        _apart(comparison, engine, against),
        against,
        reason,
        tuple(_broken(engine, comparison)),
    )
    if not against:
        return found
    pair = names[engine], names[against]
    return found._replace(
        meaning=kind_of(engine, against, scene).words,
        peaks=peak_differences(*pair),
        static=static_difference(*pair),
    )


def _apart(comparison: Comparison, one: str, other: str | None) -> Worst:
    """Return a misfit; nan where one of the two is not there, or the other stands still."""
    results = comparison.results
    found = worst(results[one], results[other]) if other in results else NOTHING
    return found if isfinite(found.judged) else NOTHING


def _broken(engine: str, comparison: Comparison) -> list[str]:
    """Return the pairs of [expect] that an engine is first in and that lie beyond their bound."""
    found = []
    for pair, bound in comparison.scene.expect.items():
        one, other = pair.split(" ~ ")
        if one == engine and _apart(comparison, one, other).misfit > bound:
            found.append(pair)
    return found


def _largest(values) -> Worst:
    return max((w for w in values if not isnan(w.judged)), key=lambda w: w.judged, default=NOTHING)
