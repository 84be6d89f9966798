"""A process's share of a problem: complete matrix rows of its own freedoms, the halo (freedoms of
other processes in these rows), and all points of joints that act on its freedoms."""

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.continuum.space.evaluation import blocks_of_nodes
from jointwave.continuum.space.model import JumpOperator
from jointwave.continuum.stepping.problem import OF_POINTS, Dashpots, Problem, Readings
from jointwave.joints.ends import HalfSpring


class Share(NamedTuple):
    """A process's share of a problem.

    problem : with the owned freedoms first, then the halo. own, halo : these freedoms' numbers in
    the whole problem. points : their numbers in it; the first `problem.counted` are recorded here.
    """

    problem: Problem
    own: np.ndarray
    halo: np.ndarray
    points: np.ndarray


class SomeForces:
    """The part of a problem's forces on the freedoms of a process; number : of each freedom in the
    share [freedoms], -1 for other freedoms."""

    def __init__(self, forces: Any, number: np.ndarray) -> None:
        self.forces, there = forces, number[forces.freedom]
        self.kept = np.flatnonzero(there >= 0)
        self.freedom = there[self.kept]

    def at(self, first: int, last: int) -> np.ndarray:
        """Return the forces of steps first .. last - 1 [steps, k], N."""
        return self.forces.at(first, last)[:, self.kept]


def share_of(problem: Problem, rank_of: np.ndarray, rank: int) -> Share:
    """Return the share of a process; rank_of : process of each node [nodes]."""
    body, dim = problem.body, problem.body.components
    own, (points, counted) = np.flatnonzero(rank_of == rank), _points(problem, rank_of, rank)
    rows, joints = _freedoms(own, dim), JumpOperator(*(one[points] for one in body.joints))
    matrices = [csr_matrix(one)[rows] for one in (body.stiffness, body.damping)]
    every = [one.indices // dim for one in matrices]
    halo = np.setdiff1d(np.concatenate([*every, joints.node.ravel()]), own)
    number = np.full(len(rank_of), -1)
    number[np.append(own, halo)] = np.arange(len(own) + len(halo))
    freedom = np.where(number[:, None] < 0, -1, dim * number[:, None] + np.arange(dim)).ravel()

    def local(matrix: csr_matrix) -> csr_matrix:
        """Return a matrix with the columns of the share, rows in their original order."""
        entries = matrix.data, freedom[matrix.indices], matrix.indptr
        return csr_matrix(entries, (matrix.shape[0], dim * (len(own) + len(halo))))

    stiffness, damping = (local(one).sorted_indices() for one in matrices)
    small = body._replace(
        mesh=None,
        space=None,
        tied=None,
        x=body.x[own],
        block=np.unique(blocks_of_nodes(body)[own], return_inverse=True)[1],
        mass=body.mass[rows],
        stiffness=stiffness,
        damping=damping,
        joints=joints._replace(node=number[joints.node]),
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
    """Return the points on nodes of a process, first those without a node of a lower rank, and the
    number of these."""
    ranks = rank_of[problem.body.joints.node]
    acts, counts = (ranks == rank).any(axis=1), ranks.min(axis=1) == rank
    first = np.flatnonzero(acts & counts)
    return np.append(first, np.flatnonzero(acts & ~counts)), len(first)


def _acting(problem: Problem, number: np.ndarray, freedom: np.ndarray) -> Problem:
    """Return a problem with the loads and boundaries on nodes of a process; number, freedom : of
    nodes and freedoms in its share, -1 for others."""
    quiet, held, forces, steady = problem.quiet, problem.held, problem.forces, problem.steady
    there, springs, own = number[quiet.node] >= 0, quiet.springs, freedom[held.freedom] >= 0

    def some(dt: float) -> HalfSpring:
        assert springs is not None
        return HalfSpring(*(one[there] for one in springs(dt)))

    nodes = number[quiet.node[there]]
    return problem._replace(
        steady=None if steady is None else steady[freedom >= 0],
        quiet=Dashpots(nodes, quiet.viscosity[there], None if springs is None else some),
        held=held._replace(freedom=freedom[held.freedom[own]], direction=held.direction[own]),
        forces=None if forces is None else SomeForces(forces, freedom),
    )


def _readings(
    readings: Readings, own: np.ndarray, counted: np.ndarray, constants: bool
) -> Readings:
    """Return the part of receivers of some freedoms and some components of points; constants :
    whether to include the values at u = 0."""
    found: dict[str, Any] = {}
    for name, value in readings._asdict().items():
        if isinstance(value, csr_matrix):
            found[name] = value[:, counted if name in OF_POINTS else own]
        elif isinstance(value, np.ndarray) and not constants:
            found[name] = 0 * value
    return readings._replace(**found)
