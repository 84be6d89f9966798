"""Engineering measures of a result: functions of a Dataset that return arrays with units."""

from jointwave.compare.readings.attenuation import quality_factor, transfer_function, wave_speed
from jointwave.compare.readings.dispersion import dispersion, dispersion_theory
from jointwave.compare.readings.ground_motion import (
    arias_intensity,
    peak_velocity,
    peak_velocity_map,
    response_spectrum,
)
from jointwave.compare.readings.recordings import recording

__all__ = [
    "arias_intensity",
    "dispersion",
    "dispersion_theory",
    "peak_velocity",
    "peak_velocity_map",
    "quality_factor",
    "recording",
    "response_spectrum",
    "transfer_function",
    "wave_speed",
]
