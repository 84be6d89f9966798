"""Figure 4: travel of a pulse, its reflection at a free end, and their superposition. Figure 5: the
remaining reflection at a non-reflecting end.
"""

import numpy as np
import pandas as pd

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.schema.scene import Scene
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.report.claims import claim, listed, waves
from jointwave.compare.solvers.dem import DEM


@claim("travel", 4)
def travels(comparisons: list[Comparison]) -> tuple[str, bool]:
    """The incident pulse travels at the bar speed within 3 %."""
    base, scene = comparisons[0], comparisons[0].scene
    c, places, quarter = calibrate(scene).bar_speed, scene.record.stress, waves.period(scene) / 4
    apart = [i for i, y in enumerate(places) if scene.pillar.length - y > waves.overlap(scene)]
    first, last = apart[0], apart[-1]
    stresses = {i: waves.waveforms(base, "stress", i) for i in (first, last)}
    near, far = (
        stress.mul(stress.index < waves.arrivals(scene, places[i])[1] - quarter, axis=0)
        for i, stress in stresses.items()
    )
    speeds = (places[last] - places[first]) / waves.delays(far, near)
    return (
        f"From y = {places[first]:g} to {places[last]:g} m the incident pulse runs at "
        f"{listed(speeds, '.0f', ' m/s')}; the bar speed is {c:.0f} m/s.",
        (abs(speeds / c - 1) < 0.03).all(),
    )


@claim("reflection", 4)
def reflection(comparisons: list[Comparison]) -> tuple[str, bool]:
    """The free end reverses the pulse and does not amplify it."""
    scene = comparisons[0].scene
    places = np.array(scene.record.stress)
    receiver = int(np.argmin(np.abs(places - 0.6 * scene.pillar.length)))
    peaks = waves.signed_peaks(comparisons[0], receiver)
    ratios = peaks[1] / peaks[0]
    return (
        f"Signed peak of the reflected over the incident pulse at y = {places[receiver]:g} m: "
        f"{listed(ratios, '+.2f')}; -1 without damping.",
        ratios.between(-1.05, -0.1, "neither").all(),
    )


@claim("superposition", 4)
def superposition(comparisons: list[Comparison]) -> tuple[str, bool]:
    """Near the free end the stress is the sum of the pulse and its reversed reflection.

    The sum is built from the incident pulse at the last section without overlap, shifted by the
    bar's travel times; 15 % allow for decay and dispersion on the way.
    """
    base, scene = comparisons[0], comparisons[0].scene
    places, reach = np.array(scene.record.stress), waves.overlap(scene)
    length, c = scene.pillar.length, calibrate(scene).bar_speed
    at, y = places[length - places > reach].max(), places.max()
    incident = waves.passages(base, int(np.argmax(places == at)))[0]
    stop = waves.arrivals(scene, y)[2] - waves.period(scene) / 4
    measured = waves.span(waves.waveforms(base, "stress", int(places.argmax())), 0.0, stop)
    there, back = (
        _moved(incident, measured.index, way / c) for way in (y - at, 2 * length - y - at)
    )
    errors = waves.by_engine(relative_l2, measured, there - back)
    heights = waves.peak(measured) / waves.peak(incident)
    return (
        f"The stress at y = {y:g} m peaks at {listed(heights, '.2f')} of the incident pulse, and "
        f"differs from that pulse (seen at y = {at:g} m) and its reverse by "
        f"{listed(errors, '.1%')}.",
        errors.max() < 0.15,
    )


def _moved(pulse: pd.DataFrame, times: pd.Index, late: float) -> pd.DataFrame:
    """Return a pulse delayed by `late`, s, at other times; zero before and after it."""
    at = times.to_numpy() - late
    return pulse.apply(
        lambda wave: pd.Series(np.interp(at, wave.index, wave.values, 0.0, 0.0), times)
    )


def _reflected(comparisons: list[Comparison]) -> dict[str, pd.Series]:
    """Return the first reflected over the incident peak at the first section, by kind of end."""
    peaks = {one.scene.ends.end: waves.signed_peaks(one) for one in comparisons}
    return {end: abs(one[1] / one[0]) for end, one in peaks.items()}


@claim("no reflected pulse with the non-reflecting end", 5)
def quiet_end(comparisons: list[Comparison]) -> tuple[str, bool]:
    """The end of eq. (9) reflects less than a tenth of the incident peak."""
    found = _reflected(comparisons)
    return (
        f"Peak of the reflected over the incident pulse with a free end: "
        f"{listed(found['free'], '.1%')}; with the quiet end (9): {listed(found['quiet'], '.1%')}.",
        found["quiet"].max() < 0.1 < found["free"].min(),
    )


@claim("the remaining reflection is due to the end block's mass", 5)
def left_by_the_quiet_end(comparisons: list[Comparison]) -> tuple[str, bool]:
    """The reflection at the quiet end of rigid blocks is that of the end block's mass.

    Theory is applied to the pulse from the free end; 1 % allows for tails outside the window.
    """
    scenes = {one.scene.ends.end: one for one in comparisons}
    sent, left = (waves.passages(scenes[end])[1][DEM.name] for end in ("free", "quiet"))
    scene = scenes["free"].scene
    predicted = quiet_share(sent, scene).abs().max() / sent.abs().max()
    measured = left.abs().max() / sent.abs().max()
    return (
        f"A dashpot on a full-mass block reflects {quiet_harmonic(scene):.1%} of a harmonic of the "
        f"load's period, and {predicted:.2%} of the pulse's peak; {DEM.label} reflect "
        f"{measured:.2%}.",
        np.isclose(measured, predicted, rtol=0.01),
    )


def quiet_share(wave: pd.Series, scene: Scene) -> pd.Series:
    """Return the wave reflected by the quiet end, eq. (9), of a chain of rigid blocks.

    wave : reflected by a free end.

    With the wave exp(i omega t - i theta j) in blocks of mass m, z = exp(-i theta), k* = k (1 +
    i omega eta) and Z = rho c A: z + 1/z = 2 - m omega^2/k*; the dashpot on the full-mass end block
    reflects -(k* (z - 1) + i omega Z)/(k* (1/z - 1) + i omega Z), the free end z. Undamped, their
    ratio has the magnitude tan(theta/4).
    """
    p, size = calibrate(scene), 2 * len(wave)
    omega = 2 * np.pi * np.fft.rfftfreq(size, wave.index[1] - wave.index[0])[1:]
    k = p.regular_stiffness * p.area * (1 + 1j * omega * (p.time_constant or 0.0))
    half = 1 - p.block_mass * omega**2 / (2 * k)
    z = half - 1j * np.sqrt(1 - half**2)  # the root that travels or decays forward
    z = np.where(np.abs(z) > 1 + 1e-12, 1 / z, z)
    dashpot = 1j * omega * p.impedance * p.area
    ratio = -(k * (z - 1) + dashpot) / (k * (1 / z - 1) + dashpot) / z
    share = np.fft.irfft(np.r_[0, ratio] * np.fft.rfft(wave.values, size), size)
    return pd.Series(share[: len(wave)], wave.index)


def quiet_harmonic(scene: Scene) -> float:
    """Return |R| = tan(k d / 4) of the quiet end for a harmonic of the load's period, undamped."""
    p = calibrate(scene)
    theta = 2 * np.arcsin(min(1.0, np.pi * p.spacing / (p.bar_speed * waves.period(scene))))
    return float(np.tan(theta / 4))


@claim("the matched end reflects least", 5)
def matched_end(comparisons: list[Comparison]) -> tuple[str, bool]:
    """A dashpot behind the spring of half a block reflects below 1 % in every engine."""
    found = _reflected(comparisons)
    matched, quiet = found["matched"], found["quiet"][DEM.name]
    return (
        f"Peak of the reflected over the incident pulse with the dashpot behind half a joint: "
        f"{listed(matched, '.2%')}; {DEM.label} with the quiet end: {quiet:.2%}.",
        matched.max() < 0.01 and matched[DEM.name] < quiet,
    )
