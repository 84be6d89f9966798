"""Figures 7 to 10: a soft layer, and joints that carry no tension."""

from math import pi, sqrt

import numpy as np
import pandas as pd

from cases.material.calibrate import calibrate
from cases.schema.scene import Scene
from compare.misfit import pulses
from compare.misfit.metrics import delay
from compare.misfit.pairs import Comparison
from compare.report.findings.finding import Finding, listed, percent, share

WORDS = {"stress": "stress", "velocity": "block velocity"}


def _quantity(scene: Scene) -> str:
    return "stress" if scene.record.stress else "velocity"


def _with_and_without(comparisons: list[Comparison]) -> tuple[Comparison, Comparison]:
    layered = next(c for c in comparisons if c.scene.soft_layers)
    return layered, next(c for c in comparisons if not c.scene.soft_layers)


def _receiver(scene: Scene, behind: bool) -> tuple[int, float]:
    """Return index and y of the first receiver behind the layer, or of the last in front of it."""
    layer, places = scene.soft_layers[0].y, getattr(scene.record, _quantity(scene))
    found = [(i, y) for i, y in enumerate(places) if (y > layer) == behind]
    return found[0] if behind else found[-1]


def _pairs(comparisons: list[Comparison], behind: bool) -> dict[str, tuple[pd.Series, pd.Series]]:
    """Return each engine's waveforms with and without the layer.

    They are cut before what the layer and the loaded end send to and fro comes by once more.
    """
    layered, plain = _with_and_without(comparisons)
    scene, (index, y) = layered.scene, _receiver(layered.scene, behind)
    again = (y + 2 * scene.soft_layers[0].y) / calibrate(scene).bar_speed
    stop = again - pulses.period(scene) / 4
    one, other = (pulses.waveforms(c, _quantity(scene), index) for c in (layered, plain))
    return {
        name: (pulses.span(one[name], 0, stop), pulses.span(other[name], 0, stop))
        for name in one
        if name in other
    }


def harmonic_coefficients(scene: Scene) -> tuple[float, float]:
    """Return |T| and |R| of the layer for a harmonic of the load's period (Schoenberg, 1980)."""
    p, soft = calibrate(scene), calibrate(scene).soft[0]
    excess = 1 / (1 / p.stiffness[soft] - 1 / p.regular_stiffness)
    kappa = excess * pulses.period(scene) / (2 * pi * p.impedance)
    return 2 * kappa / sqrt(4 * kappa**2 + 1), 1 / sqrt(4 * kappa**2 + 1)


def reflects_in_front(comparisons: list[Comparison]) -> Finding:
    """Figs 7, 8: the layer reflects, within a quarter of the share of the load's harmonic.

    A one-cycle pulse holds all frequencies, and its peak is not that of one harmonic.
    """
    scene = _with_and_without(comparisons)[0].scene
    shares = {
        name: pulses.peak(one - other) / pulses.peak(other)
        for name, (one, other) in _pairs(comparisons, behind=False).items()
    }
    theory = harmonic_coefficients(scene)[1]
    return Finding(
        "reflection in front of the layer",
        f"At y = {_receiver(scene, False)[1]:g} m the {WORDS[_quantity(scene)]} that the layer "
        f"adds peaks at {percent(shares)} of the incident peak; a harmonic of the load's period "
        f"would be reflected by {share(theory)}.",
        all(abs(share / theory - 1) < 0.25 for share in shares.values()),
    )


def smaller_and_later(comparisons: list[Comparison]) -> Finding:
    """Figs 7, 8: behind the layer the pulse is lower and later."""
    scene, ratios, delays = _with_and_without(comparisons)[0].scene, {}, {}
    for name, (one, other) in _pairs(comparisons, behind=True).items():
        ratios[name] = pulses.peak(one) / pulses.peak(other)
        delays[name] = delay(one.values, other.values, pulses.sampling(one))
    return Finding(
        "smaller and later behind the layer",
        f"At y = {_receiver(scene, True)[1]:g} m the {WORDS[_quantity(scene)]} peaks at "
        f"{percent(ratios)} of that without the layer (a harmonic: "
        f"{share(harmonic_coefficients(scene)[0])}) and is late by "
        f"{listed({n: f'{1e3 * late:.2f} ms' for n, late in delays.items()})}.",
        max(ratios.values()) < 0.95 and min(delays.values()) > 0,
    )


def _by_tension(comparisons: list[Comparison]) -> tuple[Comparison, Comparison]:
    barred = next(c for c in comparisons if c.scene.joints.tension is False)
    return next(c for c in comparisons if c.scene.joints.tension is not False), barred


def tension_is_cut(comparisons: list[Comparison]) -> Finding:
    """Fig. 9: the tensile half-cycle is there with tension and gone without."""
    carried, barred = (
        {n: max(0.0, -float(w.min())) for n, w in pulses.waveforms(c, "stress", 0).items()}
        for c in _by_tension(comparisons)
    )
    load = abs(comparisons[0].scene.load.amplitude)
    texts = [
        listed({name: f"{abs(x) / 1e6:.3f}" for name, x in found.items()})
        for found in (carried, barred)
    ]
    return Finding(
        "the tensile half-cycle is cut",
        f"Largest tensile stress in MPa with tension: {texts[0]}; without: {texts[1]}.",
        min(carried.values()) > 0.5 * load and max(barred.values()) < 1e-6 * load,
    )


def _after(comparison: Comparison) -> dict[str, pd.Series]:
    """Return the velocities between the pulse and what comes back from the end."""
    scene, y = comparison.scene, comparison.scene.record.velocity[0]
    incident, reflected, _ = pulses.arrivals(scene, y)
    start, stop = incident + pulses.period(scene), reflected - pulses.period(scene) / 4
    return {
        name: pulses.span(w, start, stop)
        for name, w in pulses.waveforms(comparison, "velocity", 0).items()
    }


def blocks_separate(comparisons: list[Comparison]) -> Finding:
    """Fig. 10: no block pulls another back, and the joint between two receivers opens."""
    carried, barred = (
        {n: float(w.min() / w.max()) for n, w in pulses.waveforms(c, "velocity", 0).items()}
        for c in _by_tension(comparisons)
    )
    opening = _opening(_by_tension(comparisons)[1])
    words = (
        f" The joint between the receivers ends open by "
        f"{listed({n: f'{1e3 * x:.3f} mm' for n, x in opening.items()})}."
        if opening
        else ""
    )
    return Finding(
        "blocks separate",
        f"The largest velocity backwards over that forwards with tension: {percent(carried)}; "
        f"without, the pull back is gone: {percent(barred)}.{words}",
        max(carried.values()) < -0.5
        and min(barred.values()) > -0.1
        and all(x > 0 for x in opening.values()),
    )


def _opening(comparison: Comparison) -> dict[str, float]:
    """Return by how far the last two receivers have moved apart, m; nothing with only one."""
    if len(comparison.scene.record.velocity) < 2:
        return {}
    found = {}
    for name in pulses.waveforms(comparison, "velocity", 0):
        moved = comparison.results[name].displacement.values[:, -1, 0]
        found[name] = float(moved[-1] - moved[-2])
    return found


def blocks_coast(comparisons: list[Comparison]) -> Finding:
    """Fig. 10: behind the pulse the velocity stays constant (no force acts) and near zero."""
    barred = _by_tension(comparisons)[1]
    after, whole = _after(barred), pulses.waveforms(barred, "velocity", 0)
    left = {n: pulses.peak(w) / pulses.peak(whole[n]) for n, w in after.items()}
    drift = {n: float(np.ptp(w.values)) / pulses.peak(whole[n]) for n, w in after.items()}
    (start, stop), *_ = ((1e3 * w.index[0], 1e3 * w.index[-1]) for w in after.values())
    return Finding(
        "blocks coast, the velocity tends to zero behind the pulse",
        f"From {start:.1f} to {stop:.1f} ms the velocity is at most {percent(left, 2)} of its "
        f"peak, and changes by {percent(drift, 3)} of it.",
        max(left.values()) < 0.02 and max(drift.values()) < 0.005,
    )
