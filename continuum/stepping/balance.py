"""The forces of a body in any state, and their tangent matrices, for Newton's method."""

from functools import cache, partial
from typing import NamedTuple

import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix, diags

from jointwave.continuum.space.model import at_nodes
from jointwave.continuum.stepping.memory import memory_of
from jointwave.continuum.stepping.newton import Factors
from jointwave.continuum.stepping.problem import Problem
from jointwave.continuum.stepping.tractions import forces_for, history_at_rest, tangents_for

#: Round-off of a displacement, relative: forces of this size cannot be balanced.
LAST_DIGITS = 8 * float(np.finfo(float).eps)


class Past(NamedTuple):
    """The history variables of forces: history of points, see `tractions`; elongation of the rock's
    mechanisms [l, n], m; closure of springs in front of boundary dashpots [k, d], m."""

    history: np.ndarray
    elongation: np.ndarray
    closure: np.ndarray


class Forces(NamedTuple):
    """The forces of a state [freedoms], N.

    whole : their sum. viscous : of dashpots of rock and joints, mass-proportional damping, and of
    rock with a quality factor. boundary : of quiet sides. external : with a history. past : after
    the step. loads : of points [points * d], N. jump : m. energies : stored in joints, spent by
    fracture, and by friction in the step [3], J. size : the largest term of the sum [1].
    """

    whole: np.ndarray
    viscous: np.ndarray
    boundary: np.ndarray
    external: np.ndarray
    past: Past
    loads: np.ndarray
    jump: np.ndarray
    energies: np.ndarray
    size: np.ndarray


class Balance:
    """The forces of a problem.

    damping, quiet : of rock with mass-proportional damping, and of quiet sides [freedoms,
    freedoms], N s/m. free : freedoms that are not held. carried : largest force of a point at
    u = 0, N. past : at the start. memory : function of dt. springs : function of dt, in front of
    dashpots; None without. ends : freedoms of quiet sides [k, d].
    """

    def __init__(self, problem: Problem) -> None:
        body, quiet = problem.body, problem.quiet
        self.problem, self.parts = problem, problem.parts
        n, self.dim = body.stiffness.shape[0], body.components
        self.free = np.setdiff1d(np.arange(n), problem.held.freedom)
        self.stiffness, self.mass, self.points = body.stiffness, body.mass, problem.points()
        self.damping = csr_matrix(problem.alpha * diags(body.mass) + body.damping)
        self.quiet = at_nodes(quiet.node, quiet.viscosity, n)
        self.springs = cache(quiet.springs) if quiet.springs else None
        weight, carried = self.points.weight, np.abs(self.points.carried)
        each = np.repeat(weight, self.dim)[: carried.size]  # empty without a prestress
        self.carried = float((each * carried).max(initial=0.0))
        self.ends, self.memory = quiet.freedom, cache(partial(memory_of, problem.mechanisms))
        self.jumps = body.joints.matrix(n)
        history = np.zeros((0, 0))
        if self.parts is not None:
            history = history_at_rest(self.points, self.parts, self.dim)
        closure = np.zeros(self.ends.shape if self.springs else (0, self.dim))
        self.past = Past(history, np.zeros((len(self.memory(1.0).share), n)), closure)
        self.steady = np.zeros(n) if problem.steady is None else problem.steady

    def forces(
        self,
        u: np.ndarray,
        v: np.ndarray,
        moved: np.ndarray,
        dt: float,
        before: Past,
        external: np.ndarray,
        steady: float = 1.0,
    ) -> Forces:
        """Return the forces at displacements u (m) and velocities v (m/s), after a displacement
        `moved` in dt (s) from a state of this past; steady : factor on the constant forces."""
        memory, closure, jump = self.memory(dt), before.closure, self.jumps @ u
        elongation = memory.decay[:, None] * before.elongation + memory.gain[:, None] / dt * moved
        elastic, drag = self.stiffness @ memory.strained(u, elongation), self.damping @ v
        boundary = self.quiet @ v
        if self.springs is not None:
            own = self.springs(dt)
            closure = own.decay * closure + own.gain * moved[self.ends] / dt
            boundary[self.ends] += own.stiffness * closure
        loads, drags = np.zeros((2, len(jump)))
        after, found, drive = before.history.copy(), (0.0, 0.0, 0.0), 0.0
        if self.parts is not None:
            kernel = forces_for(self.parts, self.dim, self.points.carried.size > 0)
            rate, slips = self.jumps @ v, self.jumps @ moved
            given = jump, slips, rate, before.history, after, loads, drags
            found = kernel(self.points, dt, *given)
            drag = drag - self.jumps.T @ drags
            drive = self.jumps.T @ loads
        whole = steady * self.steady + external - elastic - drag - boundary + drive
        sizes = [np.abs(one).max(initial=0.0) for one in (elastic, drag, self.steady, external)]
        slid, stored, spent = found
        energies, size = np.array([stored, spent, slid]), np.array([max(sizes)])
        if memory.share.size:
            drag = drag + elastic
        past, joints = Past(after, elongation, closure), (loads + drags, jump)
        return Forces(whole, drag, boundary, external, past, *joints, energies, size)

    def resistance(self, dt: float, rate: float) -> csr_matrix:
        """Return the tangent stiffness of rock and sides in a step of dt (s) [freedoms, freedoms],
        N/m; rate : rate factor, 1/s."""
        found = self.memory(dt).tangent(dt) * self.stiffness + rate * (self.damping + self.quiet)
        if self.springs is not None:
            own, of_ends = self.springs(dt), np.zeros(found.shape[0])
            of_ends[self.ends] = own.stiffness * own.gain / dt
            found = found + diags(of_ends)
        return csr_matrix(found)

    def of_joints(
        self, u: np.ndarray, v: np.ndarray, dt: float, r: float, before: np.ndarray
    ) -> np.ndarray:
        """Return the tangent stiffness of each point [points, d, d], N/m; r : rate factor, 1/s."""
        found = np.zeros((len(self.points.weight), self.dim, self.dim))
        if self.parts is not None:
            kernel = tangents_for(self.parts, self.dim, self.points.carried.size > 0)
            kernel(self.points, dt, r, self.jumps @ u, self.jumps @ v, before, found)
        return found

    def factors(self, matrix: csr_matrix, tangents: np.ndarray | None = None) -> Factors:
        """Return the factors of a matrix plus the joints' tangents, on the free freedoms."""
        if tangents is not None and len(tangents):
            point = np.arange(len(tangents) + 1)
            middle = bsr_matrix((tangents, point[:-1], point))
            matrix = matrix + self.jumps.T @ middle @ self.jumps
        return Factors(csr_matrix(matrix)[self.free][:, self.free], self.problem.comm)
