"""Figures 2, 3 and 6: one pulse in a pillar, its passages, its decay and its width."""

from collections.abc import Callable

import numpy as np
import pandas as pd

from cases.loads import load_history
from compare.exact.bar import equivalent_bar, jointed_bar
from compare.exact.blocks import lattice
from compare.figures.panels import variant_names
from compare.misfit.metrics import mean_period, misfit, relative_l2
from compare.misfit.pairs import Comparison
from compare.report.claims import pulses
from compare.report.claims.claim import Claim, Measured, falls, listed, share, shares
from compare.solvers.dem import DEM


def one_sine_cycle(comparisons: list[Comparison]) -> Measured:
    """Fig. 2: the stress at the loaded end is one cycle of a sine."""
    base, scene = comparisons[0], comparisons[0].scene
    errors = {
        name: relative_l2(w.values, load_history(scene).value(w.index.values))
        for name, w in pulses.waveforms(base, "stress", 0).items()
    }
    return Measured(
        f"The load is one cycle of {scene.load.amplitude / 1e6:g} MPa and "
        f"{1e3 * pulses.period(scene):g} ms; relative L2 distance of the stress at "
        f"y = {scene.record.stress[0]:g} m from it: {shares(errors, 3)}.",
        max(errors.values()) < 0.01,
    )


def three_pulses(comparisons: list[Comparison]) -> Measured:
    """Fig. 3: incident, first reflected (reversed) and second reflected pulse pass in turn, each
    above a tenth of the largest stress."""
    scene, y = comparisons[0].scene, comparisons[0].scene.record.stress[0]
    waves = pulses.waveforms(comparisons[0], "stress", 0)
    signed = {
        name: [pulses.first_swing(part) * pulses.peak(part) / 1e6 for part in parts]
        for name, w in waves.items()
        for parts in [[pulses.passage(w, scene, y, n) for n in range(3)]]
    }
    due = ", ".join(f"{1e3 * t:.1f}" for t in pulses.arrivals(scene, y))
    return Measured(
        f"At y = {y:g} m they are due at {due} ms. Their peaks in MPa, signed by the first "
        f"half-cycle, which a free end reverses, {variant_names(comparisons)[0]}: "
        f"{listed(signed, '+.3f')}.",
        all(
            min(np.multiply(signed[name], [1, -1, 1])) > 0.1 * pulses.peak(w) / 1e6
            for name, w in waves.items()
        ),
    )


def _passage_peaks(comparison: Comparison) -> dict[str, list[float]]:
    """Return the peaks of the three passages at the first section, MPa, by engine."""
    scene, y = comparison.scene, comparison.scene.record.stress[0]
    return {
        name: [pulses.peak(pulses.passage(w, scene, y, n)) / 1e6 for n in range(3)]
        for name, w in pulses.waveforms(comparison, "stress", 0).items()
    }


def falls_with_distance(comparisons: list[Comparison]) -> Measured:
    """Fig. 3: each later passage of a damped pulse is lower."""
    found = {
        variant: _passage_peaks(one)
        for one, variant in zip(comparisons, variant_names(comparisons), strict=True)
        if one.scene.joints.damping_ratio
    }
    texts = [f"{variant}: {listed(peaks, '.3f')}" for variant, peaks in found.items()]
    return Measured(
        f"Peaks of the incident, first and second reflected pulse in MPa. {'. '.join(texts)}.",
        bool(found) and all(falls(peaks) for one in found.values() for peaks in one.values()),
    )


def falls_with_damping(comparisons: list[Comparison]) -> Measured:
    """Fig. 3: at equal distance a pulse is lower the larger the damping ratio."""
    ordered = sorted(comparisons, key=lambda c: c.scene.joints.damping_ratio or 0.0)
    ratios = ", ".join(f"{c.scene.joints.damping_ratio or 0:g}" for c in ordered)
    found = _over_variants(ordered, _passage_peaks)
    second = {name: [peaks[2] for peaks in of_all] for name, of_all in found.items()}
    return Measured(
        f"Peak of the second reflected pulse in MPa at ζ = {ratios}: {listed(second, '.3f')}. The "
        "incident and the first reflected pulse are judged as well.",
        all(falls(passage) for of_all in found.values() for passage in zip(*of_all, strict=True)),
    )


def broader(comparisons: list[Comparison]) -> Measured:
    """Fig. 6: the larger the damping ratio, the longer the pulse's mean period."""
    found = _over_variants(
        comparisons,
        lambda c: {
            n: 1e3 * mean_period(w.values, pulses.sampling(w)) for n, w in _first_pass(c).items()
        },
    )
    return Measured(
        f"Mean period of the pulse in ms, {', '.join(variant_names(comparisons))}: "
        f"{listed(found, '.2f')}.",
        all(falls(np.negative(periods)) for periods in found.values()),
    )


def second_half_weaker(comparisons: list[Comparison]) -> Measured:
    """Fig. 6: the larger the damping ratio, the lower the second half-cycle beside the first."""
    found = _over_variants(
        comparisons,
        lambda c: {n: pulses.second_over_first(w) for n, w in _first_pass(c).items()},
    )
    return Measured(
        f"Peak of the second half-cycle over that of the first, "
        f"{', '.join(variant_names(comparisons))}: {listed(found, '.3f')}.",
        all(falls(ratios) for ratios in found.values()),
    )


def _over_variants(
    comparisons: list[Comparison], measure: Callable[[Comparison], dict]
) -> dict[str, list]:
    """Return by engine what is measured in each variant."""
    found = [measure(one) for one in comparisons]
    return {name: [one[name] for one in found] for name in found[0]}


def _first_pass(comparison: Comparison) -> dict[str, pd.Series]:
    scene = comparison.scene
    stop = pulses.arrivals(scene, scene.record.stress[0])[1] - pulses.period(scene)
    return {
        name: pulses.span(w, 0.0, stop)
        for name, w in pulses.waveforms(comparison, "stress", 0).items()
    }


def mostly_dispersion(comparison: Comparison) -> Claim:
    """Say what the rigid blocks' distance from the homogenised bar is made of.

    It holds when rock with its joints resolved explains more than half of it: the rigid blocks are
    less than half as far from the jointed bar as from the homogenised one.
    """
    r, scene = comparison.results, comparison.scene
    blocks, homogenised, jointed = (
        r[one.name] for one in (DEM, equivalent_bar.SOLVER, jointed_bar.SOLVER)
    )
    total, own = misfit(blocks, homogenised), misfit(blocks, r[lattice.SOLVER.name])
    rigid, joints = misfit(blocks, jointed), misfit(jointed, homogenised)
    holds = rigid < 0.5 * total
    end = (
        "So most of what looks like the rigid-block model's error against the homogenised series "
        "is the joints' own dispersion, which a homogenised bar does not have."
        if holds
        else "So the joints' own dispersion does not explain most of that distance."
    )
    return Claim(
        "the distance to the homogenised series is mostly the joints' own dispersion",
        f"On the paper's free pillar (y = {scene.record.stress[0]:g} m, "
        f"0 to {1e3 * scene.time.duration:g} ms) the rigid blocks lie {share(total)} from the "
        f"homogenised bar. The engine itself errs by only {share(own, 2)} (dem ~ lattice), and "
        f"rigid instead of deformable blocks cost {share(rigid)} (dem ~ jointed-bar). Elastic rock "
        f"with its {scene.block_count - 1} joints resolved lies {share(joints)} from the "
        f"homogenised bar as well. {end}",
        holds,
    )
