"""The forces of a body in any state, and how they resist its motion, for Newton's method."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix, diags

from jointwave.continuum.space.petsc import PETSc, shared_by
from jointwave.continuum.stepping.memory import memory_of
from jointwave.continuum.stepping.problem import Problem
from jointwave.continuum.stepping.tractions import forces_for, history_at_rest, tangents_for
from jointwave.joints.law import IN_MOTION

MOST_ITERATIONS = 12
#: Unknowns from which MUMPS outweighs what it costs to call; PETSc's own factors are quicker below.
LARGE = 20_000
SHARED = ("mumps", "superlu_dist")  # that factorise a matrix of several processes
#: Of a displacement: what its last digits weigh cannot be balanced.
LAST_DIGITS = 8 * float(np.finfo(float).eps)


class Past(NamedTuple):
    """What forces depend on beside the motion. history : of points, `tractions`. elongation : of
    the rock's mechanisms [l, n], m. closure : of springs in front of dashpots of sides [k, d], m.
    """

    history: np.ndarray
    elongation: np.ndarray
    closure: np.ndarray


class Forces(NamedTuple):
    """The forces of a state [freedoms], N.

    whole : all together. viscous : of dashpots of rock and joints, mass-proportional damping, and
    of rock with a quality factor. boundary : of quiet sides. external : with a history. past :
    after the step. loads, drags : of points' springs and dashpots [points * d], N. jump : m.
    energies : of joints' springs, spent by opening, and by friction in the step, J [3]. size : the
    largest that is summed up [1].
    """

    whole: np.ndarray
    viscous: np.ndarray
    boundary: np.ndarray
    external: np.ndarray
    past: Past
    loads: np.ndarray
    drags: np.ndarray
    jump: np.ndarray
    energies: np.ndarray
    size: np.ndarray


class Balance:
    """The forces of a problem.

    Attributes
    ----------
    stiffness, damping, quiet, mass : [freedoms, freedoms], of rock with mass-proportional damping,
    and of quiet sides. free : int array, freedoms that are not held. past : at first. springs : in
    front of dashpots, None without, of steps; ends : int array [k, d], the freedoms of quiet sides.
    """

    def __init__(self, problem: Problem, at_rest: bool = False) -> None:
        body, self.problem, self.parts = problem.body, problem, problem.parts
        n, self.dim = body.stiffness.shape[0], body.components
        self.free = np.setdiff1d(np.arange(n), problem.fixed)
        self.stiffness, self.points = body.stiffness, problem.points()
        self.mechanisms = problem.mechanisms
        self.mass = csr_matrix(diags(body.mass))
        self.damping, self.quiet = csr_matrix((n, n)), csr_matrix((n, n))
        quiet = None if at_rest else problem.quiet
        self.springs = cache(quiet.springs) if quiet is not None and quiet.springs else None
        self.ends = np.zeros((0, self.dim), np.int64) if quiet is None else quiet.freedom
        closure = np.zeros(self.ends.shape if self.springs else (0, self.dim))
        if at_rest:
            if self.mechanisms is not None:
                self.stiffness = csr_matrix(self.mechanisms.relaxed * self.stiffness)
                self.mechanisms = None
            table = self.points.table.copy()
            table[IN_MOTION[: len(table)]] = 0.0
            self.points = self.points._replace(table=table)
        else:
            self.damping = csr_matrix(problem.alpha * self.mass)
            if body.damping is not None:
                self.damping = csr_matrix(self.damping + body.damping)
            self.quiet = self._quiet(n)
        self.jumps = csr_matrix((0, n)) if body.joints is None else body.joints.matrix
        many = 0 if self.mechanisms is None else len(self.mechanisms.share)
        history = np.zeros((0, 0))
        if self.parts is not None:
            history = history_at_rest(self.points, self.parts, self.dim)
        self.past = Past(history, np.zeros((many, n)), closure)
        self.steady = np.zeros(n) if problem.steady is None else problem.steady

    def _quiet(self, n: int) -> csr_matrix:
        quiet, dim = self.problem.quiet, self.dim
        if quiet is None:
            return csr_matrix((n, n))
        own = quiet.freedom
        row, column = np.repeat(own, dim, axis=1), np.tile(own, dim)
        return csr_matrix((quiet.viscosity.ravel(), (row.ravel(), column.ravel())), (n, n))

    def of_springs(self, dt: float) -> csr_matrix:
        """Return how springs in front of dashpots resist what moves in a step of dt (s)
        [freedoms, freedoms], N/m."""
        found = np.zeros(self.stiffness.shape[0])
        if self.springs is not None:
            own = self.springs(dt)
            found[self.ends] = own.stiffness * own.gain / dt
        return csr_matrix(diags(found))

    def acceleration(self, force: np.ndarray, held: np.ndarray) -> np.ndarray:
        """Return the acceleration of freedoms by forces on them (N); held : that of held ones."""
        found = held.copy()
        found[self.free] = force[self.free] / self.problem.body.mass[self.free]
        return found

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
        """Return the forces at displacements u (m) and velocities v (m/s), after moving by `moved`
        in dt (s) from a state with that past; steady : share of the steady forces."""
        elongation = self._elongation(moved, dt, before.elongation)
        elastic, drag = self.stiffness @ self.strained(u, elongation), self.damping @ v
        boundary, jump = self.quiet @ v, self.jumps @ u
        closure = before.closure
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
        if self.mechanisms is not None:
            drag = drag + elastic
        past, joints = Past(after, elongation, closure), (loads, drags, jump)
        return Forces(whole, drag, boundary, external, past, *joints, energies, size)

    def _elongation(self, moved: np.ndarray, dt: float, before: np.ndarray) -> np.ndarray:
        """Return the elongations of mechanisms after moving in dt (s)."""
        if self.mechanisms is None:
            return before
        memory = memory_of(self.mechanisms, dt)
        return memory.decay[:, None] * before + memory.gain[:, None] / dt * moved

    def strained(self, u: np.ndarray, elongation: np.ndarray) -> np.ndarray:
        """Return the displacement by which elastic rock would have the same stress, m."""
        if self.mechanisms is None:
            return u
        return self.mechanisms.relaxed * u + self.mechanisms.share @ elongation

    def stored(self, u: np.ndarray, past: Past, dt: float) -> float:
        """Return the energy of the rock's springs in steps dt (s), J."""
        return memory_of(self.mechanisms, dt).energy(self.stiffness, u, past.elongation)

    def of_joints(
        self, u: np.ndarray, v: np.ndarray, dt: float, r: float, before: np.ndarray
    ) -> np.ndarray:
        """Return how each point resists its jump [points, d, d], N/m; r : rate factor, 1/s."""
        count = len(self.points.weight)
        found = np.zeros((count, self.dim, self.dim))
        if self.parts is not None:
            kernel = tangents_for(self.parts, self.dim, self.points.carried.size > 0)
            kernel(self.points, dt, r, self.jumps @ u, self.jumps @ v, before, found)
        return found

    def sticking(self) -> np.ndarray:
        """Return the same of joints that neither open nor slip."""
        law, joints, dim = self.problem.law, self.problem.body.joints, self.dim
        found = np.zeros((len(self.points.weight), dim, dim))
        if law is not None and joints is not None:
            for a in range(dim):
                k = law.normal_stiffness if a == 0 else law.shear_stiffness
                found[:, a, a] = joints.weight * (k[joints.column] if np.ndim(k) else k)
        return found

    def with_joints(self, matrix: csr_matrix, tangents: np.ndarray, share: float = 1.0) -> Factors:
        """Return the factors of a matrix of the freedoms that move, with a share of the joints'
        tangents."""
        if len(tangents):
            count = len(tangents)
            middle = bsr_matrix((tangents, np.arange(count), np.arange(count + 1)))
            matrix = matrix + share * (self.jumps.T @ middle @ self.jumps)
        return Factors(csr_matrix(matrix)[self.free][:, self.free], self.problem.comm)


class Factors:
    """The LU factors of a matrix [n, n], by PETSc; comm : mpi4py's, of processes that share them,
    each of which has the whole matrix and gets the whole solution, the same on all."""

    def __init__(self, matrix: csr_matrix, comm: Any = None) -> None:
        if comm is not None and hasattr(PETSc, "garbage_cleanup"):
            PETSc.garbage_cleanup(comm)  # earlier factors: what is shared goes when all agree
        matrix, n, self._comm = csr_matrix(matrix), matrix.shape[0], comm
        rank, size = (0, 1) if comm is None else (comm.rank, comm.size)
        self._rows = slice(n * rank // size, n * (rank + 1) // size)
        own, on = matrix[self._rows], PETSc.COMM_SELF if comm is None else shared_by(comm)
        pattern = own.indptr.astype(PETSc.IntType), own.indices.astype(PETSc.IntType)
        sizes = own.shape[0], n
        given = PETSc.Mat().createAIJ((sizes, sizes), csr=(*pattern, own.data), comm=on)
        self._solver = PETSc.KSP().create(on)
        self._solver.setType("preonly")
        conditioner = self._solver.getPC()
        conditioner.setType("lu")
        conditioner.setFactorSolverType(_package(n, size))
        self._solver.setOperators(given)
        self._x, self._b = given.createVecs()

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Return x of A x = right, [n]."""
        self._b.array[:] = right[self._rows]
        self._solver.solve(self._b, self._x)
        found = np.real(self._x.array).copy()
        return found if self._comm is None else np.concatenate(self._comm.allgather(found))


def _package(unknowns: int, processes: int) -> str:
    """Return what factorises a matrix of so many unknowns; of several processes only some do."""
    there = [one for one in SHARED if PETSc.Sys.hasExternalPackage(one)]
    if processes > 1:
        if not there:
            raise ImportError(f"implicit steps on several processes need PETSc with {SHARED[0]}")
        return there[0]
    return "mumps" if unknowns > LARGE and "mumps" in there else "petsc"


class Outcome(NamedTuple):
    """x : the last iterate. converged : whether it is a solution. errors : largest residual of
    every iterate, the start first; tolerance : that of the last one."""

    x: np.ndarray
    converged: bool
    errors: list[float]
    tolerance: float


def newton(
    residual: Callable[[np.ndarray], tuple[np.ndarray, float]],
    correction: Callable[[np.ndarray], np.ndarray],
    start: np.ndarray,
) -> Outcome:
    """Return the solution by Newton's method from a start, after at least one correction where
    anything is out of balance.

    residual : function of x that returns what is left, and what of it may be. correction : function
    of that which returns by what to move the last x.
    """
    x, errors, tolerance = start.copy(), [], 0.0
    for _ in range(MOST_ITERATIONS + 1):
        rest, tolerance = residual(x)
        errors.append(float(np.abs(rest).max(initial=0.0)))
        if not np.isfinite(errors[-1]):
            break
        if errors[-1] == 0 or (len(errors) > 1 and errors[-1] <= tolerance):
            return Outcome(x, True, errors, tolerance)
        if len(errors) > MOST_ITERATIONS:
            break
        x += correction(rest)
    return Outcome(x, False, errors, tolerance)
