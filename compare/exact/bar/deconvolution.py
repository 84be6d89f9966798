"""Deconvolution: the motion that comes up to the start of a column, from that of its free end.

The motion of the free end over that of the wave that comes up is H = 2 Z v(L), Z the impedance of
the rock behind the start and v(L) the end's velocity by an end stress of 1 (`laplace.transfer`). It
is divided by in the frequency domain, with a water level where the joints let little through
(Clayton & Wiggins, Geophys. J. R. Astr. Soc. 47, 1976):

    incoming = surface conj(H) / max(|H|^2, (w max|H|)^2)

Of uniform rock H = 2 exp(-i omega L / c): half of the record, L / c earlier.

Holds for linear joints and rock, along the axis or, where the load is across it, in shear alone.
"""

from dataclasses import replace
from math import ceil, sqrt

import numpy as np
import xarray as xr

from cases.errors import SceneError
from cases.material.calibrate import Properties, calibrate
from cases.schema.scene import Scene
from compare.exact.bar import equivalent_bar, jointed_bar
from compare.exact.bar.transfer import Bar, end_of, transfer
from compare.exact.conditions import DAMPED, beyond

HELD = (
    *("spatial motion", "reversed load", "gravity", "prestress", "stiff layers", "soft layers"),
    *("segments", "scatter"),
)


def deconvolve(scene: Scene, surface: xr.DataArray, water_level: float = 1e-3) -> xr.DataArray:
    """Return the wave that comes up to a column's quiet start, from the motion of its free end.

    It is what `load.quantity` of a compliant base takes, with the same unit and sampling interval,
    and begins earlier than the record by the time that intact rock takes.

    Parameters
    ----------
    scene : a pillar, of whose load the direction alone counts; ends "quiet" and "free".
    surface : velocity or acceleration over `time` (s) alone, equally spaced, of
        the whole motion: where it is cut off, the end of what is found is off.
    water_level : w, of the largest |H|: frequencies that the joints pass less of are held back.

    Raises SceneError where the column is not linear.
    """
    import xarray as xr
    from scipy.fft import next_fast_len

    bar, impedance = _column(scene)
    n, time = surface.sizes["time"], surface.time.values
    dt = (time[-1] - time[0]) / (n - 1)
    lead = ceil(_crossing(bar) / dt)
    count = next_fast_len(2 * (n + 2 * lead))
    s = 2j * np.pi * np.fft.rfftfreq(count, dt)
    H = 2 * impedance * transfer(bar, s, np.array([bar.length]))[1][0]
    inverse = H.conj() / np.maximum(np.abs(H), water_level * np.abs(H).max()) ** 2
    found = np.fft.irfft(np.fft.rfft(surface.values, count) * inverse, count)
    earlier = time[0] + dt * np.arange(-lead, n)
    return xr.DataArray(np.roll(found, lead)[: n + lead], {"time": earlier}, attrs=surface.attrs)


def _column(scene: Scene) -> tuple[Bar, float]:
    """Return a scene's column, and the impedance of the rock behind its start, Pa s/m."""
    p, load = calibrate(scene), scene.load
    slips = p.friction is not None or p.cohesion is not None
    reasons = [
        (
            (scene.ends.start, scene.ends.end) != ("quiet", "free"),
            "the ends are not quiet and free",
        ),
        (load.is_across and scene.motion.rotation != "none", "motion.rotation is not 'none'"),
        (load.is_across and bool(load.direction[1]), "the load is neither along nor across"),
        (load.is_across and slips, "a joint may slip"),
    ]
    found = beyond(scene, *HELD, *DAMPED) or next((why for there, why in reasons if there), None)
    if found:
        raise SceneError(scene.where, "", None, f"cannot be deconvolved: {found}")
    if not scene.is_uniform:
        known = p.own_stiffness is not None
        rock = (jointed_bar if known else equivalent_bar).bar(scene)
        impedance = p.at_start.impedance
        return replace(rock, start=end_of("quiet", impedance), end=end_of("free", 0.0)), impedance
    modulus, compliance = _sheared(scene, p) if load.is_across else _stretched(p)
    etas, impedance = p.joint_time_constant, p.shear_impedance if load.is_across else p.impedance
    bar = Bar(
        length=scene.pillar.length,
        density=p.density,
        modulus=modulus,
        time_constant=p.time_constant or 0.0,
        joint_y=p.joint_y,
        joint_compliance=compliance,
        joint_time_constant=np.zeros_like(p.joint_y) if etas is None else etas,
        start=end_of("quiet", impedance),
        end=end_of("free", impedance),
    )
    return bar, impedance


def _crossing(bar: Bar) -> float:
    """Return how long a wave takes from end to end of the rock of a bar, s."""
    if not bar.rocks:
        return bar.length * sqrt(bar.density / bar.modulus)
    lengths = np.diff([*(rock.y for rock in bar.every), bar.length])
    slowness = [sqrt(rock.density / rock.modulus) for rock in bar.every]
    return float(lengths @ slowness)


def _stretched(p: Properties) -> tuple[float, np.ndarray]:
    """Return the modulus (Pa) and the compliance of every joint (m/Pa) along the axis: of intact
    rock and its joints or, where that is not known, of the rock mass and what joints add to it."""
    if p.own_stiffness is None or p.intact_modulus is None:
        return p.modulus, p.excess_compliance
    return p.intact_modulus, 1 / p.own_stiffness


def _sheared(scene: Scene, p: Properties) -> tuple[float, np.ndarray]:
    """Return the same across the axis."""
    if p.own_shear_stiffness is None or p.intact_modulus is None:
        return p.shear_modulus, 1 / p.shear_stiffness - 1 / p.regular_shear_stiffness
    return p.intact_modulus / (2 * (1 + scene.rock.intact_poisson)), 1 / p.own_shear_stiffness
