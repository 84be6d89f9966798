"""Figure 4: how a pulse travels, comes back from the free end, and meets its own reflection; figure
5: what a non-reflecting end leaves of the reflected pulse.
"""

import numpy as np
import pandas as pd

from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.misfit.metrics import delay, relative_l2
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.report.claims import pulses
from jointwave.compare.report.claims.claim import Claim, listed, share, shares
from jointwave.compare.solvers.dem import DEM


def travels(comparisons: list[Comparison]) -> Claim:
    """Fig. 4: the incident pulse travels at the bar speed, within 3 % of it."""
    base, scene = comparisons[0], comparisons[0].scene
    c, places, quarter = calibrate(scene).bar_speed, scene.record.stress, pulses.period(scene) / 4
    apart = [i for i, y in enumerate(places) if scene.pillar.length - y > overlap(base)]
    incident = [
        {
            name: w.where(w.index < pulses.arrivals(scene, places[i])[1] - quarter, 0.0)
            for name, w in pulses.waveforms(base, "stress", i).items()
        }
        for i in (apart[0], apart[-1])
    ]
    way, speeds = places[apart[-1]] - places[apart[0]], {}
    for name, near in incident[0].items():
        late = delay(incident[1][name].values, near.values, pulses.sampling(near))
        speeds[name] = way / late if late else np.inf
    return Claim(
        f"From y = {places[apart[0]]:g} to {places[apart[-1]]:g} m the incident pulse runs at "
        f"{listed(speeds, '.0f', ' m/s')}; the bar speed is {c:.0f} m/s.",
        all(abs(v / c - 1) < 0.03 for v in speeds.values()),
    )


def overlap(comparison: Comparison) -> float:
    """Return how near to an end a pulse meets its own reflection: c T / 2, m."""
    return calibrate(comparison.scene).bar_speed * pulses.period(comparison.scene) / 2


def reflection(comparisons: list[Comparison]) -> Claim:
    """Fig. 4: the free end reverses the pulse, and no end sends back more than it got."""
    scene = comparisons[0].scene
    places = np.array(scene.record.stress)
    index = int(np.argmin(np.abs(places - 0.6 * scene.pillar.length)))
    peaks, y = pulses.signed_peaks(comparisons[0], index), places[index]
    ratios = {name: back / there for name, (there, back, _) in peaks.items()}
    return Claim(
        f"Signed peak of the reflected over the incident pulse at y = {y:g} m: "
        f"{listed(ratios, '+.2f')}; -1 without damping.",
        all(-1.05 < ratio < -0.1 for ratio in ratios.values()),
    )


def superposition(comparisons: list[Comparison]) -> Claim:
    """Fig. 4: near the free end the stress is the sum of the pulse and its reversed reflection.

    The sum is built from the incident pulse at the section farthest from the end, shifted by the
    bar's travel times; 15 % is what decay and dispersion on the way may change.
    """
    base, scene = comparisons[0], comparisons[0].scene
    places, reach = np.array(scene.record.stress), overlap(base)
    apart = np.flatnonzero(scene.pillar.length - places > reach)
    index, source = int(places.argmax()), int(apart[places[apart].argmax()])
    y, seen = places[index], places[source]
    if index == source:
        text = f"No section lies within c T / 2 = {reach:.2f} m of the end, where pulses overlap."
        return Claim(text, False)
    near, far = (pulses.waveforms(base, "stress", i) for i in (source, index))
    errors, heights = {}, {}
    for name, w in near.items():
        incident = pulses.passage(w, scene, seen, 0)
        total = _sum_of_pulses(base, incident, w.index.values, seen, y)
        measured = pulses.span(far[name], 0.0, total.index[-1])
        errors[name] = relative_l2(measured.values, total.reindex(measured.index).values)
        heights[name] = pulses.peak(measured) / pulses.peak(incident)
    return Claim(
        f"The stress at y = {y:g} m peaks at {listed(heights, '.2f')} of the incident pulse, and "
        f"differs from that pulse (seen at y = {seen:g} m) and its reverse by {shares(errors)}.",
        max(errors.values()) < 0.15,
    )


def _sum_of_pulses(
    base: Comparison, incident: pd.Series, t: np.ndarray, at: float, y: float
) -> pd.Series:
    """Return the pulse seen at one section and its reverse off the free end, both moved to y."""
    c, length = calibrate(base.scene).bar_speed, base.scene.pillar.length
    there, back = (
        np.interp(t - way / c, incident.index, incident.values, left=0.0, right=0.0)
        for way in (y - at, 2 * length - y - at)
    )
    stop = pulses.arrivals(base.scene, y)[2] - pulses.period(base.scene) / 4
    return pulses.span(pd.Series(there - back, t), 0.0, stop)


def _by_end(comparisons: list[Comparison], *ends: str) -> list[Comparison]:
    return [next(c for c in comparisons if c.scene.ends.end == end) for end in ends]


def _reflected_over_incident(comparison: Comparison) -> dict[str, float]:
    """Return the first reflected over the incident peak at the first section, by engine."""
    peaks = pulses.signed_peaks(comparison)
    return {name: abs(reflected / incident) for name, (incident, reflected, _) in peaks.items()}


def quiet_end(comparisons: list[Comparison]) -> Claim:
    """Fig. 5: the end (9) takes nearly all of the pulse, below a tenth of the incident peak."""
    free, quiet = map(_reflected_over_incident, _by_end(comparisons, "free", "quiet"))
    return Claim(
        f"Peak of the reflected over the incident pulse with a free end: {shares(free)}; with the "
        f"quiet end (9): {shares(quiet)}.",
        all(quiet[name] < 0.1 < free[name] for name in quiet),
    )


def left_by_the_quiet_end(comparisons: list[Comparison]) -> Claim:
    """Fig. 5: what the rigid chain's quiet end leaves is what its end block's mass reflects.

    Theory is applied to the very pulse that comes back from the free end; 1 % of what is left is
    for the tails outside the window.
    """
    free, quiet = _by_end(comparisons, "free", "quiet")
    scene, y = free.scene, free.scene.record.stress[0]
    sent, left = (
        pulses.passage(pulses.waveforms(c, "stress", 0)[DEM.name], scene, y, 1)
        for c in (free, quiet)
    )
    predicted = pulses.peak(pulses.quiet_share(sent, scene)) / pulses.peak(sent)
    measured = pulses.peak(left) / pulses.peak(sent)
    return Claim(
        f"A dashpot on a full-mass block reflects {share(pulses.quiet_harmonic(scene))} of a "
        f"harmonic of the load's period, and {share(predicted, 2)} of the pulse's peak; dem "
        f"reflects {share(measured, 2)}.",
        bool(np.isclose(measured, predicted, rtol=0.01)),
    )


def matched_end(comparisons: list[Comparison]) -> Claim:
    """Fig. 5: behind a half-block spring the dashpot leaves below 1 % wherever there are joints."""
    ends = _by_end(comparisons, "quiet", "matched")
    quiet, matched = map(_reflected_over_incident, ends)
    blocks = DEM.name
    return Claim(
        f"Peak of the reflected over the incident pulse with the dashpot behind half a joint: "
        f"{shares(matched, 2)}; {blocks} with the quiet end: {share(quiet[blocks], 2)}.",
        all(x < 0.01 for x in matched.values()) and matched[blocks] < quiet[blocks],
    )
