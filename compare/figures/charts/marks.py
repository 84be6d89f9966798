"""Characteristic frequencies of a scene, which are marked in its spectra."""

from math import cos, isfinite, pi, sin
from typing import NamedTuple

from scipy.optimize import brentq

from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.schema.scene import Scene
from jointwave.compare.figures.receivers import Panel


class Frequency(NamedTuple):
    """A frequency (Hz) and its meaning, short and in words."""

    name: str
    frequency: float
    words: str


def marks_of(panel: Panel) -> list[Frequency]:
    """Return the marks of a panel in order of frequency: of the load and, of a pillar, of its
    longitudinal waves or, if blocks do not rotate, of its shear waves."""
    scene, (quantity, component, _) = panel.comparison.scene, panel.place
    periods = {one.period for one in scene.pulses if one.period}
    found = [Frequency("load", 1 / period, "1/T of the load") for period in periods]
    if isinstance(scene, Scene):
        p = calibrate(scene)
        along = quantity in ("stress", "velocity") and component in ("", "y")
        if along or len(p.each) > 1:
            rates = [one.bar_speed / one.spacing for one in p.each]
            found += [_cut_off(min(rates)), *(_of_joints(p) if len(rates) == 1 else [])]
        elif scene.motion.rotation == "none" and quantity != "rotation":
            found.append(_cut_off(p.shear_speed / p.spacing))
    return sorted(found, key=lambda mark: mark.frequency)


def _cut_off(rate: float) -> Frequency:
    """Return the cut-off of a chain, omega = 2 sqrt(k/m) = 2 c/d (Brillouin 1946), of the least
    c/d, 1/s."""
    return Frequency("chain cut-off", rate / pi, "cut-off of the chain of blocks")


def _of_joints(p: Properties) -> list[Frequency]:
    """Return the end of the first pass band of equal joints in elastic rock."""
    if p.intact_modulus is None or not isfinite(p.regular_own_stiffness):
        return []
    speed = (p.intact_modulus / p.density) ** 0.5
    edge = band_edge(p.density * speed, p.regular_own_stiffness, p.spacing / speed)
    return [Frequency("joints' band edge", edge, "end of the first pass band of joints in rock")]


def band_edge(impedance: float, stiffness: float, crossing: float) -> float:
    """Return the frequency (Hz) at which the first pass band of equal joints ends.

    impedance : of the rock, Pa s/m. stiffness : of a joint, Pa/m. crossing : of the rock between
    two joints, s. There cos(phi) = cos(theta) - sin(theta) / (2 kappa) is -1 (Cai & Zhao, Int. J.
    Rock Mech. Min. Sci. 37, 2000); divided by 2 cos(theta/2), which vanishes at the band's other
    edge, this is cos(theta/2) = sin(theta/2) / (2 kappa).
    """

    def bloch(theta: float) -> float:
        return cos(theta / 2) - sin(theta / 2) * theta * impedance / (2 * stiffness * crossing)

    return float(brentq(bloch, 0.0, pi, xtol=1e-14) / (2 * pi * crossing))
