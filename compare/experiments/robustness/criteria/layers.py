"""Criteria for joints of almost no stiffness or almost no compliance."""

from math import sqrt

import numpy as np
import xarray as xr

from cases.loads import load_history, step_means
from cases.sampling import interpolation
from compare.exact.bar import jointed_bar
from compare.exact.schemes.leapfrog import modes, of_modes
from compare.experiments.robustness.case import CaseTrial, Judgement, criterion
from compare.experiments.robustness.criteria.accuracy import (
    REFEREE,
    SECOND_ORDER,
    element_error,
    peak,
    phase_error,
)
from compare.misfit.metrics import relative_l2


@criterion("misfit in front of it from a pillar that ends there, at most the layer's leakage")
def free_end(trial: CaseTrial) -> Judgement:
    """In front of a layer of almost no stiffness the pillar ends free.

    The layer passes K times its gap. A face moves no further than twice the incident velocity takes
    it, so K gap <= K 2 p t / Z, which leaks at each of the n passes along the pillar. A layer of
    thickness and of impedance Z_2 also takes up a wave of 2 Z_2 / Z of the stress. The other pillar
    is the same solver's, of half the length.
    """
    (layer,) = trial.scene.soft_layers
    in_front = {"record__stress": [layer.y / 2], "record__velocity": []}
    short = trial.run(pillar__length=layer.y, soft_layers=[], **in_front)
    whole = trial.run(**in_front)
    p, t = trial.properties, trial.scene.time.duration
    leak = (layer.normal_stiffness or 0.0) * 2 * t / p.impedance
    elastic = (layer.normal_stiffness or 0.0) * (layer.thickness or 0.0)  # E = K h; 0 of a joint
    leak += 2 * sqrt(elastic * p.density) / p.impedance
    passes = p.bar_speed * t / layer.y
    found = relative_l2(whole["stress"].values, short["stress"].values)
    return Judgement(found, passes * leak + 2 * _of_steps(trial, whole, short), "misfit")


def _of_steps(trial: CaseTrial, one: xr.Dataset, other: xr.Dataset) -> float:
    """Return the allowed difference of two runs due to their steps: round-off if equal."""
    if one.attrs["dt"] == other.attrs["dt"]:
        return 1e-15 * float(one.attrs["steps"])
    return phase_error(trial, one)


@criterion("misfit from the exact bar without it, at most its delay and the phase error")
def no_layer(trial: CaseTrial) -> Judgement:
    """A joint of almost no compliance leaves whole rock.

    It lets a wave of frequency omega pass with 1 / |T| - 1 < (Z omega / 2 K)^2 / 2 and a delay of
    Z omega / 2 K, once a pass. The exact bar has a joint of K = 1e30 Pa/m there.
    """
    result, scene, p = trial.result, trial.scene, trial.properties
    (layer,) = scene.soft_layers
    welded = trial.changed(soft_layers=[{"y": layer.y, "normal_stiffness": 1e30}])
    exact = jointed_bar.solve(welded)
    delay = p.impedance * 2 * peak(trial) / (2 * (layer.normal_stiffness or np.inf))
    passes = p.bar_speed * scene.time.duration / scene.pillar.length
    found = relative_l2(result["stress"].values, exact["stress"].values)
    bound = passes * delay + phase_error(trial, result) + element_error(trial) + REFEREE
    return Judgement(found, bound, "misfit from the bar without it")


@criterion("misfit from the chain in which the two blocks are one")
def welded_blocks(trial: CaseTrial) -> Judgement:
    """Two rigid blocks on a joint of almost no compliance are one block.

    The exact chain has their masses as one (modes of the assembled chain, leapfrog in closed form);
    the joint's own motion, of frequency sqrt(2 k / m), is quasi-static and adds k_0 / k.
    """
    (layer,), p = trial.scene.soft_layers, trial.properties
    compliance = p.regular_stiffness / p.stiffness[p.soft[0]]
    bound = phase_error(trial, trial.result) + compliance
    return Judgement(_off_chain(trial, layer.y), bound, "misfit of displacements")


@criterion(SECOND_ORDER)
def as_chain(trial: CaseTrial) -> Judgement:
    """The displacements are those of leapfrog on this chain in closed form.

    For leapfrog to round-off, an eps each step; the fourth-order scheme, beside leapfrog at its
    own four forces a step, to the phase error of that.
    """
    bound = phase_error(trial, trial.result)
    if trial.scheme == "leapfrog":
        bound = ROUND_OFF * float(trial.result.attrs["steps"])
    return Judgement(_off_chain(trial), bound, "misfit of displacements from the closed form")


ROUND_OFF = 2e-15  # some operations of eps each


def _off_chain(trial: CaseTrial, weld: float | None = None) -> float:
    """Return the misfit of the displacements from those of leapfrog in closed form, at a step for
    each evaluation of the forces. weld : y of a joint whose blocks are one, m."""
    about = trial.result.attrs
    dt = float(about["dt"] * about["steps"] / about["force_evaluations"])
    exact = _displacements(trial, dt, weld)
    return relative_l2(trial.result["displacement"].values[..., 0], exact)


def _displacements(trial: CaseTrial, dt: float, weld: float | None) -> np.ndarray:
    """Return the displacements [points, n] (m) of an undamped chain of free ends at the result's
    times, of any joints, by leapfrog at a step of dt (s): round-off is all that is left."""
    scene, p = trial.scene, trial.properties
    block = np.arange(p.block_count)
    if weld is not None:
        block[round(weld / p.spacing) :] -= 1
    mass = p.block_mass * np.bincount(block).astype(float)
    k = (p.stiffness * p.area)[np.diff(block) > 0]
    root = np.sqrt(k)[:, None] * np.diff(np.eye(len(mass)), axis=0)
    steps = np.rint(trial.result["time"].values / dt).astype(int)
    force = p.area * step_means(load_history(scene), dt, int(steps[-1]) + 1)
    u = of_modes(modes(mass, root), np.eye(len(mass))[0], force, steps, dt)[block]
    centres = p.spacing * (np.arange(p.block_count) + 0.5)
    left, right, weight = interpolation(centres, scene.record.velocity)
    weight = weight[:, None]
    return (1 - weight) * u[left] + weight * u[right]
