"""The joint law at all points of a body: forces, tangents, energies.

Vectors of points are [points * d], the d components of each in its frame, normal first. With the
jump operator B and the areas W of the points the force on the freedoms is B^T W t, where t is the
traction on the side to which the normal points, compression positive.
"""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from jointwave.joints.formula import formula
from jointwave.joints.law import History, LawFlags, law_of, traction_for
from jointwave.joints.normal import gap_under
from jointwave.joints.tangent import tangent_for
from jointwave.numerics.jit import jitted

#: Rows of the history of points [rows, points], the fields of `joints.law.History`.
OPENING, SLIDE, COHESION, PATH = 0, 1, 3, 4
ROWS = 5


class Points(NamedTuple):
    """The points of joints, for kernels.

    weight : area [points], m^(d-1). column : of the law's table [points]. table :
    `joints.law.table_of`. carried : tractions at u = 0, balanced by the rock [points * d], Pa; [0]
    without a prestress. counted : this process counts the energies of so many points.
    """

    weight: np.ndarray
    column: np.ndarray
    table: np.ndarray
    carried: np.ndarray
    counted: int


@formula
def components(dim, values, q):
    """Return the components (n, x, z) of a vector at a point; absent ones are 0."""
    n, x, z = values[dim * q], 0.0, 0.0
    if dim > 1:
        x = values[dim * q + 1]
    if dim > 2:
        z = values[dim * q + 2]
    return n, x, z


@formula
def set_components(dim, values, q, n, x, z):
    """Set the components of a vector at a point."""
    values[dim * q] = n
    if dim > 1:
        values[dim * q + 1] = x
    if dim > 2:
        values[dim * q + 2] = z


@formula
def history_at(before, q):
    """Return the `History` of a point."""
    return History(
        before[OPENING, q], before[SLIDE, q], before[SLIDE + 1, q], before[COHESION, q],
        before[PATH, q],
    )  # fmt: skip


def strained_for(parts: LawFlags, dim: int) -> Callable:
    """Return the formula of the jump that includes the strain of the springs at u = 0. Where joints
    can slide, their history includes that of the shear springs."""
    limited = parts.limited

    @formula
    def strained(law, jump, carried):
        n, x, z = jump
        n += gap_under(law, parts, carried[0])
        if dim > 1 and not limited:
            x -= carried[1] / law.shear_stiffness
            z -= carried[2] / law.shear_stiffness
        return n, x, z

    return strained


@cache
def tractions_for(parts: LawFlags, dim: int, stressed: bool) -> Callable:
    """Return the formula of the forces of joints with these parts of the law; stressed : whether
    they carry tractions at u = 0."""
    dashpots, limited, remembers = parts.dashpots, parts.limited, has_history(parts)
    strained, traction = strained_for(parts, dim), traction_for(parts.shear, parts.path)

    @formula
    def tractions(points, dt, jump, moved, rate, before, after, force, drag):
        """Set the forces W t (N) of all points less those at u = 0, dashpot forces separately, and
        the history; return the work of friction in this step, stored and fracture energy (J).

        jump : m. moved : its increments over the step, m, where joints slip. rate : of the jump,
        m/s, where they have dashpots. before, after : histories, which may be the same array.
        """
        slid, stored, spent = 0.0, 0.0, 0.0
        history, step, now = History(0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for q in range(points.weight.size):
            law, w = law_of(points.table, points.column[q]), points.weight[q]
            counted = w if q < points.counted else 0.0
            n, x, z = components(dim, jump, q)
            p_n, p_x, p_z = 0.0, 0.0, 0.0
            if stressed:
                p_n, p_x, p_z = components(dim, points.carried, q)
                stored += counted * (p_n * n + p_x * x + p_z * z)
                n, x, z = strained(law, (n, x, z), (p_n, p_x, p_z))
            if limited:
                step = components(dim, moved, q)
            if dashpots:
                now = components(dim, rate, q)
            if remembers:
                history = history_at(before, q)
            found = traction(law, parts, (n, x, z), step, now, dt, history)
            if remembers:
                after[OPENING, q] = found.history.opening
                after[SLIDE, q] = found.history.slide_x
                after[SLIDE + 1, q] = found.history.slide_z
                after[COHESION, q] = found.history.cohesion
                after[PATH, q] = found.history.path
            n, x, z = found.n - p_n, found.x - p_x, found.z - p_z
            if dashpots:
                n, x, z = n - found.drag_n, x - found.drag_x, z - found.drag_z
                set_components(dim, drag, q, w * found.drag_n, w * found.drag_x, w * found.drag_z)
            set_components(dim, force, q, w * n, w * x, w * z)
            slid += counted * found.slid
            stored += counted * found.stored
            spent += counted * found.spent
        return slid, stored, spent

    return tractions


def has_history(parts: LawFlags) -> bool:
    """Return whether points of a law with these parts have a history."""
    return parts.softening or parts.limited or parts.residual or parts.path


def history_at_rest(points: Points, parts: LawFlags, dim: int) -> np.ndarray:
    """Return the initial history of all points [rows, points]; [rows, 0] without a history."""
    count = points.weight.size if has_history(parts) else 0
    history = np.zeros((ROWS, count))
    law = law_of(points.table, points.column[:count])
    if parts.residual and parts.shear:
        history[COHESION] = law.cohesion
    if parts.limited and points.carried.size:
        slide = points.carried.reshape(-1, dim).T[1:] / law.shear_stiffness
        history[SLIDE : SLIDE + dim - 1] = slide
    return history


@cache
def forces_for(parts: LawFlags, dim: int, stressed: bool) -> Callable:
    """Return the kernel of the forces of joints in a trial of an implicit step."""
    tractions = tractions_for(parts, dim, stressed)

    def forces(points, dt, jump, moved, rate, before, after, force, drag):
        return tractions(points, dt, jump, moved, rate, before, after, force, drag)

    return jitted(forces, (parts, dim, stressed))


@cache
def tangents_for(parts: LawFlags, dim: int, stressed: bool) -> Callable:
    """Return the kernel of the tangents of joints of a law with these parts."""
    dashpots, remembers = parts.dashpots, has_history(parts)
    strained, tangent = strained_for(parts, dim), tangent_for(parts.shear, parts.path)

    def tangents(points, dt, r, jump, rate, before, stiffness):
        """Set the tangent stiffness of each point [points, d, d], N/m: minus the derivatives of its
        forces with respect to its jump. r : rate factor, 1/s (`joints.tangent`)."""
        history, now = History(0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for q in range(points.weight.size):
            law, w = law_of(points.table, points.column[q]), points.weight[q]
            n, x, z = components(dim, jump, q)
            if stressed:
                n, x, z = strained(law, (n, x, z), components(dim, points.carried, q))
            if dashpots:
                now = components(dim, rate, q)
            if remembers:
                history = history_at(before, q)
            found = tangent(law, parts, (n, x, z), now, dt, history, r)
            stiffness[q, 0, 0] = -w * found.nn
            if dim > 1:
                stiffness[q, 0, 1], stiffness[q, 1, 0] = -w * found.nx, -w * found.xn
                stiffness[q, 1, 1] = -w * found.xx
            if dim > 2:
                stiffness[q, 0, 2], stiffness[q, 2, 0] = -w * found.nz, -w * found.zn
                stiffness[q, 1, 2] = stiffness[q, 2, 1] = -w * found.xz
                stiffness[q, 2, 2] = -w * found.zz

    return jitted(tangents, (parts, dim, stressed))
