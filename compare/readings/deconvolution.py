"""Deconvolution: the incident motion at a column's start from the motion of its free end.

The ratio of the free end's motion to the incident wave's is H = 2 Z v(L), with the impedance Z of
the rock behind the start and the end's velocity v(L) under a unit end stress (`laplace.transfer`).
The division is done in the frequency domain, with a water level where the joints transmit little
(Clayton & Wiggins, Geophys. J. R. Astr. Soc. 47, 1976):

    incoming = surface conj(H) / max(|H|^2, (w max|H|)^2)

In uniform rock H = 2 exp(-i omega L / c): half of the record, L / c earlier.

Valid for linear joints and rock, in axial motion or, if the load is across the axis, in shear.
"""

from dataclasses import replace
from math import ceil, sqrt

import numpy as np
import xarray as xr

from jointwave.cases.errors import SceneError
from jointwave.cases.loads import late_by
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import pillar_of
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar.bars import bar_of
from jointwave.compare.exact.bar.transfer import Bar, end_of, transfer
from jointwave.compare.exact.conditions import DAMPED, holds
from jointwave.compare.scenes import AnySource, load

HELD = (
    *("spatial motion", "reversed load", "gravity", "prestress", "stiff layers", "soft layers"),
    *("segments", "scatter"),
)


def deconvolve(scene: AnySource, surface: xr.DataArray, water_level: float = 1e-3) -> xr.DataArray:
    """Return the wave incident on a column's quiet start, from the motion of its free end.

    It can be the load of a compliant base (`load.quantity`). Unit and sampling interval are those
    of the record; it begins earlier by the travel time through the intact rock.

    Parameters
    ----------
    scene : a pillar with ends "quiet" and "free"; only the load's direction is used.
    surface : velocity or acceleration over `time` (s) only, equally spaced, of the whole motion: a
        truncated record distorts the end of the result.
    water_level : w, relative to the largest |H|: frequencies with a lower |H| are attenuated.

    Raises SceneError if the scene is not a pillar, the column not linear, or the record not one
    waveform.
    """
    from scipy.fft import next_fast_len

    if surface.dims != ("time",):
        raise SceneError("deconvolve", "surface", [*surface.dims], "must be over time only")
    column = pillar_of(load(scene), "deconvolve")
    bar, impedance = _column(column)
    n, time = surface.sizes["time"], surface.time.values
    dt = (time[-1] - time[0]) / (n - 1)
    lengths = np.diff([*(rock.y for rock in bar.rocks), bar.length])
    slowness = [sqrt(rock.density / rock.modulus) for rock in bar.rocks]
    lead = ceil(float(lengths @ slowness) / dt)
    count = next_fast_len(2 * (n + 2 * lead))
    s = 2j * np.pi * np.fft.rfftfreq(count, dt)
    H = 2 * impedance * transfer(bar, s, np.array([bar.length]))[1][0]
    H *= np.exp(-s * late_by(column, "jointed"))
    inverse = H.conj() / np.maximum(np.abs(H), water_level * np.abs(H).max()) ** 2
    found = np.fft.irfft(np.fft.rfft(surface.values, count) * inverse, count)
    earlier = time[0] + dt * np.arange(-lead, n)
    return xr.DataArray(np.roll(found, lead)[: n + lead], {"time": earlier}, attrs=surface.attrs)


def _column(scene: Scene) -> tuple[Bar, float]:
    """Return a scene's column and the impedance of the rock behind its start, Pa s/m."""
    p, load = calibrate(scene), scene.load
    ends = scene.ends.start, scene.ends.end
    slips = p.friction is not None or p.cohesion is not None
    reasons = [
        (ends != ("quiet", "free"), "the ends are not quiet and free"),
        (load.is_across and scene.motion.rotation != "none", "motion.rotation is not 'none'"),
        (load.is_across and bool(load.direction[1]), "the load is neither along nor across"),
        (load.is_across and slips, "a joint may slip"),
    ]
    if not (answer := holds(scene, (*HELD, *DAMPED), *reasons)):
        raise SceneError(scene.where, "", None, f"cannot be deconvolved: {answer.reason}")
    bar, impedance = bar_of(scene, resolved=p.own_stiffness is not None), p.at_start.impedance
    if scene.is_uniform and load.is_across:
        (rock,), impedance = bar.rocks, p.shear_impedance
        modulus = p.shear_modulus
        compliance = p.excess_shear_compliance
        if p.own_shear_stiffness is not None and p.intact_modulus is not None:
            modulus = p.intact_modulus / (2 * (1 + scene.rock.intact_poisson))
            compliance = 1 / p.own_shear_stiffness
        bar = replace(bar, rocks=(rock._replace(modulus=modulus),), joint_compliance=compliance)
    return replace(bar, start=end_of("quiet", impedance), end=end_of("free", impedance)), impedance
