"""Figures 7 to 10: a soft layer, and joints that carry no tension."""

from math import pi, sqrt

import numpy as np
import pandas as pd

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.schema.scene import Scene
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.report.claims import claim, listed, waves


def _at_the_layer(
    comparisons: list[Comparison], behind: bool
) -> tuple[Scene, str, pd.DataFrame, pd.DataFrame]:
    """Return the scene with the layer, words for the receiver next to it, and the waveforms there
    with and without the layer, cut before the first reverberation between layer and loaded end."""
    plain, layered = sorted(comparisons, key=lambda one: bool(one.scene.soft_layers))
    scene, layer = layered.scene, layered.scene.soft_layers[0].y
    quantity = "stress" if scene.record.stress else "velocity"
    places = np.array(getattr(scene.record, quantity))
    receiver = np.flatnonzero((places > layer) == behind)[0 if behind else -1]
    stop = (places[receiver] + 2 * layer) / calibrate(scene).bar_speed - waves.period(scene) / 4
    one, other = (
        waves.span(waves.waveforms(of, quantity, receiver), 0, stop) for of in (layered, plain)
    )
    return scene, f"Peak {quantity} at y = {places[receiver]:g} m", one, other


def harmonic_coefficients(scene: Scene) -> tuple[float, float]:
    """Return |T| and |R| of the layer for a harmonic of the load's period (Schoenberg, 1980)."""
    p, soft = calibrate(scene), calibrate(scene).soft[0]
    excess = 1 / (1 / p.stiffness[soft] - 1 / p.regular_stiffness)
    kappa = excess * waves.period(scene) / (2 * pi * p.impedance)
    return 2 * kappa / sqrt(4 * kappa**2 + 1), 1 / sqrt(4 * kappa**2 + 1)


@claim("reflection in front of the layer", 7, 8)
def reflects_in_front(comparisons: list[Comparison]) -> tuple[str, bool]:
    """The reflected peak is within a quarter of |R| of a harmonic of the load's period; a one-cycle
    pulse contains all frequencies, so the two differ."""
    scene, where, one, other = _at_the_layer(comparisons, behind=False)
    found, theory = waves.peak(one - other) / waves.peak(other), harmonic_coefficients(scene)[1]
    return (
        f"{where} that the layer adds, over the incident one: {listed(found, '.1%')}; "
        f"of a harmonic of the load's period: {theory:.1%}.",
        (abs(found / theory - 1) < 0.25).all(),
    )


@claim("smaller and later behind the layer", 7, 8)
def smaller_and_later(comparisons: list[Comparison]) -> tuple[str, bool]:
    """Behind the layer the pulse is at least 5 % lower, and later."""
    scene, where, one, other = _at_the_layer(comparisons, behind=True)
    ratios, late = waves.peak(one) / waves.peak(other), 1e3 * waves.delays(one, other)
    return (
        f"{where} over that without the layer: {listed(ratios, '.1%')} (a harmonic: "
        f"{harmonic_coefficients(scene)[0]:.1%}); delay: {listed(late, '.2f', ' ms')}.",
        ratios.max() < 0.95 and late.min() > 0,
    )


def _by_tension(comparisons: list[Comparison]) -> list[Comparison]:
    """Return the variants with joints that carry tension, then without."""
    return sorted(comparisons, key=lambda one: one.scene.joints.tension is False)


@claim("the tensile half-cycle is cut", 9)
def tension_is_cut(comparisons: list[Comparison]) -> tuple[str, bool]:
    """There is a tensile half-cycle if joints carry tension, and none otherwise."""
    stresses = (waves.waveforms(one, "stress") for one in _by_tension(comparisons))
    carried, without = (abs(one.min().clip(upper=0.0)) / 1e6 for one in stresses)
    load = abs(comparisons[0].scene.load.amplitude) / 1e6
    return (
        f"Largest tensile stress in MPa with tension: {listed(carried, '.3f')}; without: "
        f"{listed(without, '.3f')}.",
        carried.min() > 0.5 * load and without.max() < 1e-6 * load,
    )


@claim("blocks separate", 10)
def blocks_separate(comparisons: list[Comparison]) -> tuple[str, bool]:
    """Without tension no block pulls another back, and the joint between two receivers opens."""
    variants = _by_tension(comparisons)
    velocities = (waves.waveforms(one, "velocity") for one in variants)
    carried, without = (one.min() / one.max() for one in velocities)
    near, far = (waves.waveforms(variants[1], "displacement", i).iloc[-1] for i in (-2, -1))
    return (
        f"The largest velocity backwards over that forwards with tension: "
        f"{listed(carried, '.1%')}; without: {listed(without, '.1%')}, and the joint between the "
        f"receivers ends open by {listed(1e3 * (far - near), '.3f', ' mm')}.",
        carried.max() < -0.5 and without.min() > -0.1 and (far > near).all(),
    )


@claim("blocks coast, the velocity tends to zero behind the pulse", 10)
def blocks_coast(comparisons: list[Comparison]) -> tuple[str, bool]:
    """Between pulse and reflection the velocity is constant, as no force acts, and near zero."""
    without = _by_tension(comparisons)[1]
    scene, moving = without.scene, waves.waveforms(without, "velocity")
    incident, reflected, _ = waves.arrivals(scene, scene.record.velocity[0])
    start, stop = incident + waves.period(scene), reflected - waves.period(scene) / 4
    after = waves.span(moving, start, stop) / waves.peak(moving)
    left, drift = waves.peak(after), after.max() - after.min()
    return (
        f"From {1e3 * after.index[0]:.1f} to {1e3 * after.index[-1]:.1f} ms the velocity is at "
        f"most {listed(left, '.2%')} of its peak, and changes by {listed(drift, '.3%')} of it.",
        left.max() < 0.02 and drift.max() < 0.005,
    )
