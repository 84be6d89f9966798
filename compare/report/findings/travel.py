"""Figure 4: how a pulse travels, comes back from the free end, and meets its own reflection; figure
5: what a non-reflecting end leaves of the reflected pulse.
"""

import numpy as np
import pandas as pd

from cases.material.calibrate import calibrate
from compare.misfit import pulses
from compare.misfit.metrics import delay, relative_l2
from compare.misfit.pairs import Comparison
from compare.report.findings.finding import Finding, listed, percent, share
from compare.solvers.dem import DEM


def travels(comparisons: list[Comparison]) -> Finding:
    """Fig. 4: the incident pulse travels at the bar speed, within 3 % of it."""
    scene, c = comparisons[0].scene, calibrate(comparisons[0].scene).bar_speed
    places = scene.record.stress
    apart = [i for i, y in enumerate(places) if scene.pillar.length - y > overlap(comparisons[0])]
    first, last = apart[0], apart[-1]
    near, far = (pulses.waveforms(comparisons[0], "stress", i) for i in (first, last))
    speeds = {}
    for name in near:
        a, b = (
            w.where(w.index < pulses.arrivals(scene, places[i])[1] - pulses.period(scene) / 4, 0.0)
            for w, i in ((near[name], first), (far[name], last))
        )
        late = delay(b.values, a.values, pulses.sampling(a))
        speeds[name] = (places[last] - places[first]) / late if late else np.inf
    return Finding(
        "travel",
        f"From y = {places[first]:g} to {places[last]:g} m the incident pulse runs at "
        f"{listed({n: f'{v:.0f} m/s' for n, v in speeds.items()})}; the bar speed is {c:.0f} m/s.",
        all(abs(v / c - 1) < 0.03 for v in speeds.values()),
    )


def overlap(comparison: Comparison) -> float:
    """Return how near to an end a pulse meets its own reflection: c T / 2, m."""
    return calibrate(comparison.scene).bar_speed * pulses.period(comparison.scene) / 2


def reflection(comparisons: list[Comparison]) -> Finding:
    """Fig. 4: the free end reverses the pulse, and no end sends back more than it got."""
    scene, texts, verdicts = comparisons[0].scene, {}, []
    middle = [abs(y - 0.6 * scene.pillar.length) for y in scene.record.stress]
    index = int(np.argmin(middle))
    y = scene.record.stress[index]
    for name, w in pulses.waveforms(comparisons[0], "stress", index).items():
        there, back = (pulses.passage(w, scene, y, n) for n in (0, 1))
        ratio = pulses.first_swing(back) * pulses.peak(back) / pulses.peak(there)
        texts[name] = f"{ratio:+.2f}"
        verdicts.append(pulses.first_swing(there) > 0 and -1.05 < ratio < -0.1)
    return Finding(
        "reflection",
        f"At y = {y:g} m the peak of the pulse off the free end over the incident one, signed by "
        f"the first half-cycle: {listed(texts)}; -1 without damping.",
        all(verdicts),
    )


def superposition(comparisons: list[Comparison]) -> Finding:
    """Fig. 4: near the free end the stress is the sum of the pulse and its reversed reflection.

    The sum is built from the incident pulse at the section farthest from the end, shifted by the
    bar's travel times; 15 % is what decay and dispersion on the way may change.
    """
    base, length = comparisons[0], comparisons[0].scene.pillar.length
    claim, places = "superposition", base.scene.record.stress
    index = int(np.argmax(places))
    y, reach = places[index], overlap(base)
    if length - y >= reach:
        text = f"No section lies within c T / 2 = {reach:.2f} m of the end, where pulses overlap."
        return Finding(claim, text, False)
    source = max((i for i, x in enumerate(places) if length - x > reach), key=places.__getitem__)
    errors, heights = {}, {}
    near, far = (pulses.waveforms(base, "stress", i) for i in (source, index))
    for name in near:
        total = _sum_of_pulses(base, near[name], places[source], y)
        measured = pulses.span(far[name], 0.0, total.index[-1])
        total = total.reindex(measured.index)
        errors[name] = relative_l2(measured.values, total.values)
        incident = pulses.passage(near[name], base.scene, places[source], 0)
        heights[name] = f"{pulses.peak(measured) / pulses.peak(incident):.2f}"
    return Finding(
        claim,
        f"At y = {y:g} m the pulse meets its own reflection: the largest stress over the incident "
        f"peak is {listed(heights)}, and the waveform differs from the sum of the incident pulse "
        f"seen at y = {places[source]:g} m and its reverse by {percent(errors)} (relative L2).",
        max(errors.values()) < 0.15,
    )


def _sum_of_pulses(base: Comparison, seen: pd.Series, at: float, y: float) -> pd.Series:
    """Return the pulse seen at one section and its reverse off the free end, both moved to y."""
    c, length = calibrate(base.scene).bar_speed, base.scene.pillar.length
    incident = pulses.passage(seen, base.scene, at, 0)
    t = seen.index.values

    def late(way: float) -> np.ndarray:
        return np.interp(t - way / c, incident.index, incident.values, left=0.0, right=0.0)

    stop = pulses.arrivals(base.scene, y)[2] - pulses.period(base.scene) / 4
    total = pd.Series(late(y - at) - late(2 * length - y - at), t)
    return pulses.span(total, 0.0, stop)


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
