"""Engineering measures of a result: functions of a Dataset that return arrays with units."""

from jointwave.compare.readings.attenuation import (
    quality_factor,
    spectra,
    transfer_function,
    wave_speed,
)
from jointwave.compare.readings.deconvolution import deconvolve
from jointwave.compare.readings.dispersion import dispersion, dispersion_theory
from jointwave.compare.readings.ground_motion import arias, ppv, ppv_map, response_spectrum
from jointwave.compare.readings.recordings import recording

__all__ = [
    "arias",
    "deconvolve",
    "dispersion",
    "dispersion_theory",
    "ppv",
    "ppv_map",
    "quality_factor",
    "recording",
    "response_spectrum",
    "spectra",
    "transfer_function",
    "wave_speed",
]
