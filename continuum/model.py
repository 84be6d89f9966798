"""The constants of a run in one, two or three dimensions; `continuum.state` has the state.

Absent parts are None. A freedom is one component of the displacement of one node;
where it stands in a vector, `continuum.space.operator.layout` says.

Where several processes share a run, each holds part of the rock and of the joints. Every force,
mass, viscosity and weight is then its own share, and `total` and `beta` are of all together.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.material.constant_q import Mechanisms
from jointwave.continuum.space.operator import Operator
from jointwave.continuum.space.stencils import Stencils
from jointwave.joints.law import Law, LawFlags


class Memory(NamedTuple):
    """Relaxation mechanisms of displacements u (`cases.material.constant_q`).

    Of each the spring that is in series with a dashpot has the elongation e_l, e_l' = v - omega_l
    e_l, as a vector of freedoms. Over a step of constant velocity that is exactly decay e_l + gain
    v, and the rock's force is K (relaxed u + sum_l share e_l), with K of the unrelaxed moduli.

    relaxed : 1 less the sum of the shares. share, frequency (rad/s), decay, gain (s) : [l].
    stored : what the energies of the springs count, [l], so that what dashpots take in a step,
        omega_l dt share of the mean elongation's K, is never negative: 1 but for (omega_l dt)^2.
    """

    relaxed: float
    share: np.ndarray
    frequency: np.ndarray
    decay: np.ndarray
    gain: np.ndarray
    stored: np.ndarray

    def at_rest(self) -> Memory:
        """Return it for slow motion, under which nothing but the relaxed spring resists."""
        none = np.zeros_like(self.decay)
        return self._replace(decay=none, gain=none)

    def tangent(self, dt: float) -> float:
        """Return the part of K that resists a displacement during a step (s)."""
        return self.relaxed + float(self.share @ self.gain) / dt

    def energy(self, stiffness, u: np.ndarray, elongation: np.ndarray) -> float:
        """Return the energy of all springs, J; stiffness : K [n, n], N/m."""
        springs = self.share * self.stored
        found = sum(k * (e @ (stiffness @ e)) for k, e in zip(springs, elongation, strict=True))
        return float(self.relaxed * (u @ (stiffness @ u)) + found) / 2


def memory_of(mechanisms: Mechanisms, dt: float) -> Memory:
    """Return what mechanisms remember in steps dt (s)."""
    omega = mechanisms.frequency
    x = omega * dt
    gain = -np.expm1(-x) / omega
    stored = x / 2 / np.tanh(x / 2)
    return Memory(mechanisms.relaxed, mechanisms.share, omega, np.exp(-x), gain, stored)


class RockOperators(NamedTuple):
    """The deformable rock.

    stiffness : N/m; viscosity : N s/m, None without dashpots.
    mass : float array [n], kg; step_over_mass : dt over the total mass, s/kg.
    decay : (1 - alpha dt / 2) / (1 + alpha dt / 2) of mass-proportional damping alpha, None
        without; step_over_mass is then divided by 1 + alpha dt / 2.
    memory : `Memory` of rock with a quality factor, None without; stiffness is then the unrelaxed.
    """

    stiffness: Operator
    viscosity: Any
    mass: np.ndarray
    step_over_mass: np.ndarray
    decay: Any
    memory: Any = None


class Interfaces(NamedTuple):
    """The joints, at their q quadrature points.

    jump : B [directions * q, n], displacements to the gap of all points, then to their slip along
        x, then z; stencils : the same for explicit steps. directions : 1, 2 or 3.
    area : W [q], m2.
    law : per unit area; parameters are one number or an array [q]. table, parts : the same as
        compiled code takes it.
    prestress : [directions, q], tractions (Pa) that every point and the rock between them carry at
        u = 0, where the gap is what the normal one makes of it; None without.
    stiffest : K_n and K_s (None without shear) of joints that have closed as far as is in reach,
        and slide where that lifts them, Pa/m, each one number or [q].
    """

    jump: csr_matrix
    stencils: Stencils
    directions: int
    area: np.ndarray
    law: Law
    table: np.ndarray
    parts: LawFlags
    prestress: Any
    stiffest: Any


class Loaded(NamedTuple):
    """The load: freedom [k], share [k] (m2) of each; force on them share times pressure[n].

    pressure : float array [steps + 1], mean over each step, Pa.
    """

    freedom: np.ndarray
    share: np.ndarray
    pressure: np.ndarray


class HalfJoints(NamedTuple):
    """The springs in front of dashpots [k] (`joints.ends`): N/m in the reaction, and how their
    closure advances; all zero where a freedom has none."""

    stiffness: np.ndarray
    decay: np.ndarray
    gain: np.ndarray


class Quiet(NamedTuple):
    """Freedoms on dashpots: freedom [k]; viscosity [k], N s/m; beta = viscosity dt / 2 mass, over
    1 + alpha dt / 2 where there is mass-proportional damping.

    springs : `HalfJoints`, None where every dashpot is on its freedom itself.
    """

    freedom: np.ndarray
    viscosity: np.ndarray
    beta: np.ndarray
    springs: Any = None


class Fixed(NamedTuple):
    """Freedoms whose motion is given: freedom [k]; direction [k] times step[n] (m) from n to n + 1.

    step : float array [steps + 1], m; None where they do not move.
    """

    freedom: np.ndarray
    direction: np.ndarray
    step: Any


class Dashpots(NamedTuple):
    """Nodes in the plane on dashpots in any direction: freedom [k, (x, y)]; viscosity
    [k, (xx, yy, xy)], N s/m; beta as in `Quiet`, of each of these."""

    freedom: np.ndarray
    viscosity: np.ndarray
    beta: np.ndarray


class Ends(NamedTuple):
    """loaded : `Loaded`; quiet : `Quiet`; fixed : `Fixed`; dashpots : `Dashpots`; driven : forces
    that each have a history of their own, `continuum.plane.drive.Drive`; each None where there is
    none."""

    loaded: Any
    quiet: Any
    fixed: Any
    dashpots: Any = None
    driven: Any = None


class Receivers(NamedTuple):
    """How receivers read the state, sparse matrices [rows, n]; c components of the motion.

    point : motion on the axis [c places]; turn : what follows from displacements in other ways:
        rotation about x, y, z [3 places], or gap and slip [2 joints]; None without.
    elastic, inertia : stress of sections or at points, elastic u + inertia (u'' + alpha u') +
        constant, Pa [s].
    viscous : the elastic rows times their eta; None without dashpots.
    contact : [s, directions q], from the joints' forces to tractions, Pa; None where none is read.
    constant : what gravity or a prestress adds, Pa [s]; None without.
    """

    point: csr_matrix
    turn: Any
    elastic: csr_matrix
    viscous: Any
    inertia: csr_matrix
    contact: Any
    constant: Any = None


class Model(NamedTuple):
    """The constants of a run; weight : float array [n], N, steady forces: of gravity, and what
    an excavation takes from the walls of openings; None without. dt : s."""

    rock: RockOperators
    interfaces: Any
    ends: Ends
    weight: Any
    receivers: Receivers
    dt: float
