"""The verdict on an engine for a scene: its misfits, and one word."""

from collections.abc import Iterable, Mapping
from math import isfinite, isnan, nan
from typing import Any, NamedTuple

import pandas as pd

from jointwave.cases.errors import require
from jointwave.compare.engines import ENGINES
from jointwave.compare.figures.receivers import named
from jointwave.compare.misfit import differences
from jointwave.compare.misfit.differences import PeakDifference
from jointwave.compare.misfit.metrics import Worst, worst
from jointwave.compare.misfit.pairs import A_COMPARISON, Comparison
from jointwave.compare.misfit.ranking import kind_of, own_exact, reference_of
from jointwave.compare.scenes import bound_of
from jointwave.compare.text import mean_and_worst
from jointwave.results.labels import PEAK_STRESS, PEAKS, PPV


class Verdict(NamedTuple):
    """A word and a sign; `grade` sets the colour: "a" (best) to "d", "n" unchecked, "x" broken."""

    sign: str
    word: str
    grade: str


NOT_CHECKED = Verdict("?", "not checked independently", "n")
BROKEN = Verdict("✗", "out of bounds", "x")
#: Verdicts by the largest misfit from the finest physics for which each is given.
VERDICTS = {
    0.01: Verdict("✓", "agrees", "a"),
    0.05: Verdict("≈", "close", "b"),
    0.20: Verdict("△", "differs", "c"),
    float("inf"): Verdict("▲", "far off", "d"),
}
ORDER = "abncdx"  # of grades, from the best to the worst: the worst variant decides
STATIC = 0.01  # of the largest static stress; a larger difference of static states is reported


class VariantScore(NamedTuple):
    """One engine on one variant.

    own : misfit from the exact solution of the engine's own model. total : misfit from the
    reference `against`, "" if there is no independent one; `reason` says why it is the reference,
    `meaning` what kind of difference the misfit is. broken : keys of [expect] whose bound is
    exceeded. peaks : differences of "PPV" and "peak stress". static : difference of static states.
    """

    variant: str
    own: Worst
    total: Worst
    against: str
    reason: str
    broken: tuple[str, ...]
    meaning: str = ""
    peaks: Mapping[str, PeakDifference] = {}
    static: Worst = Worst(0.0)

    @property
    def verdict(self) -> Verdict:
        """The verdict on these numbers."""
        if self.broken:
            return BROKEN
        if isnan(self.total.judged):
            return NOT_CHECKED
        return next(verdict for most, verdict in VERDICTS.items() if self.total.judged <= most)

    @property
    def static_words(self) -> str:
        """The difference of static states in words; "" if it is at most 1 %."""
        if not self.static.misfit > STATIC:
            return ""
        off = f"{100 * self.static.misfit:.2g} % of the largest static stress"
        return f"differs from that of {self.against} by {off} ({self.static.where})"

    @property
    def facts(self) -> dict[str, Any]:
        """All values, machine-readable; missing ones are None."""
        peaks = {
            f"{short}_{part}": getattr(self.peaks.get(name), part, None)
            for name, short in ((PPV, "ppv"), (PEAK_STRESS, "peak_stress"))
            for part in PeakDifference._fields
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
            "out_of_bounds": list(self.broken),
        }


class EngineScore(NamedTuple):
    """One engine on all variants of a scene."""

    variants: tuple[VariantScore, ...]

    @property
    def total(self) -> Worst:
        """The largest misfit; nan if no variant was checked independently."""
        totals = (one.total for one in self.variants)
        return max(totals, key=lambda one: -1.0 if isnan(one.judged) else one.judged)

    @property
    def unchecked(self) -> list[str]:
        """The variants that were not checked independently."""
        return [one.variant for one in self.variants if isnan(one.total.judged)]

    @property
    def broken(self) -> list[str]:
        """The keys of [expect] whose bounds are exceeded."""
        return [pair for one in self.variants for pair in one.broken]

    @property
    def verdict(self) -> Verdict:
        """The verdict on the worst variant."""
        return max((one.verdict for one in self.variants), key=lambda v: ORDER.index(v.grade))


def engine_scores(comparisons: list[Comparison]) -> dict[str, EngineScore]:
    """Return the score of each engine that has solved some variant."""
    found = {
        engine: tuple(
            score(engine, one, name) for name, one in named(comparisons) if engine in one.results
        )
        for engine in ENGINES
    }
    return {engine: EngineScore(variants) for engine, variants in found.items() if variants}


def verdict_table(scores: dict[str, EngineScore]) -> pd.DataFrame:
    """Return the verdict on each engine in each variant, with errors of PPV and peak stress."""
    rows = [
        {
            "engine": engine,
            "variant": one.variant,
            "worst misfit (%)": 100 * one.total.judged,
            "at": one.total.where if one.against else "",
            **{f"{name} (%)": mean_and_worst(one.peaks.get(name)) for name in PEAKS},
            "compared with": one.against,
            "which is a": one.meaning,
            "own error (%)": 100 * one.own.judged,
            "verdict": f"{one.verdict.sign} {one.verdict.word}",
        }
        for engine, score in scores.items()
        for one in score.variants
    ]
    return pd.DataFrame(rows).set_index(["engine", "variant"]) if rows else pd.DataFrame()


def verdicts(comparison: Comparison) -> dict[str, VariantScore]:
    """Return the verdict on each engine of a comparison by name."""
    require(comparison, Comparison, "verdicts", "type", A_COMPARISON)
    return {name: score(name, comparison) for name in ENGINES if name in comparison.results}


def score(engine: str, comparison: Comparison, variant: str = "") -> VariantScore:
    """Return an engine's misfits from its reference and from its own model in one variant."""
    results, scene = comparison.results, comparison.scene
    against, reason = reference_of(engine, results, scene) or ("", "")
    own = _misfit(comparison, engine, own_exact(engine, results, scene))
    total = _misfit(comparison, engine, against)
    found = VariantScore(variant, own, total, against, reason, (*_broken(engine, comparison),))
    if not against:
        return found
    return found._replace(
        meaning=kind_of(engine, against, scene).words,
        peaks=differences.peak_differences(results[engine], results[against]),
        static=differences.static_difference(results[engine], results[against]),
    )


def _misfit(comparison: Comparison, one: str, other: str | None) -> Worst:
    """Return a misfit; nan if `other` was not solved or does not move."""
    results = comparison.results
    found = worst(results[one], results[other]) if other in results else Worst(nan)
    return found if found.place is not None and isfinite(found.judged) else Worst(nan)


def _broken(engine: str, comparison: Comparison) -> Iterable[str]:
    """Yield the keys of [expect] whose first solver is the engine, unless their bound holds."""
    results = comparison.results
    for key, most in comparison.scene.expect.items():
        bound = bound_of(key)
        if bound.one != engine or bound.other not in results:
            continue
        found = differences.distance_of(bound.of, results[engine], results[bound.other])
        if not found.judged <= most:
            yield key
