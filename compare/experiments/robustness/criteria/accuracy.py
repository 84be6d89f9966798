"""Criteria of accuracy: the largest error of a scheme of second order from the exact solution.

Near a critical step, beside stiff joints or at a resonance an unstable scheme may be wrong but
finite. Every such run is therefore compared with the error that a stable one can have.
"""

from math import pi, sqrt

import numpy as np
import xarray as xr

from compare.engines import solve, solvers
from compare.experiments.robustness.case import EPS, CaseTrial, Judgement, criterion
from compare.misfit.metrics import misfit
from compare.solvers.continuum import JOINTED_ROCK

SECOND_ORDER = "misfit from the exact solution, at most the phase error of a second-order scheme"

#: Root mean squares of f^3 and f^5 over the spectrum of a Ricker wavelet, f^2 exp(-f^2) with its
#: peak at f = 1: sqrt of Gamma(11/2) / Gamma(5/2) / 2^3 and Gamma(15/2) / Gamma(5/2) / 2^5.
CUBES, FIFTHS = 2.22, 6.64
#: Relative error of a frequency over (omega dt)^2. Leapfrog: sin(W dt/2) = omega dt / 2. Trapezoid:
#: tan(W dt/2) = omega dt/2; generalised alpha lags a little more.
ERROR = {"leapfrog": 1 / 24, "fourth-order": 1 / 24, "explicit": 1 / 24, "implicit": 1 / 6}
REFEREE = 5e-6  # of the exact bars: their inversion takes the mean load of steps, 6e-7 at the peak


def phase_error(trial: CaseTrial, result: xr.Dataset) -> float:
    """Return the misfit due to the steps of a second-order scheme at the end of a run.

    A relative error e of the frequency omega is the phase e omega t at time t, and a wave that is
    wrong by a small phase has a relative error of the same size: C (omega dt)^2 omega t, averaged
    over the spectrum.
    """
    omega = peak(trial)
    step = omega * float(result.attrs["dt"])
    return ERROR[trial.scheme] * step**2 * CUBES * omega * trial.duration


def element_error(trial: CaseTrial) -> float:
    """Return the misfit due to quadratic GLL elements at the end of a run; none for blocks.

    Their phase speed is wrong by (omega tau)^4 / 2880, tau the time through an element (Ainsworth &
    Wajid, SIAM J. Numer. Anal. 47, 2009). The traction of a joint that is recorded is known to the
    round-off of its gap, eps K u, with u no more than 2 p t / Z under a stress p; ten operations of
    this are allowed.
    """
    if trial.engine.has_rigid_blocks:
        return 0.0
    p, omega, t = trial.properties, peak(trial), trial.scene.time.duration
    phase = (omega * time_of_element(trial)) ** 4 / 2880 * FIFTHS * omega * t
    own = p.own_stiffness if trial.engine is JOINTED_ROCK else p.stiffness
    assert own is not None
    read = own[np.rint(np.array(trial.scene.record.stress) / p.spacing).astype(int) - 1]
    return phase + 10 * EPS * float(read.max()) * 2 * t / p.impedance


def corner_error(trial: CaseTrial, result: xr.Dataset) -> float:
    """Return the misfit from the two kinks of a sine that starts and ends; none for a wavelet.

    A change of slope s has the spectrum s / omega^2; what of it is beyond the w of `lost_after` is
    lost: by Parseval s^2 (4 + 1/5) / (3 pi w^3), against cycles T / 2 of the sine.
    """
    load, omega = trial.scene.load, peak(trial)
    if load.shape != "sine":
        return 0.0
    w = 1 / lost_after(trial, result)
    square = 2 * omega**2 * 4.2 / (3 * pi * w**3)
    return sqrt(square / ((load.cycles or 1) * (load.period or 0.0) / 2))


def lost_after(trial: CaseTrial, result: xr.Dataset) -> float:
    """Return 1 / w (s): frequencies beyond w have lost their phase by the end of a run.

    That of the steps is C (w dt)^2 w t = 1, that of elements (w tau)^4 w t / 2880 = 1.
    """
    t, dt = trial.scene.time.duration, float(result.attrs["dt"])
    lost = (ERROR[trial.scheme] * dt**2 * t) ** (1 / 3)
    if trial.engine.has_rigid_blocks:
        return lost
    return lost + (time_of_element(trial) ** 4 * t / 2880) ** (1 / 5)


def peak(trial: CaseTrial) -> float:
    """Return the angular frequency of the peak of the load's spectrum, rad/s."""
    return 2 * pi / (trial.period or trial.duration)


def time_of_element(trial: CaseTrial) -> float:
    """Return the travel time of a wave through an element of the rock, s."""
    from continuum.build import elements_for

    scene, p = trial.scene, trial.properties
    modulus = p.intact_modulus if trial.engine is JOINTED_ROCK else p.modulus
    count = scene.numerics.continuum.elements_per_block
    count = count or elements_for(scene, p, str(trial.engine.model))
    return p.spacing / count / sqrt((modulus or p.modulus) / p.density)


def referee(trial: CaseTrial) -> tuple[str, float]:
    """Return the first exact solution of the model that the engine discretises, and the misfit of
    the engine's result from it."""
    own = (one for one in solvers() if one.exact and one.discretised)
    for one in own:
        if one.rock is trial.engine.rock and one.applies(trial.scene):
            return one.name, misfit(trial.result, solve(one.name, trial.scene))
    raise LookupError(f"no exact solution applies to {trial.case.name}")


@criterion(SECOND_ORDER)
def near_exact(trial: CaseTrial) -> Judgement:
    """The misfit from the exact solution is at most the scheme's phase error (and elements')."""
    name, found = referee(trial)
    bound = phase_error(trial, trial.result) + element_error(trial) + REFEREE
    bound += corner_error(trial, trial.result)
    return Judgement(found, bound, f"misfit from {name}")
