"""Explicit steps of a body by several processes.

Each process sets up the whole body and keeps its share: complete rows of the matrices for the
freedoms that it steps, and all points of joints that act on them. The halo, freedoms of other
processes in these rows and points, is updated by one exchange of velocities a step, by PETSc's star
forest. Only recorded values are summed over processes, once a chunk of steps. Processes that need
the same point all compute it from the same numbers in the same order.
"""

from zlib import crc32

import numpy as np

from jointwave.cases.errors import SceneError
from jointwave.continuum.processes.partition import ranks_of_nodes
from jointwave.continuum.processes.share import share_of
from jointwave.continuum.space.fenicsx import MPI, PETSc, shared_by
from jointwave.continuum.stepping.explicit import leapfrog_for
from jointwave.continuum.stepping.leapfrog import Leapfrog
from jointwave.continuum.stepping.problem import Problem


class SharedLeapfrog(Leapfrog):
    """Explicit steps of a problem by the processes of its communicator. Methods and properties are
    collective and return whole vectors.

    problem : the whole problem. samples : of the whole, after each `take`. state : of the share.
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
        self._forest = PETSc.SF().create(shared_by(comm))
        self._forest.setGraph(self.product.size, self.halo.astype(PETSc.IntType), remote)

    @property
    def parts(self) -> tuple:
        """All arrays that change, and a checksum of the partition."""
        return *super().parts, self._partition

    def whole(self, vector: np.ndarray) -> np.ndarray:
        """Return the values of all freedoms from the vectors of all processes."""
        found = np.empty(self._order.size)
        found[self._order] = np.concatenate(self.problem.comm.allgather(super().whole(vector)))
        return found

    def place(self, values: np.ndarray, vector: np.ndarray) -> None:
        """Set a vector of the share from the values of all freedoms."""
        super().place(values[self._share.own], vector)

    def start(self, u: np.ndarray, history: np.ndarray | None = None) -> None:
        """Start at rest at displacements u (m), with the history of all points."""
        if history is not None and history.size:
            history = history[:, self._share.points]
        super().start(u, history)
        if self.problem.comm.rank:  # the first process has the whole initial energy
            self.state.sums[:] = 0.0

    def take(self, first: int, last: int, stride: int) -> None:
        """Take the steps first .. last - 1, with a sample at each multiple of `stride`."""
        if self._partition[0] != self._known:
            allowed = "has divided the rock otherwise before: run without --resume"
            raise SceneError("mpiexec", "-n", self.problem.comm.size, allowed)
        kernel, state = leapfrog_for(self.flags), self.state
        given = self.constants, state, self.work, self.samples
        for vector in (state.u, state.v, state.v_before, *state.elongation):
            self._update_halo(vector)
        for begin, drive, moved in self._driven(self._share.problem, first, last):
            kernel(*given, drive[:0], moved[:0], (begin, begin, stride))  # compiles
            for k in range(len(moved)):
                span = begin + k, begin + k + 1, stride
                kernel(*given, drive[k : k + 1], moved[k : k + 1], span)
                self._exchange()
        for rows in self.samples:  # each process has a part of their sum
            if (some := rows[:, -(-first // stride) : -(-last // stride)]).size:
                some[:] = sum(self.problem.comm.allgather(some))

    def _exchange(self) -> None:
        """Advance the halo by a step, with velocities of the processes that own it."""
        state, halo = self.state, slice(self.product.size, None)
        state.v_before[halo] = state.v[halo]
        self._update_halo(state.v)
        state.u[halo] += self.dt * state.v[halo]
        if self.flags.relaxing:
            memory, past = self.constants.memory, state.elongation[:, halo]
            past[:] = memory.decay[:, None] * past + memory.gain[:, None] * state.v[halo]

    def _update_halo(self, vector: np.ndarray) -> None:
        """Update the halo of a vector from the processes that own it."""
        self._forest.bcastBegin(MPI.DOUBLE, vector, vector, MPI.REPLACE)
        self._forest.bcastEnd(MPI.DOUBLE, vector, vector, MPI.REPLACE)
