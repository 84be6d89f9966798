"""The problem that explicit and implicit steps solve: a body, its loads and boundaries."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, diags

from jointwave.cases.material.constant_q import Mechanisms
from jointwave.continuum.space.evaluation import blocks_of_nodes
from jointwave.continuum.space.model import Body
from jointwave.continuum.stepping.critical import critical_step
from jointwave.continuum.stepping.tractions import Points
from jointwave.joints.ends import HalfSpring
from jointwave.joints.law import Law, LawFlags, parts_of
from jointwave.joints.law import table_of as law_table


class Dashpots(NamedTuple):
    """Dashpots at nodes: node [k]; viscosity [k, d, d], N s/m; springs : function of the time step,
    springs in front of the dashpots [k, d]; None without."""

    node: np.ndarray
    viscosity: np.ndarray
    springs: Callable[[float], HalfSpring] | None = None

    @property
    def freedom(self) -> np.ndarray:
        """Freedoms of the nodes [k, d]."""
        dim = self.viscosity.shape[1]
        return dim * self.node[:, None] + np.arange(dim)


class Held(NamedTuple):
    """Freedoms with prescribed motion: freedom [k] moves by direction [k, m] times moved(steps)
    [n, m], m, of each motion from each step to the next; moved is None where none moves."""

    freedom: np.ndarray
    direction: np.ndarray
    moved: Callable[[np.ndarray], np.ndarray] | None = None


class Readings(NamedTuple):
    """Matrices of receivers.

    motion : [m d, freedoms]. stress : of displacements [rows, freedoms], Pa/m, compression
    positive. constant : stress at u = 0 [rows], Pa. traction : of point forces [joints d,
    points d], Pa/N. carried : traction at u = 0 [joints d], Pa. jump : [joints d, points d].
    viscous : stress of velocities by the rock's dashpots. inertia : stress of accelerations (with
    mass-proportional damping), None without.
    """

    motion: csr_matrix
    stress: csr_matrix
    constant: np.ndarray
    traction: csr_matrix
    carried: np.ndarray
    jump: csr_matrix
    viscous: csr_matrix
    inertia: csr_matrix | None = None


NO_DASHPOTS = Dashpots(np.zeros(0, np.int64), np.zeros((0, 1, 1)))
#: Matrices of receivers with columns for points, not freedoms.
OF_POINTS = ("traction", "jump")


class Problem(NamedTuple):
    """A body with its joint law, loads and boundaries; absent parts are None.

    law : of the joints, in columns. stiffest : the law at the largest stiffness and viscosity in
    reach. stress : in rock and joints at u = 0 [d, d], Pa, compression positive.
    alpha : of mass-proportional damping, 1/s. mechanisms : of the relaxation of rock, whose
    stiffness is then unrelaxed. steady : constant forces [freedoms], N. forces : with a history, as
    `loads.forces.Loads`. comm : mpi4py communicator of processes that share the run. counted :
    number of points, the first ones, whose energies this process counts; None for all.
    """

    body: Body
    readings: Readings
    law: Law | None = None
    stiffest: Law | None = None
    stress: np.ndarray | None = None
    alpha: float = 0.0
    mechanisms: Mechanisms | None = None
    steady: np.ndarray | None = None
    quiet: Dashpots = NO_DASHPOTS
    forces: Any = None
    held: Held = Held(np.zeros(0, np.int64), np.zeros((0, 0)))
    comm: Any = None
    counted: int | None = None

    @property
    def parts(self) -> LawFlags | None:
        """The parts of the joints' law; None without joints."""
        if self.law is None or not len(self.body.joints.weight):
            return None
        return parts_of(self.law)._replace(planar=self.body.components == 2)

    def of_joints(self, normal: Any, shear: Any) -> csr_matrix:
        """Return B^T W k B from normal and shear values k, numbers or one for each column."""
        joints, dim = self.body.joints, self.body.components
        if not len(joints.weight):
            return csr_matrix(self.body.stiffness.shape)
        values = np.zeros((len(joints.weight), dim))
        for c, value in enumerate([normal, *(dim - 1) * [0.0 if shear is None else shear]]):
            values[:, c] = joints.weight * (value[joints.column] if np.ndim(value) else value)
        jumps = joints.matrix(self.body.mass.size)
        return csr_matrix(jumps.T @ diags(values.ravel()) @ jumps)

    @property
    def stiffness(self) -> csr_matrix:
        """The stiffness of rock, joints (at the largest closure in reach) and side springs, N/m."""
        found = self.body.stiffness
        if (law := self.stiffest) is not None:
            joints = self.of_joints(law.normal_stiffness, law.shear_stiffness)
            found = csr_matrix(found + joints)
        if self.quiet.springs is not None:
            of_sides = np.zeros(found.shape[0])
            of_sides[self.quiet.freedom] = self.quiet.springs(0.0).critical_stiffness
            found = csr_matrix(found + diags(of_sides))
        return found

    @property
    def viscosity(self) -> csr_matrix:
        """The viscosity of rock and joints, N s/m; without entries if there are no dashpots."""
        law, found = self.stiffest, self.body.damping
        if law is not None and law.normal_viscosity is not None:
            joints = self.of_joints(law.normal_viscosity, law.shear_viscosity)
            found = csr_matrix(found + joints) if found.nnz else joints
        return found

    def critical_step(self) -> float:
        """Return the critical step of leapfrog, s.

        The search starts from a motion that contains all modes and does not depend on the numbering
        of nodes; it differs between the sides of a joint by the centres of their blocks.
        """
        body, block = self.body, blocks_of_nodes(self.body)
        x, count = body.x - body.x.min(axis=0), np.maximum(np.bincount(block), 1)
        middle = np.stack([np.bincount(block, one) / count for one in x.T], axis=1)
        phase = (x + middle[block]) @ np.sqrt([2.0, 3.0, 5.0])[: x.shape[1]] / x.max()
        waves = 1e3 * np.sqrt(np.arange(7, 7 + body.components))
        start = np.sin(np.outer(phase, waves)).ravel()
        return critical_step(body.mass, self.stiffness, self.viscosity, self.held.freedom, start)

    def points(self) -> Points:
        """Return the points of the joints for kernels."""
        joints = self.body.joints
        if self.law is None:
            none = np.zeros(0)
            return Points(none, none.astype(np.int64), np.zeros((0, 0)), none, 0)
        table, count = law_table(self.law), len(joints.weight)
        column = joints.column.astype(np.int64) * (table.shape[1] > 1)
        carried = np.zeros(0) if self.stress is None else joints.carried(self.stress)
        counted = count if self.counted is None else self.counted
        return Points(joints.weight, column, table, carried, counted)
