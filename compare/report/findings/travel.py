"""Figure 4: how a pulse travels, comes back from the free end, and meets its own reflection."""

import numpy as np
import pandas as pd

from cases.material.calibrate import calibrate
from compare.misfit import pulses
from compare.misfit.metrics import delay, relative_l2
from compare.misfit.pairs import Comparison
from compare.report.findings.finding import Finding, listed, percent


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
