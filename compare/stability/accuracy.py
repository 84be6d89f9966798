"""Criteria of accuracy: how far a scheme of second order may be from the exact solution.

Near a critical step, beside stiff joints or at a resonance an unstable scheme is wrong without
being infinite. So every such run is held to the error that a stable one can have.
"""

from __future__ import annotations

from math import pi

import xarray as xr

from cases.result import energy_residual
from compare.engines import applies, solve
from compare.metrics import misfit
from compare.stability.case import Finding, Trial

#: Exact solutions of the models that the engines discretise, the first that applies counts.
REFEREES = {
    "dem": ("lattice", "no-tension-chain", "spatial-lattice"),
    "continuum-jointed": ("jointed-bar",),
    "continuum-equivalent": ("equivalent-bar",),
}

#: Of a wavelet with its peak at 1 / T, all but 1e-3 of the amplitude lies below this over T.
HIGHEST = 2.5
#: Relative error of a frequency over (omega dt)^2. Leapfrog: sin(W dt/2) = omega dt / 2. Trapezoid:
#: tan(W dt/2) = omega dt/2; generalised alpha lags a little more.
ERROR = {"leapfrog": 1 / 24, "fourth-order": 1 / 24, "explicit": 1 / 24, "implicit": 1 / 6}
SPATIAL = 1e-3  # of the elements, which are chosen by the engine to resolve the load


def phase_error(trial: Trial, result: xr.Dataset) -> float:
    """Return the phase error (rad) that a second-order scheme has at the end of a run.

    A relative error e of the frequency omega is the phase e omega t at time t, and a wave that is
    wrong by a small phase is wrong by as much relative to itself.
    """
    scene = trial.scene()
    omega = 2 * pi * HIGHEST / (scene.load.period or scene.time.duration)
    step = omega * float(result.attrs["dt"])
    return ERROR[trial.solver.scheme] * step**2 * omega * scene.time.duration


def near_exact(trial: Trial) -> Finding:
    """The misfit from the exact solution is at most the scheme's phase error (and elements')."""
    result, scene = trial.run(), trial.scene()
    names = [name for name in REFEREES[trial.solver.engine] if applies(name, scene)]
    if not names:
        raise LookupError(f"no exact solution applies to {trial.case.name}")
    found = misfit(result, solve(names[0], scene))
    elements = 0.0 if trial.solver.engine == "dem" else SPATIAL
    return Finding(found, phase_error(trial, result) + elements, f"misfit from {names[0]}")


def ledger_closes(trial: Trial) -> Finding:
    """The ledger's imbalance over the work put in is a sum of round-offs, one a step at worst."""
    result = trial.run()
    eps = 2.2e-16
    return Finding(energy_residual(result), 10 * eps * int(result.attrs["steps"]), "")
