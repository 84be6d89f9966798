"""Figures 2, 3 and 6: one pulse in a pillar, its passages, its decay and its width."""

from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np
import pandas as pd

from jointwave.cases.loads import load_history
from jointwave.compare.exact.bar import equivalent_bar, jointed_bar
from jointwave.compare.exact.blocks import lattice
from jointwave.compare.figures.panels import variant_names
from jointwave.compare.misfit.metrics import mean_period, misfit, relative_l2
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.report.claims import pulses
from jointwave.compare.report.claims.claim import Claim, falls, listed, share, shares
from jointwave.compare.solvers.dem import DEM

T = TypeVar("T")


def one_sine_cycle(comparisons: list[Comparison]) -> Claim:
    """Fig. 2: the stress at the loaded end is one cycle of a sine."""
    scene, load = comparisons[0].scene, load_history(comparisons[0].scene)
    errors = pulses.by_engine(
        comparisons[0], "stress", lambda w: relative_l2(w.values, load.value(w.index.values))
    )
    return Claim(
        f"The load is one cycle of {scene.load.amplitude / 1e6:g} MPa and "
        f"{1e3 * pulses.period(scene):g} ms; relative L2 distance of the stress at "
        f"y = {scene.record.stress[0]:g} m from it: {shares(errors, 3)}.",
        max(errors.values()) < 0.01,
    )


def three_pulses(comparisons: list[Comparison]) -> Claim:
    """Fig. 3: incident, first reflected (reversed) and second reflected pulse pass in turn, each
    above a tenth of the largest stress."""
    scene, y = comparisons[0].scene, comparisons[0].scene.record.stress[0]
    found = pulses.signed_peaks(comparisons[0])
    largest = pulses.by_engine(comparisons[0], "stress", pulses.peak)
    due = ", ".join(f"{1e3 * t:.1f}" for t in pulses.arrivals(scene, y))
    signed = {name: [x / 1e6 for x in values] for name, values in found.items()}
    return Claim(
        f"Due at y = {y:g} m at {due} ms. Peaks in MPa, signed by the first half-cycle, "
        f"{variant_names(comparisons)[0]}: {listed(signed, '+.3f')}.",
        all(min(a, -b, c) > 0.1 * largest[name] for name, (a, b, c) in found.items()),
    )


def _peaks(comparison: Comparison) -> dict[str, list[float]]:
    """Return the peaks of the three passages, MPa, by engine."""
    found = pulses.signed_peaks(comparison)
    return {name: [abs(x) / 1e6 for x in values] for name, values in found.items()}


def falls_with_distance(comparisons: list[Comparison]) -> Claim:
    """Fig. 3: each later passage of a damped pulse is lower."""
    named = zip(variant_names(comparisons), comparisons, strict=True)
    found = {name: _peaks(one) for name, one in named if one.scene.joints.damping_ratio}
    texts = [f"{variant}: {listed(peaks, '.3f')}" for variant, peaks in found.items()]
    return Claim(
        f"Peaks of the incident, first and second reflected pulse in MPa. {'. '.join(texts)}.",
        bool(found) and all(falls(peaks) for one in found.values() for peaks in one.values()),
    )


def falls_with_damping(comparisons: list[Comparison]) -> Claim:
    """Fig. 3: at equal distance a pulse is lower the larger the damping ratio."""
    ordered = sorted(comparisons, key=lambda c: c.scene.joints.damping_ratio or 0.0)
    ratios = ", ".join(f"{c.scene.joints.damping_ratio or 0:g}" for c in ordered)
    found = _over_variants(map(_peaks, ordered))
    second = {name: [peaks[2] for peaks in of_all] for name, of_all in found.items()}
    return Claim(
        f"Peak of the second reflected pulse in MPa at ζ = {ratios}: {listed(second, '.3f')}.",
        all(falls(passage) for of_all in found.values() for passage in zip(*of_all, strict=True)),
    )


def broader(comparisons: list[Comparison]) -> Claim:
    """Fig. 6: the larger the damping ratio, the longer the pulse's mean period."""
    found = _of_first_pass(comparisons, lambda w: 1e3 * mean_period(w.values, pulses.sampling(w)))
    return Claim(
        f"Mean period of the pulse in ms, {', '.join(variant_names(comparisons))}: "
        f"{listed(found, '.2f')}.",
        all(falls(np.negative(periods)) for periods in found.values()),
    )


def second_half_weaker(comparisons: list[Comparison]) -> Claim:
    """Fig. 6: the larger the damping ratio, the lower the second half-cycle beside the first."""
    found = _of_first_pass(comparisons, pulses.second_over_first)
    return Claim(
        f"Peak of the second half-cycle over that of the first, "
        f"{', '.join(variant_names(comparisons))}: {listed(found, '.3f')}.",
        all(falls(ratios) for ratios in found.values()),
    )


def _over_variants(found: Iterable[dict[str, T]]) -> dict[str, list[T]]:
    """Return by engine what was measured in each variant."""
    variants = list(found)
    return {name: [one[name] for one in variants] for name in variants[0]}


def _of_first_pass(
    comparisons: list[Comparison], measure: Callable[[pd.Series], float]
) -> dict[str, list[float]]:
    """Return by engine what is measured of the incident pulse of each variant."""
    scene = comparisons[0].scene
    stop = pulses.arrivals(scene, scene.record.stress[0])[1] - pulses.period(scene)
    return _over_variants(
        pulses.by_engine(one, "stress", lambda w: measure(pulses.span(w, 0.0, stop)))
        for one in comparisons
    )


def mostly_dispersion(comparison: Comparison) -> Claim:
    """Say what the rigid blocks' distance from the homogenised bar is made of.

    It holds when rock with its joints resolved explains more than half of it: the rigid blocks are
    less than half as far from the jointed bar as from the homogenised one.
    """
    r, scene = comparison.results, comparison.scene
    blocks, exact = r[DEM.name], (lattice, equivalent_bar, jointed_bar)
    own, total, rigid = (misfit(blocks, r[one.SOLVER.name]) for one in exact)
    joints = misfit(r[jointed_bar.SOLVER.name], r[equivalent_bar.SOLVER.name])
    holds = rigid < 0.5 * total
    return Claim(
        f"On the paper's free pillar the rigid blocks lie {share(total)} from the homogenised "
        f"bar. Their numerical error is {share(own, 2)} (dem ~ lattice); rigid instead of "
        f"deformable blocks cost {share(rigid)} (dem ~ jointed-bar). Elastic rock with its "
        f"{scene.block_count - 1} joints resolved lies {share(joints)} from the homogenised bar: "
        f"the joints' own dispersion {'explains' if holds else 'does not explain'} most of the "
        "distance.",
        holds,
    )
