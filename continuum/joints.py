"""The joints of a pillar that a model resolves."""

from typing import NamedTuple

import numpy as np

from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.material.closure import stress_in_reach
from jointwave.cases.schema.scene import Scene
from jointwave.joints.shear import UNLIMITED

#: Part of an ordinary joint's compliance that a soft layer which differs in strength only takes out
#: of the homogenised rock.
SHARE = 0.1
LEAST = 1e-300  # m/Pa: above zero, for divisions


class Resolved(NamedTuple):
    """The joints that a model resolves; arrays except `number` are for all joints of the pillar.

    number : of the resolved joints [n]. stiffness, shear_stiffness : Pa/m. time_constant : eta, s;
    None without dashpots. less : of joints that stiffen, the compliance that the rock includes,
    m/Pa. share : part of an ordinary joint's compliance that the rock beside a layer loses to it.
    """

    number: np.ndarray
    stiffness: np.ndarray
    shear_stiffness: np.ndarray
    time_constant: np.ndarray | None
    less: np.ndarray
    share: np.ndarray


def layers_of(scene: Scene) -> dict[int, float]:
    """Return the thickness (m) of the joints of a pillar that are meshed layers, in order."""
    found = zip(calibrate(scene).soft.tolist(), scene.soft_layers, strict=True)
    return dict(sorted((joint, one.thickness) for joint, one in found if one.thickness is not None))


def resolved_joints(scene: Scene, model: str, shears: bool, loses: bool = True) -> Resolved:
    """Return all joints ("jointed"), or the soft layers with their excess compliance
    ("equivalent"). Homogenised rock gives compliance to layers that are meshed, can fail, or can
    become stiffer than ordinary joints.

    shears : whether the motion has components along the joints. loses : whether the rock can give
    compliance: not the rock of a script or in a mesh from a file.
    """
    p, meshed = calibrate(scene), list(layers_of(scene))
    less, share = np.zeros((2, p.block_count - 1))
    if model == "jointed":
        assert p.own_stiffness is not None and p.own_shear_stiffness is not None
        number, etas = np.setdiff1d(p.resolved, meshed), p.own_time_constant
        return Resolved(number, p.own_stiffness, p.own_shear_stiffness, etas, less, share)
    excess, ordinary = p.excess_compliance, p.half_joint[:, 1:] + p.half_joint[:, :-1]
    excess = np.array([excess, p.excess_shear_compliance])
    alike = (excess == 0)[: 1 + shears]
    number, etas = p.soft[(~alike.all(axis=0) | _fails(p, shears))[p.soft]], None
    if loses:
        share[number] = SHARE * alike.any(axis=0)[number]
        share[meshed] = 1.0
        closes, of = _closing(scene, excess[0] + ordinary[0])
        less[closes] = np.minimum(of, ordinary[0, closes])
        share[closes] = 1 - less[closes] / np.maximum(ordinary[0, closes], LEAST)
    # A joint without any compliance of its own softens the rock by SHARE of an ordinary joint.
    least = SHARE / np.stack(np.broadcast_arrays(p.regular, p.regular_shear_stiffness))
    own = np.where(excess + share * ordinary == 0, least, excess + share * ordinary)
    normal, shear = 1 / own
    if p.joint_time_constant is not None:
        eta, other = p.excess_time_constant, p.ordinary_time_constant
        etas = (excess[0] * eta + share * ordinary[0] * other) / own[0]
    return Resolved(np.setdiff1d(number, meshed), normal, shear, etas, less, share)


def _closing(scene: Scene, compliance: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the joints that stiffen [n], and half of their compliance under the stress in reach
    [n], m/Pa; compliance : initial, of all joints, m/Pa."""
    most = calibrate(scene).maximum_closure
    if most is None:
        return np.zeros(0, int), np.zeros(0)
    closes = np.flatnonzero(most < UNLIMITED)
    own = compliance[closes]
    return closes, own / (1 + stress_in_reach(scene) * own / most[closes]) ** 2 / 2


def _fails(p: Properties, shears: bool) -> np.ndarray:
    """Return which joints can open, slide, break or close nonlinearly, bool array [N - 1]."""
    found = ~p.tension | p.across()
    if shears and p.cohesion is not None:
        found = found | (p.cohesion < UNLIMITED)
    elif shears and p.friction is not None:
        found = np.ones_like(found)
    return found
