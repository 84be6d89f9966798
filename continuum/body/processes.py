"""Explicit steps of a body that several processes share.

Each process has the whole body while a run is set up, and keeps its share: complete rows of the
matrices for the freedoms that it steps, and all points of joints that act on these. Freedoms of
others that these rows and points need, the halo, follow by one exchange of velocities a step, by
PETSc's star forest. Nothing is summed over processes but what is recorded, once a chunk of steps.
A point that several processes need is found by each from the same numbers in the same order.
"""

from __future__ import annotations

from typing import Any, NamedTuple
from zlib import crc32

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.errors import SceneError
from jointwave.continuum.body.evaluation import blocks_of_nodes
from jointwave.continuum.body.explicit import leapfrog_for
from jointwave.continuum.body.fenicsx import MPI
from jointwave.continuum.body.model import JumpOperator
from jointwave.continuum.body.partition import ranks_of_nodes
from jointwave.continuum.body.steps import Dashpots, Forces, Leapfrog, Problem, Readings, Springs
from jointwave.continuum.parallel.petsc import PETSc

OF_POINTS = ("traction", "jump")  # what receivers read of points


class Share(NamedTuple):
    """A process's share of a problem.

    problem : with the freedoms of the process first and then the halo. own, halo : int arrays,
    these freedoms of the whole problem. points : int array, those of the whole; the first ones are
    counted here.
    """

    problem: Problem
    own: np.ndarray
    halo: np.ndarray
    points: np.ndarray


class SomeForces:
    """Those of some forces that act on freedoms of a process, `steps.Forces`; number : int array
    [freedoms], of these in its share, -1 of others."""

    def __init__(self, forces: Forces, number: np.ndarray) -> None:
        self.forces, there = forces, number[forces.freedom]
        self.kept = np.flatnonzero(there >= 0)
        self.freedom = there[self.kept]

    def at(self, first: int, last: int) -> np.ndarray:
        """Return the forces of steps first .. last - 1 [steps, k], N."""
        return self.forces.at(first, last)[:, self.kept]

    def impulse(self, mass: np.ndarray, steps: int, stride: int) -> float:
        """Return that of all forces; mass : of all freedoms, kg."""
        return self.forces.impulse(mass, steps, stride)


def share_of(problem: Problem, rank_of: np.ndarray, rank: int) -> Share:
    """Return the share of a process; rank_of : int array [nodes], of each node."""
    body, dim = problem.body, problem.body.components
    own, (points, counted) = np.flatnonzero(rank_of == rank), _points(problem, rank_of, rank)
    rows = _freedoms(own, dim)
    stiffness, damping = (
        None if one is None else csr_matrix(one)[rows] for one in (body.stiffness, body.damping)
    )
    joints = None if body.joints is None else _some(body.joints, points, dim)
    matrices = [one for one in (stiffness, damping, joints and joints.matrix) if one is not None]
    reached = np.unique(np.concatenate([one.indices // dim for one in matrices]))
    halo = np.setdiff1d(reached, own)
    number = np.full(len(rank_of), -1)
    number[np.append(own, halo)] = np.arange(len(own) + len(halo))
    freedom = np.where(number[:, None] < 0, -1, dim * number[:, None] + np.arange(dim)).ravel()

    def local(matrix: csr_matrix) -> csr_matrix:
        """Return a matrix with the columns of the share, each row in the order that it had."""
        entries = matrix.data, freedom[matrix.indices], matrix.indptr
        return csr_matrix(entries, (matrix.shape[0], dim * (len(own) + len(halo))))

    stiffness, damping = (
        None if one is None else local(one).sorted_indices() for one in (stiffness, damping)
    )
    assert stiffness is not None and body.mass is not None
    small = body._replace(
        mesh=None,
        space=None,
        tied=None,
        x=body.x[own],
        block=np.unique(blocks_of_nodes(body)[own], return_inverse=True)[1],
        mass=body.mass[rows],
        stiffness=stiffness,
        damping=damping,
        joints=joints and joints._replace(matrix=local(joints.matrix)),
        sides={},
    )
    number[halo] = freedom[_freedoms(halo, dim)] = -1
    acting = _acting(problem, number, freedom)
    read = _readings(problem.readings, rows, _freedoms(points[:counted], dim), rank == 0)
    small_problem = acting._replace(body=small, readings=read, comm=None, counted=counted)
    return Share(small_problem, rows, _freedoms(halo, dim), points)


def _freedoms(nodes: np.ndarray, dim: int) -> np.ndarray:
    return (dim * nodes[:, None] + np.arange(dim)).ravel()


def _points(problem: Problem, rank_of: np.ndarray, rank: int) -> tuple[np.ndarray, int]:
    """Return the points that act on nodes of a process, first those that have no node of a lower
    one, and how many these are."""
    joints, dim = problem.body.joints, problem.body.components
    if joints is None:
        return np.zeros(0, np.int64), 0
    entries = joints.matrix.tocoo()
    point, of = entries.row // dim, rank_of[entries.col // dim]
    lowest = np.full(len(joints.weight), rank_of.max() + 1)
    np.minimum.at(lowest, point, of)
    acts = np.unique(point[of == rank])
    first = acts[lowest[acts] == rank]
    return np.append(first, acts[lowest[acts] < rank]), len(first)


def _some(joints: JumpOperator, points: np.ndarray, dim: int) -> JumpOperator:
    """Return the operator of some points."""
    return JumpOperator(joints.matrix[_freedoms(points, dim)], *(one[points] for one in joints[1:]))  # type: ignore[call-arg]


def _acting(problem: Problem, number: np.ndarray, freedom: np.ndarray) -> Problem:
    """Return a problem with what acts on nodes of a process; number, freedom : those of nodes and
    freedoms in its share, -1 of others."""
    quiet, held, forces, steady = problem.quiet, problem.held, problem.forces, problem.steady
    if quiet is not None:
        quiet = _dashpots(quiet, number)
    if held is not None:
        there = freedom[held.freedom] >= 0
        held = held._replace(freedom=freedom[held.freedom[there]], direction=held.direction[there])
    return problem._replace(
        steady=None if steady is None else steady[freedom >= 0],
        quiet=quiet,
        held=held,
        forces=None if forces is None else SomeForces(forces, freedom),
    )


def _dashpots(quiet: Dashpots, number: np.ndarray) -> Dashpots:
    """Return the dashpots of nodes of a process."""
    there, springs = number[quiet.node] >= 0, quiet.springs

    def some(dt: float) -> Springs:
        assert springs is not None
        return Springs(*(one[there] for one in springs(dt)))

    nodes = number[quiet.node[there]]
    return Dashpots(nodes, quiet.viscosity[there], None if springs is None else some)


def _readings(
    readings: Readings, own: np.ndarray, counted: np.ndarray, constants: bool
) -> Readings:
    """Return what receivers read of some freedoms and of the components of some points; constants :
    whether what is read at u = 0 counts."""
    found: dict[str, Any] = {}
    for name, value in readings._asdict().items():
        if isinstance(value, csr_matrix):
            found[name] = value[:, counted if name in OF_POINTS else own]
        elif isinstance(value, np.ndarray) and not constants:
            found[name] = 0 * value
    return readings._replace(**found)


class SharedLeapfrog(Leapfrog):
    """Explicit steps of a problem that the processes of its communicator share; all call its
    methods and read its properties alike, and get the whole of it.

    Attributes
    ----------
    problem : the whole one. samples : of the whole, after each call of `take`. state : of a share.
    """

    def __init__(self, problem: Problem, dt: float, samples: int, energy: bool = True) -> None:
        comm, dim = problem.comm, problem.body.components
        rank_of = ranks_of_nodes(problem.body, comm)
        self._share = share_of(problem, rank_of, comm.rank)
        super().__init__(self._share.problem, dt, samples, energy)
        self.problem, of_freedom = problem, np.repeat(rank_of, dim)
        self._order = np.argsort(of_freedom, kind="stable")
        self._known = crc32(rank_of.astype(np.int64).tobytes())
        self._partition = np.array([self._known])  # in checkpoints
        place = self.whole(np.arange(self.product.size)).astype(np.int64)
        remote = np.stack([of_freedom, place], axis=1)[self._share.halo].astype(PETSc.IntType)
        leaves = np.arange(self.product.size, self.product.size + self.halo)
        self._forest = PETSc.SF().create(comm)
        self._forest.setGraph(self.product.size, leaves.astype(PETSc.IntType), remote)

    @property
    def parts(self) -> tuple:
        """All arrays that change, and a number of the partition."""
        return *super().parts, self._partition

    def whole(self, vector: np.ndarray) -> np.ndarray:
        """Return the values of all freedoms in the vectors of all processes."""
        found = np.empty(self._order.size)
        found[self._order] = np.concatenate(self.problem.comm.allgather(super().whole(vector)))
        return found

    def place(self, values: np.ndarray, vector: np.ndarray) -> None:
        """Put values of all freedoms into a vector of the share."""
        super().place(values[self._share.own], vector)

    def start(self, u: np.ndarray, history: np.ndarray | None = None) -> None:
        """Begin at rest at displacements u (m), with a history of all points."""
        if history is not None and history.size:
            history = history[:, self._share.points]
        super().start(u, history)
        if self.problem.comm.rank:  # the first one has entered all of the energy
            self.state.sums[:] = 0.0

    def take(self, first: int, last: int, stride: int) -> None:
        """Take the steps first .. last - 1, with a sample at each that `stride` divides."""
        if self._partition[0] != self._known:
            allowed = "has divided the rock otherwise before: run without --resume"
            raise SceneError("mpiexec", "-n", self.problem.comm.size, allowed)
        kernel, state = leapfrog_for(self.flags), self.state
        given = self.constants, state, self.work, self.samples
        for vector in (state.u, state.v, state.v_before, *state.elongation):
            self._follow(vector)
        for begin, drive, moved in self._driven(self._share.problem, first, last):
            kernel(*given, drive[:0], moved[:0], (begin, begin, stride))  # compiles
            for k in range(len(moved)):
                span = begin + k, begin + k + 1, stride
                kernel(*given, drive[k : k + 1], moved[k : k + 1], span)
                self._exchange()
        self._add_up(-(-first // stride), -(-last // stride))

    def _exchange(self) -> None:
        """Advance the halo by a step, as the processes have done that step it."""
        state, halo = self.state, slice(self.product.size, None)
        state.v_before[halo] = state.v[halo]
        self._follow(state.v)
        state.u[halo] += self.dt * state.v[halo]
        if self.flags.relaxing:
            memory, past = self.constants.memory, state.elongation[:, halo]
            past[:] = memory.decay[:, None] * past + memory.gain[:, None] * state.v[halo]

    def _add_up(self, first: int, last: int) -> None:
        """Sum what the processes have read in samples first .. last - 1."""
        for rows in self.samples:
            if rows.size and last > first:
                some = rows[:, first:last]
                some[:] = sum(self.problem.comm.allgather(some))

    def _follow(self, vector: np.ndarray) -> None:
        """Take the halo of a vector from the processes that step it."""
        self._forest.bcastBegin(MPI.DOUBLE, vector, vector, MPI.REPLACE)
        self._forest.bcastEnd(MPI.DOUBLE, vector, vector, MPI.REPLACE)
