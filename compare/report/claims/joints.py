"""Figures 7 to 10: a soft layer, and joints that carry no tension."""

from math import pi, sqrt

import numpy as np
import pandas as pd

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.schema.scene import Scene
from jointwave.compare.misfit.metrics import delay
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.report.claims import pulses
from jointwave.compare.report.claims.claim import Claim, listed, share, shares


def _quantity(scene: Scene) -> str:
    return "stress" if scene.record.stress else "velocity"


def _layered(comparisons: list[Comparison]) -> Comparison:
    return next(c for c in comparisons if c.scene.soft_layers)


def _beside_the_layer(
    comparisons: list[Comparison], behind: bool
) -> tuple[float, dict[str, tuple[pd.Series, pd.Series]]]:
    """Return y of the receiver next to the layer, and each engine's waveforms there with and
    without it, before what the layer and the loaded end send to and fro comes by once more."""
    layered, plain = _layered(comparisons), next(c for c in comparisons if not c.scene.soft_layers)
    scene, layer = layered.scene, layered.scene.soft_layers[0].y
    places = getattr(scene.record, _quantity(scene))
    sides = [i for i, y in enumerate(places) if (y > layer) == behind]
    index = sides[0] if behind else sides[-1]
    stop = (places[index] + 2 * layer) / calibrate(scene).bar_speed - pulses.period(scene) / 4
    one, other = (pulses.waveforms(c, _quantity(scene), index) for c in (layered, plain))
    cut = {n: (pulses.span(one[n], 0, stop), pulses.span(other[n], 0, stop)) for n in one}
    return places[index], cut


def harmonic_coefficients(scene: Scene) -> tuple[float, float]:
    """Return |T| and |R| of the layer for a harmonic of the load's period (Schoenberg, 1980)."""
    p, soft = calibrate(scene), calibrate(scene).soft[0]
    excess = 1 / (1 / p.stiffness[soft] - 1 / p.regular_stiffness)
    kappa = excess * pulses.period(scene) / (2 * pi * p.impedance)
    return 2 * kappa / sqrt(4 * kappa**2 + 1), 1 / sqrt(4 * kappa**2 + 1)


def reflects_in_front(comparisons: list[Comparison]) -> Claim:
    """Figs 7, 8: the layer reflects, within a quarter of the share of the load's harmonic.

    A one-cycle pulse holds all frequencies, and its peak is not that of one harmonic.
    """
    scene = _layered(comparisons).scene
    y, waves = _beside_the_layer(comparisons, behind=False)
    found = {n: pulses.peak(one - other) / pulses.peak(other) for n, (one, other) in waves.items()}
    theory = harmonic_coefficients(scene)[1]
    return Claim(
        f"Peak {_quantity(scene)} at y = {y:g} m that the layer adds, over the incident one: "
        f"{shares(found)}; of a harmonic of the load's period: {share(theory)}.",
        all(abs(x / theory - 1) < 0.25 for x in found.values()),
    )


def smaller_and_later(comparisons: list[Comparison]) -> Claim:
    """Figs 7, 8: behind the layer the pulse is lower and later."""
    scene = _layered(comparisons).scene
    y, waves = _beside_the_layer(comparisons, behind=True)
    ratios = {n: pulses.peak(one) / pulses.peak(other) for n, (one, other) in waves.items()}
    delays = {
        n: 1e3 * delay(one.values, other.values, pulses.sampling(one))
        for n, (one, other) in waves.items()
    }
    return Claim(
        f"Peak {_quantity(scene)} at y = {y:g} m over that without the layer: {shares(ratios)} "
        f"(a harmonic: {share(harmonic_coefficients(scene)[0])}); delay: "
        f"{listed(delays, '.2f', ' ms')}.",
        max(ratios.values()) < 0.95 and min(delays.values()) > 0,
    )


def _by_tension(comparisons: list[Comparison]) -> tuple[Comparison, Comparison]:
    """Return the variants whose joints carry tension and do not."""
    without = next(c for c in comparisons if c.scene.joints.tension is False)
    return next(c for c in comparisons if c.scene.joints.tension is not False), without


def tension_is_cut(comparisons: list[Comparison]) -> Claim:
    """Fig. 9: the tensile half-cycle is there with tension and gone without."""
    carried, without = (
        pulses.by_engine(c, "stress", lambda w: abs(min(0.0, w.min())) / 1e6)
        for c in _by_tension(comparisons)
    )
    load = abs(comparisons[0].scene.load.amplitude) / 1e6
    return Claim(
        f"Largest tensile stress in MPa with tension: {listed(carried, '.3f')}; without: "
        f"{listed(without, '.3f')}.",
        min(carried.values()) > 0.5 * load and max(without.values()) < 1e-6 * load,
    )


def blocks_separate(comparisons: list[Comparison]) -> Claim:
    """Fig. 10: no block pulls another back, and the joint between two receivers opens."""
    carried, without = (
        pulses.by_engine(c, "velocity", lambda w: float(w.min() / w.max()))
        for c in _by_tension(comparisons)
    )
    results = _by_tension(comparisons)[1].results
    opening = {
        name: 1e3 * float(np.diff(results[name].displacement.values[-2:, -1, 0])[0])
        for name in without
    }
    return Claim(
        f"The largest velocity backwards over that forwards with tension: {shares(carried)}; "
        f"without: {shares(without)}, and the joint between the receivers ends open by "
        f"{listed(opening, '.3f', ' mm')}.",
        max(carried.values()) < -0.5
        and min(without.values()) > -0.1
        and all(x > 0 for x in opening.values()),
    )


def blocks_coast(comparisons: list[Comparison]) -> Claim:
    """Fig. 10: between the pulse and what comes back from the end the velocity stays constant (no
    force acts) and near zero."""
    without = _by_tension(comparisons)[1]
    scene = without.scene
    incident, reflected, _ = pulses.arrivals(scene, scene.record.velocity[0])
    span = incident + pulses.period(scene), reflected - pulses.period(scene) / 4
    after = pulses.by_engine(without, "velocity", lambda w: pulses.span(w, *span) / pulses.peak(w))
    left = {name: pulses.peak(w) for name, w in after.items()}
    drift = {name: float(np.ptp(w.values)) for name, w in after.items()}
    times = next(iter(after.values())).index
    return Claim(
        f"From {1e3 * times[0]:.1f} to {1e3 * times[-1]:.1f} ms the velocity is at most "
        f"{shares(left, 2)} of its peak, and changes by {shares(drift, 3)} of it.",
        max(left.values()) < 0.02 and max(drift.values()) < 0.005,
    )
