"""Joints of the chain between rock of a quality factor: each with its part of the rock in series, a
spring that relaxes (`cases.material.constant_q`)."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from jointwave.cases.material.calibrate import Properties
from jointwave.cases.material.constant_q import Mechanisms, in_series, mechanisms_of
from jointwave.cases.schema.scene import Scene


class RelaxingJoints(NamedTuple):
    """How the joints [j] relax in steps dt, by mechanisms [l, j], as `continuum.model.Memory` has
    it for displacements: e_l <- decay e_l + gain times the gap's rate, and the traction that of the
    unrelaxed joint under the gap relaxed gap + sum_l share e_l.

    spring : what the energies of the springs e_l count, over that of the joint under the gap e_l.
    loss : what a step takes, over the joint's energy under the sum of e_l before and after.
    """

    relaxed: np.ndarray
    share: np.ndarray
    decay: np.ndarray
    gain: np.ndarray
    spring: np.ndarray
    loss: np.ndarray


def unrelaxed(scene: Scene, p: Properties) -> Properties:
    """Return the numbers of a scene with its joints as stiff as they are at once, and no dashpots:
    what these do is part of the relaxation. p itself without a quality factor."""
    found = _of_joints(scene, p)
    if found is None:
        return p
    at_once = np.array([one.unrelaxed for one in found])
    stiffness = at_once * p.stiffness
    return replace(p, stiffness=stiffness, time_constant=None, joint_time_constant=None)


def relaxation(scene: Scene, p: Properties, dt: float) -> RelaxingJoints | None:
    """Return how the joints relax in steps dt (s); None without a quality factor."""
    found = _of_joints(scene, p)
    if found is None:
        return None
    omega = np.ones((max(one.share.size for one in found), len(found)))
    share = np.zeros_like(omega)
    for j, one in enumerate(found):
        omega[: one.share.size, j], share[: one.share.size, j] = one.frequency, one.share
    x = omega * dt
    spring = share * x / 2 / np.tanh(x / 2)
    return RelaxingJoints(
        1 - share.sum(axis=0), share, np.exp(-x), -np.expm1(-x) / omega, spring, share * x / 2
    )


def _of_joints(scene: Scene, p: Properties) -> list[Mechanisms] | None:
    """Return the mechanisms of every joint [N - 1] with its rock in series; None without."""
    rock = mechanisms_of(scene, "jointed")
    if rock is None:
        return None
    assert p.own_stiffness is not None
    own, etas = 1 / p.own_stiffness, p.own_time_constant
    ratio = own / (1 / p.stiffness - own)
    eta = np.zeros_like(ratio) if etas is None else etas
    kinds, kind = np.unique(np.stack([ratio, eta]), axis=1, return_inverse=True)
    found = [in_series(rock, *pair) for pair in kinds.T.tolist()]
    return [found[k] for k in kind.ravel()]
