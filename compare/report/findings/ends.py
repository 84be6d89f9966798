"""Figure 5: what a non-reflecting end leaves of the reflected pulse."""

import numpy as np

from compare.misfit import pulses
from compare.misfit.pairs import Comparison
from compare.report.findings.finding import Finding, percent, share
from compare.solvers.dem import DEM


def _by_end(comparisons: list[Comparison], end: str) -> Comparison:
    return next(c for c in comparisons if c.scene.ends.end == end)


def reflected_over_incident(comparison: Comparison) -> dict[str, float]:
    """Return the first reflected over the incident peak at the first section, by engine."""
    scene, y = comparison.scene, comparison.scene.record.stress[0]
    shares = {}
    for name, w in pulses.waveforms(comparison, "stress", 0).items():
        incident, reflected = (pulses.passage(w, scene, y, n) for n in (0, 1))
        shares[name] = pulses.peak(reflected) / pulses.peak(incident)
    return shares


def quiet_end(comparisons: list[Comparison]) -> Finding:
    """Fig. 5: the end (9) takes nearly all of the pulse, below a tenth of the incident peak."""
    free, quiet = (reflected_over_incident(_by_end(comparisons, e)) for e in ("free", "quiet"))
    return Finding(
        "no reflected pulse with the non-reflecting end",
        f"Peak of the reflected over the incident pulse with a free end: {percent(free)}; with the "
        f"quiet end (9): {percent(quiet)}.",
        all(quiet[name] < 0.1 < free[name] for name in quiet),
    )


def what_the_quiet_end_leaves(comparisons: list[Comparison]) -> Finding:
    """Fig. 5: what the rigid chain's quiet end leaves is what its end block's mass reflects.

    Theory is applied to the very pulse that comes back from the free end; 1 % of what is left is
    for the tails outside the window.
    """
    free, quiet = (_by_end(comparisons, end) for end in ("free", "quiet"))
    scene, y = free.scene, free.scene.record.stress[0]
    sent, left = (
        pulses.passage(pulses.waveforms(c, "stress", 0)[DEM.name], scene, y, 1)
        for c in (free, quiet)
    )
    predicted = pulses.peak(pulses.quiet_share(sent, scene)) / pulses.peak(sent)
    measured = pulses.peak(left) / pulses.peak(sent)
    return Finding(
        "the remaining reflection is due to the end block's mass",
        f"A dashpot on a full-mass block reflects tan(k d / 4) of a harmonic, "
        f"{share(pulses.quiet_harmonic(scene))} at the load's period. Of the pulse that comes back "
        f"from the free end this leaves {share(predicted, 2)} of the peak; dem leaves "
        f"{share(measured, 2)}.",
        bool(np.isclose(measured, predicted, rtol=0.01)),
    )


def matched_end(comparisons: list[Comparison]) -> Finding:
    """Fig. 5: behind a half-block spring the dashpot leaves below 1 % wherever there are joints."""
    quiet, matched = (
        reflected_over_incident(_by_end(comparisons, end)) for end in ("quiet", "matched")
    )
    blocks = DEM.name
    return Finding(
        "the matched end reflects least",
        f"With the dashpot behind the half-block spring (in jointed rock behind half a joint) the "
        f"reflected pulse has this share of the incident peak: {percent(matched, 2)}; for the "
        f"rigid blocks {quiet[blocks] / max(matched[blocks], 1e-12):.0f} times less than with the "
        f"quiet end.",
        all(x < 0.01 for x in matched.values()) and matched[blocks] < quiet[blocks],
    )
