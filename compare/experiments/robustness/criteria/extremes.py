"""Criteria for loads, sizes and shapes at the limits of numbers and elements."""

from math import pi, sqrt

import numpy as np

from cases.errors import SceneError
from compare.exact.bar import equivalent_bar, jointed_bar
from compare.exact.blocks import spatial_lattice
from compare.experiments.robustness.case import EPS, CaseTrial, Judgement, criterion
from compare.experiments.robustness.criteria.accuracy import (
    CUBES,
    REFEREE,
    element_error,
    lost_after,
    peak,
    phase_error,
    referee,
)
from compare.misfit.metrics import relative_l2
from compare.solvers.continuum import JOINTED_ROCK


@criterion("misfit from the exact solution, at most the dispersion of a second-order front")
def shock(trial: CaseTrial) -> Judgement:
    """A jump in stress is as wrong as the dispersion of steps and elements makes it.

    The spectrum of a jump is 1 / omega. A frequency beyond the w of `lost_after` is lost (twice its
    amplitude at worst), one below it is wrong by its phase: as this grows as the third power or
    more, Parseval gives the square of the error as (4 + 1/5) / (pi w). That of the signal is at
    least t / 4: each section is under stress for a quarter of the time or more.
    """
    name, found = referee(trial)
    lost = lost_after(trial, trial.result)
    bound = sqrt(4.2 / pi * lost / (trial.scene.time.duration / 4))
    return Judgement(found, bound, f"misfit from {name}")


@criterion("misfit from the exact row of blocks in space")
def in_space(trial: CaseTrial) -> Judgement:
    """Stress, motion and rotation of a row of blocks in space are within the phase error of the
    exact row, whatever the inertia of the blocks: each apart, as they differ in size."""
    result, exact = trial.result, spatial_lattice.solve(trial.scene)
    found = {
        name: relative_l2(result[name].values, exact[name].values)
        for name in ("stress", "shear", "velocity", "rotation")
        if exact[name].values.any()
    }
    worst = max(found, key=found.__getitem__)
    return Judgement(found[worst], phase_error(trial, result), f"misfit of the {worst}")


@criterion("largest number of the result")
def nothing(trial: CaseTrial) -> Judgement:
    """Without a load every number of the result is exactly zero."""
    numbers = (v.values for v in trial.result.data_vars.values() if v.dtype.kind == "f")
    found = [np.abs(values).max() for values in numbers]
    return Judgement(float(max(found)), 0.0, "largest number of the result")


@criterion("misfit from the result of 1 Pa times the amplitude")
def scaled(trial: CaseTrial) -> Judgement:
    """Linear results scale with the load: over the amplitude, the result is that of 1 Pa.

    Only the factor rounds, at the load and at the result, by an eps each; every step keeps its
    relative error, which a sum over steps multiplies by at most their number.
    """
    one, amplitude = trial.run(load__amplitude=1.0), trial.scene.load.amplitude
    found = max(
        relative_l2(trial.result[name].values / amplitude, one[name].values)
        for name in ("stress", "velocity")
    )
    return Judgement(found, EPS * (2 + float(one.attrs["steps"])), "misfit over the amplitude")


@criterion("refused in a line that names the key")
def refused(trial: CaseTrial) -> Judgement:
    """An uncomputable scene is refused, each mistake in one line that names the key."""
    try:
        trial.run()
    except SceneError as error:
        wrong = any("\n" in str(one) or not one.key for one in error.each)
        return Judgement(float(wrong), 0.0, f"{error.key}: {error.allowed}")
    return Judgement(1.0, 0.0, "was not refused")


@criterion("misfit from a pillar of a thousand blocks before any reflection")
def untouched_far_end(trial: CaseTrial) -> Judgement:
    """Rock that no wave has reached has no influence: a long pillar's first blocks move like those
    of a short one, bit-identical in explicit steps, which propagate by one block per step."""
    long, short = trial.result, trial.run(pillar__length=500.0)
    assert long.attrs["dt"] == short.attrs["dt"]
    found = relative_l2(long["stress"].values, short["stress"].values)
    return Judgement(found, 0.0, f"misfit of {long.attrs['degrees_of_freedom']:,} unknowns")


@criterion("misfit from the exact bar, at most Love's correction and the phase error")
def as_bar(trial: CaseTrial) -> Judgement:
    """A slender column of solid elements is a bar, whatever the shape of its elements.

    Elements that lock are too stiff, and a poor condition shows as noise. Love's correction for the
    square section, nu^2 k^2 a^2 / 12 of the speed, is all that theory allows beside the steps'.
    """
    result, scene, p = trial.result, trial.scene, trial.properties
    bar = jointed_bar if trial.engine is JOINTED_ROCK else equivalent_bar
    found = relative_l2(result["stress"].values, bar.solve(scene)["stress"].values)
    omega, poisson = peak(trial), max(p.poisson, scene.rock.intact_poisson)
    love = (poisson * omega / p.bar_speed * p.side) ** 2 / 12 * CUBES * omega * scene.time.duration
    bound = phase_error(trial, result) + element_error(trial) + REFEREE + love
    return Judgement(found, bound, "misfit")
