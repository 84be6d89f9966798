"""Criteria for loads, sizes and shapes at the edge of what numbers and elements can hold."""

from __future__ import annotations

from math import pi, sqrt

import numpy as np
import xarray as xr

from cases.calibrate import calibrate
from cases.errors import SceneError
from compare.engines import applies, solve
from compare.exact import equivalent_bar, jointed_bar
from compare.metrics import misfit, relative_l2
from compare.stability.accuracy import ERROR, HIGHEST, REFEREES, SPATIAL, phase_error
from compare.stability.case import Finding, Trial


def shock(trial: Trial) -> Finding:
    """A jump in stress is as wrong as the dispersion of steps and elements makes it.

    The spectrum of a jump is 1 / omega. A frequency has the phase error C (omega dt)^2 omega t of
    the steps and (omega h / c)^4 omega t / 2880 of quadratic GLL elements (Ainsworth & Wajid, SIAM
    J. Numer. Anal. 47, 2009). Beyond the w where it is 1 a frequency is lost (twice its amplitude
    at worst), below it is wrong by its phase: with it growing as a power of three or more, Parseval
    gives the square of the error as (4 + 1/5) / (pi w). That of the signal is at least t / 4: each
    section is under stress for a quarter of the time or more.
    """
    result, scene = trial.run(), trial.scene()
    names = [name for name in REFEREES[trial.solver.engine] if applies(name, scene)]
    t, dt = scene.time.duration, float(result.attrs["dt"])
    lost = (ERROR[trial.solver.scheme] * dt**2 * t) ** (1 / 3)
    lost += (_time_of_element(trial) ** 4 * t / 2880) ** (1 / 5)
    return Finding(
        misfit(result, solve(names[0], scene)),
        sqrt(4.2 / pi * lost / (t / 4)),
        f"misfit from {names[0]}",
    )


def _time_of_element(trial: Trial) -> float:
    """Return how long a wave takes through an element, s; 0 in rigid blocks."""
    if trial.solver.engine == "dem":
        return 0.0
    from continuum.build import elements_for

    scene, model = trial.scene(), trial.solver.engine.removeprefix("continuum-")
    p = calibrate(scene)
    modulus = p.intact_modulus if model == "jointed" else p.modulus
    return p.spacing / elements_for(scene, p, model) / sqrt((modulus or p.modulus) / p.density)


def in_space(trial: Trial) -> Finding:
    """Stress, motion and rotation of a row of blocks in space are within the phase error of the
    exact row, whatever the inertia of the blocks: each apart, as they differ in size."""
    result, scene = trial.run(), trial.scene()
    exact = solve("spatial-lattice", scene)
    found = {
        name: relative_l2(result[name].values, exact[name].values)
        for name in ("stress", "shear", "velocity", "rotation")
        if exact[name].values.any()
    }
    worst = max(found, key=lambda name: found[name])
    return Finding(found[worst], phase_error(trial, result), f"misfit of the {worst}")


def nothing(trial: Trial) -> Finding:
    """Without a load nothing moves: every number of the result is zero, not merely small."""
    result = trial.run()
    found = [np.abs(v.values).max() for v in result.data_vars.values() if v.dtype.kind == "f"]
    return Finding(float(max(found)), 0.0, "largest number of the result")


def scaled(trial: Trial) -> Finding:
    """What is linear scales with its load: over the amplitude, the result is that of 1 Pa.

    Only the factor rounds, at the load and at the result, by an eps each; every step keeps its
    relative error, which a sum over steps multiplies by at most their number.
    """
    one = trial.run(load__amplitude=1.0)
    result, amplitude = trial.run(), trial.scene().load.amplitude
    found = max(
        relative_l2(result[name].values / amplitude, one[name].values)
        for name in ("stress", "velocity")
    )
    return Finding(found, 2.2e-16 * (2 + float(one.attrs["steps"])), "misfit over the amplitude")


def refused(trial: Trial) -> Finding:
    """What cannot be computed is refused in one line that names the key."""
    try:
        trial.run()
    except SceneError as error:
        text = str(error)
        return Finding(float("\n" in text or error.key not in text), 0.0, text)
    return Finding(1.0, 0.0, "was not refused")


def untouched_far_end(trial: Trial) -> Finding:
    """What no wave has reached does not matter: a long pillar's first blocks do what those of a
    short one do, bit by bit in explicit steps, which pass on one block a step."""
    long = trial.run()
    short = trial.run(pillar__length=500.0)
    assert long.attrs["dt"] == short.attrs["dt"]
    found = relative_l2(long["stress"].values, short["stress"].values)
    return Finding(found, 0.0, f"misfit of {long.attrs['degrees_of_freedom']:,} freedoms")


def as_bar(trial: Trial) -> Finding:
    """A slender column of solid elements is a bar, whatever the shape of its elements.

    Elements that lock are too stiff, and a poor condition shows as noise. Love's correction for the
    square section, nu^2 k^2 a^2 / 12 of the speed, is all that theory allows beside the steps'.
    """
    result, scene = trial.run(), trial.scene()
    exact = _bar(trial, scene)
    p = calibrate(scene)
    omega = 2 * pi * HIGHEST / (scene.load.period or scene.time.duration)
    poisson = max(p.poisson, scene.rock.intact_poisson)
    love = (poisson * omega / p.bar_speed * p.side) ** 2 / 12 * omega * scene.time.duration
    bound = phase_error(trial, result) + SPATIAL + love
    return Finding(relative_l2(result["stress"].values, exact["stress"].values), bound, "misfit")


def _bar(trial: Trial, scene) -> xr.Dataset:
    """Return the exact bar of a scene whose section is solid."""
    exact = jointed_bar if trial.solver.engine == "continuum-jointed" else equivalent_bar
    return exact.solve(scene)
