"""The joints of a pillar that a model resolves."""

from typing import NamedTuple

import numpy as np

from jointwave.cases.material.calibrate import Properties
from jointwave.joints.shear import UNLIMITED

#: Over an ordinary joint: the stiffness of one that differs from it in strength alone, where the
#: homogenised bar holds it already. It makes the rock softer by a tenth of one joint.
RIGID = 10.0


class Resolved(NamedTuple):
    """The joints that a model resolves, by their number in the pillar.

    number : int array [n]. stiffness, shear_stiffness : [pillar's joints], Pa/m. time_constant :
    eta of theirs, s; None without dashpots.
    """

    number: np.ndarray
    stiffness: np.ndarray
    shear_stiffness: np.ndarray
    time_constant: np.ndarray | None


def resolved_joints(
    p: Properties, model: str, shears: bool, meshed: tuple[int, ...] = ()
) -> Resolved:
    """Return all joints ("jointed"), or the soft layers by their excess ("equivalent").

    shears : whether the motion has components along the joints. meshed : joints that are layers of
    rock in the mesh.
    """
    if model == "jointed":
        assert p.own_stiffness is not None and p.own_shear_stiffness is not None
        number, etas = p.resolved, p.own_time_constant
        normal, shear = p.own_stiffness, p.own_shear_stiffness
    else:
        number, etas = p.soft, p.joint_time_constant
        normal = _excess(p.excess_compliance, p.regular)
        shear = _excess(p.excess_shear_compliance, p.regular_shear_stiffness)
        differs = (p.excess_compliance != 0) | (shears & (p.excess_shear_compliance != 0))
        differs |= _fails(p, shears)
        number = number[differs[number]]
    return Resolved(np.setdiff1d(number, meshed), normal, shear, etas)


def _excess(compliance: np.ndarray, regular: float | np.ndarray) -> np.ndarray:
    with np.errstate(divide="ignore"):
        return np.where(compliance == 0, RIGID * regular, 1 / compliance)


def _fails(p: Properties, shears: bool) -> np.ndarray:
    """Return which joints can open, slide, break or close nonlinearly, bool array [N - 1]."""
    found = ~p.tension | p.across()
    if shears and p.cohesion is not None:
        found = found | (p.cohesion < UNLIMITED)
    elif shears and p.friction is not None:
        found = np.ones_like(found)
    return found
