"""The joints that a model resolves, and their law at every quadrature point."""

from typing import NamedTuple

import numpy as np

from cases.calibrate import Properties
from continuum.model import Interfaces, Measured, Memory, Tractions
from continuum.space.interface import Jumps
from continuum.space.sparse import rows
from continuum.space.stencils import runs
from joints.laws import Law
from joints.rows import zeros
from joints.uniform import law

#: Over an ordinary joint: the stiffness of one that differs from it in strength alone, where the
#: homogenised bar holds it already. It makes the rock softer by a tenth of one joint.
RIGID = 10.0


class Resolved(NamedTuple):
    """The joints that a model resolves, by their number in the pillar.

    number : int array [n]. stiffness, shear_stiffness : [pillar's joints], Pa/m.
    """

    number: np.ndarray
    stiffness: np.ndarray
    shear_stiffness: np.ndarray


def resolved_joints(
    p: Properties, model: str, shears: bool, meshed: tuple[int, ...] = ()
) -> Resolved:
    """Return all joints ("jointed"), or the soft layers by their excess ("equivalent").

    shears : whether the motion has components along the joints. meshed : joints that are layers of
    rock in the mesh.
    """
    if model == "jointed":
        assert p.own_stiffness is not None and p.own_shear_stiffness is not None
        number = np.arange(p.block_count - 1)
        normal, shear = p.own_stiffness, p.own_shear_stiffness
    else:
        number = p.soft
        normal = _excess(p.excess_compliance, p.regular_stiffness)
        same = np.isclose(p.shear_stiffness, p.regular_shear_stiffness, rtol=1e-9, atol=0)
        compliance = np.where(same, 0.0, 1 / p.shear_stiffness - 1 / p.regular_shear_stiffness)
        shear = _excess(compliance, p.regular_shear_stiffness)
        differs = (p.excess_compliance != 0) | (shears & (compliance != 0)) | _fails(p, shears)
        number = number[differs[number]]
    return Resolved(np.setdiff1d(number, meshed), normal, shear)


def _excess(compliance: np.ndarray, regular: float) -> np.ndarray:
    with np.errstate(divide="ignore"):
        return np.where(compliance == 0, RIGID * regular, 1 / compliance)


def _fails(p: Properties, shears: bool) -> np.ndarray:
    """Return which joints can open, slide or break, bool array [N - 1]."""
    from joints.shear import UNLIMITED

    found = ~p.tension
    if shears and p.cohesion is not None:
        found = found | (p.cohesion < UNLIMITED)
    elif shears and p.friction is not None:
        found = np.ones_like(found)
    if p.tensile_strength is not None:
        found = found | (p.tensile_strength < UNLIMITED)
    return found


def joint_law(p: Properties, joints: Resolved, joint: np.ndarray, shears: bool) -> Law:
    """Return the law at points [q] of these joints, in its smallest form.

    shears : whether the motion has components along the joints.
    """

    def at(values: np.ndarray | None) -> np.ndarray | None:
        return None if values is None else values[joint]

    strengths = {}
    if shears:
        strengths = {
            "shear_stiffness": at(joints.shear_stiffness),
            "cohesion": at(p.cohesion),
            "friction": at(p.friction),
            "residual_cohesion": at(p.residual_cohesion),
        }
    return law(
        joints.stiffness[joint],
        at(p.joint_time_constant),
        p.tension[joint],
        tensile_strength=at(p.tensile_strength),
        critical_opening=at(p.critical_opening),
        **strengths,
    )


def interfaces(jumps: Jumps, law: Law, prestress: float | None) -> Interfaces:
    """Return the joints of a model."""
    x, z = jumps.slip_x, jumps.slip_z
    return Interfaces(
        opening=rows(jumps.opening),
        slip_x=None if x is None else rows(x),
        slip_z=None if z is None else rows(z),
        area=jumps.weight,
        law=law,
        prestress=prestress,
        runs=tuple(None if matrix is None else runs(matrix) for matrix in (jumps.opening, x, z)),
    )


def memory(joints: Interfaces) -> Memory:
    """Return what the points remember before anything has happened."""
    q, law = joints.area.size, joints.law
    slides = law.cohesion is not None or law.friction is not None or _can_let_go(law)
    slides = slides and law.shear_stiffness is not None
    cohesion = None
    if law.residual_cohesion is not None and law.shear_stiffness is not None:
        cohesion = np.zeros(q) + law.cohesion
    return Memory(
        opening=None if law.tensile_strength is None else np.zeros(q),
        slide_x=np.zeros(q) if slides and joints.slip_x is not None else None,
        slide_z=np.zeros(q) if slides and joints.slip_z is not None else None,
        cohesion=cohesion,
    )


def _can_let_go(law: Law) -> bool:
    """Return whether an open joint carries no shear, so that its faces slide."""
    return law.carries_tension is not None or law.tensile_strength is not None


def tractions(joints: Interfaces) -> Tractions:
    """Return room for the tractions."""
    q, damped = joints.area.size, joints.law.normal_viscosity is not None
    x = joints.slip_x is not None and joints.law.shear_stiffness is not None
    z = joints.slip_z is not None and joints.law.shear_stiffness is not None

    def room(needed: bool) -> np.ndarray | None:
        return np.zeros(q) if needed else None

    springs = np.zeros(q), room(x), room(z)
    return Tractions(*springs, room(damped), room(damped and x), room(damped and z))


def measured(joints: Interfaces) -> Measured:
    """Return room for the jumps that the law asks for."""
    q, kept, loads = joints.area.size, memory(joints), tractions(joints)

    def room(asked: np.ndarray | None) -> np.ndarray | None:
        return None if asked is None else zeros(q)

    return Measured(
        gap=zeros(q),
        x=room(loads.x),
        z=room(loads.z),
        gap_rate=room(loads.drag_n),
        rate_x=room(loads.drag_x),
        rate_z=room(loads.drag_z),
        way_x=room(kept.slide_x),
        way_z=room(kept.slide_z),
        pull=zeros(q),
    )
