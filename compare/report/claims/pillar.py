"""Figures 2, 3 and 6: a pulse in a pillar, its passages, decay and width."""

from collections.abc import Callable

import numpy as np
import pandas as pd

from jointwave.cases.loads import load_history
from jointwave.compare.exact.bar.bars import EQUIVALENT, JOINTED
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.figures.receivers import named, variant_names
from jointwave.compare.misfit.metrics import mean_period, misfit, relative_l2
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.report.claims import claim, falls, listed, waves
from jointwave.compare.solvers.dem import DEM


@claim("one sine cycle", 2)
def one_sine_cycle(comparisons: list[Comparison]) -> tuple[str, bool]:
    """The stress at the loaded end is the load, within 1 %."""
    scene, stress = comparisons[0].scene, waves.waveforms(comparisons[0], "stress")
    load = load_history(scene).value(stress.index.to_numpy())
    errors = stress.apply(lambda wave: relative_l2(wave.values, load))
    return (
        f"The load is one cycle of {scene.load.amplitude / 1e6:g} MPa and "
        f"{1e3 * waves.period(scene):g} ms; relative L2 distance of the stress at "
        f"y = {scene.record.stress[0]:g} m from it: {listed(errors, '.3%')}.",
        errors.max() < 0.01,
    )


@claim("incident, first and second reflected pulse", 3)
def three_pulses(comparisons: list[Comparison]) -> tuple[str, bool]:
    """The pulses pass in turn, the first reflected one reversed, each above a tenth of the peak."""
    scene, y = comparisons[0].scene, comparisons[0].scene.record.stress[0]
    found = waves.signed_peaks(comparisons[0])
    least = 0.1 * waves.peak(waves.waveforms(comparisons[0], "stress"))
    due = ", ".join(f"{1e3 * t:.1f}" for t in waves.arrivals(scene, y))
    return (
        f"Due at y = {y:g} m at {due} ms. Peaks in MPa, signed by the first half-cycle, "
        f"{variant_names(comparisons)[0]}: {listed(found / 1e6, '+.3f')}.",
        (found * [1, -1, 1]).gt(least, axis=0).all(axis=None),
    )


@claim("amplitude falls with distance", 3)
def falls_with_distance(comparisons: list[Comparison]) -> tuple[str, bool]:
    """A damped pulse is lower at each passage."""
    found = {
        name: waves.signed_peaks(one).abs() / 1e6
        for name, one in named(comparisons)
        if one.scene.joints.damping_ratio
    }
    texts = [f"{variant}: {listed(peaks, '.3f')}" for variant, peaks in found.items()]
    return (
        f"Peaks of the incident, first and second reflected pulse in MPa. {'. '.join(texts)}.",
        bool(found) and all(map(falls, found.values())),
    )


@claim("amplitude falls with damping", 3)
def falls_with_damping(comparisons: list[Comparison]) -> tuple[str, bool]:
    """At the same distance a larger damping ratio gives a lower pulse."""
    ordered = sorted(comparisons, key=lambda one: one.scene.joints.damping_ratio or 0.0)
    ratios = ", ".join(f"{one.scene.joints.damping_ratio or 0:g}" for one in ordered)
    peaks = [waves.signed_peaks(one).abs() / 1e6 for one in ordered]
    second = pd.concat([one[2] for one in peaks], axis=1)
    return (
        f"Peak of the second reflected pulse in MPa at ζ = {ratios}: {listed(second, '.3f')}.",
        falls(np.stack(peaks, axis=-1)),
    )


@claim("large damping: broader", 6)
def broader(comparisons: list[Comparison]) -> tuple[str, bool]:
    """A larger damping ratio gives a longer mean period of the pulse."""
    found = _of_first_pass(
        comparisons,
        lambda wave: 1e3 * mean_period(wave.values, float(wave.index[1] - wave.index[0])),
    )
    variants = ", ".join(variant_names(comparisons))
    return f"Mean period of the pulse in ms, {variants}: {listed(found, '.2f')}.", falls(-found)


@claim("large damping: second half-cycle weaker", 6)
def second_half_weaker(comparisons: list[Comparison]) -> tuple[str, bool]:
    """A larger damping ratio gives a lower second half-cycle relative to the first."""
    found = _of_first_pass(
        comparisons, lambda wave: -wave[wave.index >= wave.idxmax()].min() / wave.max()
    )
    variants = ", ".join(variant_names(comparisons))
    return (
        f"Peak of the second half-cycle over that of the first, {variants}: "
        f"{listed(found, '.3f')}.",
        falls(found),
    )


def _of_first_pass(
    comparisons: list[Comparison], measure: Callable[[pd.Series], float]
) -> pd.DataFrame:
    """Return a measure of the incident pulse [engine, variant]."""
    scene = comparisons[0].scene
    stop = waves.arrivals(scene, scene.record.stress[0])[1] - waves.period(scene)
    found = [waves.span(waves.waveforms(one, "stress"), 0.0, stop) for one in comparisons]
    return pd.concat([one.apply(measure) for one in found], axis=1)


@claim("the joints' own dispersion explains most of the misfit")
def mostly_dispersion(comparisons: list[Comparison]) -> tuple[str, bool]:
    """Rigid blocks are less than half as far from the jointed bar as from the homogenised bar."""
    results, scene = comparisons[0].results, comparisons[0].scene
    exact = (row_of_blocks.AXIAL, EQUIVALENT, JOINTED)
    own, bar, jointed = (results[one.name] for one in exact)
    total, rigid = (misfit(results[DEM.name], one) for one in (bar, jointed))
    holds = rigid < 0.5 * total
    return (
        f"On the paper's free pillar the rigid blocks lie {total:.1%} from the homogenised bar. "
        f"Their numerical error is {misfit(results[DEM.name], own):.2%}; rigid instead of "
        f"deformable blocks cost {rigid:.1%}, the misfit from the exact jointed bar. Elastic "
        f"rock with its {scene.block_count - 1} joints resolved lies {misfit(jointed, bar):.1%} "
        f"from the homogenised bar: the joints' own dispersion "
        f"{'explains' if holds else 'does not explain'} most of the distance.",
        holds,
    )
