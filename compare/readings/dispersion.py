"""Phase speed against frequency, of a row of receivers (f-k) and of the theory of a pillar.

The f-k spectrum of a row of receivers at any places x_j on a line, with the spectra U_j, is

    P(f, k) = |sum_j U_j exp(i k x_j)|^2 / (n sum_j |U_j|^2),

1 if all motion is one wave of this wavenumber; the speed is 2 pi f over the k of its peak (Capon,
Proc. IEEE 57, 1969, the conventional estimate).

In an endless pillar with a joint every d, with e^{i (omega t - k y)}, the joints' eta, and w^2 =
omega^2 - i alpha omega with mass damping alpha:

    rigid blocks   sin(k d / 2) = (w d / 2 c) / sqrt(1 + i omega eta)     (Brillouin 1946)
    jointed rock   cos(k d) = cos(q d) - rho w^2 / (2 q K (1 + i omega eta)) sin(q d),
                   q = w / sqrt(E (1 + i omega eta) / rho)
                   (Brekhovskikh 1980, with Schoenberg's joint, JASA 68, 1980)
    bar            k = (w / c) / sqrt(1 + i omega eta)
"""

from collections.abc import Sequence

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.constant_q import mechanisms_of
from jointwave.cases.scene_type import pillar_of
from jointwave.compare.readings.attenuation import known_places, wave_speed, waveforms
from jointwave.compare.readings.recordings import Recording, sampling, variables
from jointwave.compare.scenes import AnySource, load

HEARD = 1e-3  # least amplitude of a frequency that is used, over the largest
ALIASED = 0.95  # of the frequency at which neighbouring receivers are half a wavelength apart
FINER = 64  # wavenumbers per width of a peak


def dispersion(
    result: Recording, quantity: str = "velocity", axis: str | None = None
) -> xr.Dataset:
    """Return the f-k spectrum of all receivers, `power` [frequency, wavenumber], and the
    `phase_speed` (m/s) and `coherence` (0 to 1) of its peak [frequency].

    Frequencies have at least a thousandth of the largest amplitude. Wavenumbers (1/m) reach half a
    wave between the two nearest receivers, and are negative for waves towards the first receiver.
    The speed is nan at frequencies at which the wave, by its delay at the last receiver, has larger
    wavenumbers than these. Raises SceneError if receivers are not on a line.
    """
    row = waveforms(result, quantity, axis)
    x, spectra = _along(known_places(row)), np.fft.rfft(row.values)
    size = np.sqrt((np.abs(spectra) ** 2).sum(axis=0))
    heard = size > HEARD * size.max()
    heard[0] = False
    frequency = np.fft.rfftfreq(row.sizes["time"], sampling(row))[heard]
    highest = np.pi / np.diff(np.unique(x.round(9))).min()
    k = np.linspace(-highest, highest, FINER * len(x) + 1)
    beams = np.abs(np.exp(1j * np.outer(k, x)) @ spectra[:, heard]) ** 2
    power = (beams / (len(x) * size[heard] ** 2)).T
    at, i = np.arange(len(power)), np.clip(power.argmax(axis=1), 1, len(k) - 2)
    left, top, right = (power[at, i + step] for step in (-1, 0, 1))  # a parabola through them
    bend = left - 2 * top + right
    shift = np.divide(left - right, 2 * bend, out=np.zeros_like(top), where=bend < 0)
    peak, coherence = k[i] + shift * (k[1] - k[0]), top - (left - right) * shift / 4
    with np.errstate(divide="ignore"):  # k = 0: in phase everywhere
        speed = 2 * np.pi * frequency / peak
    passing = abs(wave_speed(result, quantity=quantity, axis=axis))
    speed[2 * np.pi * frequency > ALIASED * highest * passing] = np.nan
    named = {
        "phase_speed": (speed, "phase speed", "m/s"),
        "coherence": (coherence, "share of the motion in one wave", "1"),
    }
    beams_of = {"power": (power, "share of the motion", "1")}
    return xr.Dataset(
        variables(("frequency", "wavenumber"), beams_of) | variables("frequency", named),
        variables("frequency", {"frequency": (frequency, "frequency", "Hz")})
        | variables("wavenumber", {"wavenumber": (k, "wavenumber", "1/m")}),
    )


def _along(places: np.ndarray) -> np.ndarray:
    """Return receivers' places [space, receiver] along the line from the first to the last, m."""
    line = places[:, -1] / (np.linalg.norm(places[:, -1]) or 1.0)
    x = line @ places
    aside = np.abs(np.outer(line, x) - places).max()
    if not aside <= 1e-6 * np.abs(x).max() > 0:
        raise SceneError("result", "receivers", None, "must lie on a line, first to last")
    return x


def dispersion_theory(
    scene: AnySource, frequency: float | Sequence[float] | np.ndarray
) -> xr.Dataset:
    """Return phase_speed (m/s), attenuation (1/m) and quality [rock, frequency] of waves along an
    endless pillar with a scene's ordinary joints.

    rock : "rigid blocks" (without a quality factor), "bar" and, given intact_modulus, "jointed
    rock". frequency : Hz, above 0; stop bands appear as attenuation. Raises SceneError for
    segments, random joints, motion across the axis, joints that stiffen, and local damping.
    """
    pillar = pillar_of(load(scene), "dispersion_theory")
    for key, there, allowed in (
        ("segments", pillar.segments, "give each rock in its own scene"),
        ("scatter", pillar.scatter, "random joints have no theory of dispersion"),
        ("load", across := pillar.off_axis, f"the theory is of waves along the axis: {across}"),
        ("joints.maximum_closure", pillar.joints.maximum_closure, "the speed depends on stress"),
        ("damping.local", pillar.damping.local, "is not linear"),
    ):
        if there:
            raise SceneError(pillar.where, key, None, allowed)
    at = np.atleast_1d(np.asarray(frequency, dtype=float))
    if not (at > 0).all():
        raise SceneError("dispersion_theory", "frequency", at.min(), "must be positive")
    p, omega = calibrate(pillar), 2 * np.pi * at
    d, loss = p.spacing, 1 + 1j * omega * (p.time_constant or 0.0)
    rock, mass = (mechanisms_of(pillar, model) for model in ("jointed", "equivalent"))
    of_rock, of_mass = (loss if one is None else one.modulus(1j * omega) for one in (rock, mass))
    w = np.sqrt(omega**2 - 1j * (p.mass_damping or 0.0) * omega)
    along = w / p.bar_speed / np.sqrt(of_mass)
    k = {"bar": along}
    if rock is None:
        k = {"rigid blocks": 2 / d * np.arcsin(along * d / 2), **k}
    if p.intact_modulus is not None:
        q = w / np.sqrt(p.intact_modulus * of_rock / p.density)
        K = p.regular_own_stiffness * loss
        cosine = np.cos(q * d) - p.density * w**2 / (2 * q * K) * np.sin(q * d)
        k["jointed rock"] = np.arccos(cosine) / d
    found = np.array(list(k.values()))
    speed, decay = omega / np.abs(found.real), np.abs(found.imag)
    with np.errstate(divide="ignore"):
        quality = np.abs(found.real) / (2 * decay)
    named = {
        "phase_speed": (speed, "phase speed", "m/s"),
        "attenuation": (decay, "attenuation", "1/m"),
        "quality": (quality, "quality factor", "1"),
    }
    frequencies = variables("frequency", {"frequency": (at, "frequency", "Hz")})
    return xr.Dataset(variables(("rock", "frequency"), named), {"rock": list(k), **frequencies})
