"""Criteria for joints that all but part, or all but vanish."""

from __future__ import annotations

from math import sqrt

import numpy as np
import xarray as xr

from cases.material.calibrate import Properties, calibrate
from cases.schema.joint import SoftLayer
from compare.exact.bar import jointed_bar
from compare.experiments.robustness.case import Finding, Trial
from compare.experiments.robustness.criteria.accuracy import (
    REFEREE,
    element_error,
    peak,
    phase_error,
)
from compare.misfit.metrics import relative_l2


def free_end(trial: Trial) -> Finding:
    """In front of a layer of almost no stiffness the pillar ends free.

    The layer passes K times its gap. A face moves no further than twice the incident velocity takes
    it, so K gap <= K 2 p t / Z, which leaks at each of the n passes along the pillar. A layer of
    thickness and of impedance Z_2 also takes up a wave of 2 Z_2 / Z of the stress. The other pillar
    is the same solver's, of half the length.
    """
    scene = trial.scene()
    (layer,) = scene.soft_layers
    short = trial.run(pillar__length=layer.y, soft_layers=[], **_in_front(trial))
    whole = trial.run(**_in_front(trial))
    p, t = calibrate(scene), scene.time.duration
    leak = (layer.normal_stiffness or 0.0) * 2 * t / p.impedance
    leak += 2 * _impedance(layer, p) / p.impedance
    passes = p.bar_speed * t / layer.y
    found = relative_l2(whole["stress"].values, short["stress"].values)
    return Finding(found, passes * leak + 2 * _of_steps(trial, whole, short), "misfit")


def _impedance(layer: SoftLayer, p: Properties) -> float:
    """Return sqrt(E rho) of a layer of thickness, E = K h, Pa s/m; 0 of a joint."""
    return sqrt((layer.normal_stiffness or 0.0) * (layer.thickness or 0.0) * p.density)


def _in_front(trial: Trial) -> dict:
    """Return what to record: a stress in front of the layer."""
    (layer,) = trial.scene().soft_layers
    return {"record__stress": [layer.y / 2], "record__velocity": []}


def _of_steps(trial: Trial, one, other) -> float:
    """Return what two runs may differ by through their steps: round-off where these are equal."""
    if one.attrs["dt"] == other.attrs["dt"]:
        return 1e-15 * float(one.attrs["steps"])
    return phase_error(trial, one)


def no_layer(trial: Trial) -> Finding:
    """A joint of almost no compliance leaves whole rock.

    It lets a wave of frequency omega pass with 1 / |T| - 1 < (Z omega / 2 K)^2 / 2 and a delay of
    Z omega / 2 K, once a pass. The exact bar has a joint of K = 1e30 Pa/m there.
    """
    result, scene = trial.run(), trial.scene()
    (layer,) = scene.soft_layers
    welded = trial.scene(soft_layers=[{"y": layer.y, "normal_stiffness": 1e30}])
    exact = jointed_bar.solve(welded)
    p = calibrate(scene)
    delay = p.impedance * 2 * peak(trial) / (2 * (layer.normal_stiffness or np.inf))
    passes = p.bar_speed * scene.time.duration / scene.pillar.length
    found = relative_l2(result["stress"].values, exact["stress"].values)
    bound = passes * delay + phase_error(trial, result) + element_error(trial) + REFEREE
    return Finding(found, bound, "misfit from the bar without it")


def welded_blocks(trial: Trial) -> Finding:
    """Two rigid blocks on a joint of almost no compliance are one block.

    The exact chain has their masses as one (modes of the assembled chain, leapfrog in closed form);
    the joint's own motion, of frequency sqrt(2 k / m), is quasi-static and adds k_0 / k.
    """
    from compare.experiments.robustness.criteria.chains import displacements

    result, scene = trial.run(), trial.scene()
    (layer,) = scene.soft_layers
    exact = displacements(scene, _force_step(result), result["time"].values, weld=layer.y)
    found = relative_l2(result["displacement"].values[..., 0], exact)
    p = calibrate(scene)
    compliance = p.regular_stiffness / p.stiffness[p.soft[0]]
    return Finding(found, phase_error(trial, result) + compliance, "misfit of displacements")


def as_chain(trial: Trial) -> Finding:
    """The displacements are those of leapfrog on this chain in closed form.

    For leapfrog to round-off, an eps each step; the fourth-order scheme, beside leapfrog at its
    own four forces a step, to the phase error of that.
    """
    from compare.experiments.robustness.criteria.chains import displacements

    result, scene = trial.run(), trial.scene()
    exact = displacements(scene, _force_step(result), result["time"].values)
    found = relative_l2(result["displacement"].values[..., 0], exact)
    bound = phase_error(trial, result)
    if trial.solver.scheme == "leapfrog":
        bound = ROUND_OFF * float(result.attrs["steps"])
    return Finding(found, bound, "misfit of displacements from the closed form")


ROUND_OFF = 2e-15  # some operations of eps each


def _force_step(result: xr.Dataset) -> float:
    """Return the time between two evaluations of the forces, s."""
    steps, forces = result.attrs["steps"], result.attrs["force_evaluations"]
    return float(result.attrs["dt"] * steps / forces)
