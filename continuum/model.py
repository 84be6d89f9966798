"""The constants of a run in one, two or three dimensions, and what changes in it.

Two objects; absent parts are None. A freedom is one component of the displacement of one node;
where it stands in a vector, `continuum.space.operator.layout` says.

Where several processes share a run, each holds part of the rock and of the joints. Every force,
mass, viscosity and weight is then its own share, and `total` and `beta` are of all together.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from continuum.space.operator import Operator
from continuum.space.stencils import Stencils
from joints.law import Law, Parts


class Rock(NamedTuple):
    """The deformable rock.

    stiffness : N/m; viscosity : N s/m, None without dashpots.
    mass : float array [n], kg; step_over_mass : dt over the total mass, s/kg.
    decay : (1 - alpha dt / 2) / (1 + alpha dt / 2) of mass-proportional damping alpha, None
        without; step_over_mass is then divided by 1 + alpha dt / 2.
    """

    stiffness: Operator
    viscosity: Any
    mass: np.ndarray
    step_over_mass: np.ndarray
    decay: Any


class Interfaces(NamedTuple):
    """The joints, at their q quadrature points.

    jump : B [directions * q, n], displacements to the gap of all points, then to their slip along
        x, then z; stencils : the same for compiled code. directions : 1, 2 or 3.
    area : W [q], m2.
    law : per unit area; parameters are one number or an array [q]. table, parts : the same as
        compiled code takes it.
    prestress : normal traction (Pa) that every point and the rock between them carry at u = 0;
        the gap is then short by prestress / K_n; None without.
    """

    jump: csr_matrix
    stencils: Stencils
    directions: int
    area: np.ndarray
    law: Law
    table: np.ndarray
    parts: Parts
    prestress: Any


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


class Ends(NamedTuple):
    """loaded : `Loaded`; quiet : `Quiet`; fixed : `Fixed`; each None where there is none."""

    loaded: Any
    quiet: Any
    fixed: Any


class Receivers(NamedTuple):
    """How receivers read the state, sparse matrices [rows, n]; c components of the motion.

    point : motion on the axis [c places]; turn : rotation about x, y, z [3 places], None without.
    elastic, inertia : stress of sections, elastic u + inertia (u'' + alpha u') + weight,
        Pa [c sections].
    viscous : the elastic rows times their eta; None without dashpots.
    contact : [sections, q], tractions that sections on joints read; None where none is.
    weight : of the rock that `inertia` accelerates, Pa [c sections]; None without gravity.
    """

    point: csr_matrix
    turn: Any
    elastic: csr_matrix
    viscous: Any
    inertia: csr_matrix
    contact: Any
    weight: Any = None


class Model(NamedTuple):
    """The constants of a run; weight : float array [n], N, None without gravity; dt : s."""

    rock: Rock
    interfaces: Any
    ends: Ends
    weight: Any
    receivers: Receivers
    dt: float


class Places(NamedTuple):
    """Where the vectors that receivers read stand in `State.fields`, slices; None for absent ones.

    shape : of loads and drags, (directions, q).
    """

    u: slice
    v: slice
    v_before: slice
    rate: Any
    loads: Any
    drags: Any
    shape: Any


class State(NamedTuple):
    """What changes.

    fields : u, v, v_before, rate, loads and drags, one after the other; each is a property.
        u : displacement at the step, m; v, v_before : velocity half a step and one and a half
        before; rate : velocity extrapolated to the step, m/s, None without dashpots.
        loads : forces of the joints at the step [directions, q], N, normal (compression positive,
        less the prestress), along x, z; drags : the dashpots' part of them, None without.
    force : on each freedom, N; drag : viscous force on each freedom, N; None without dashpots.
    opening : the largest of each point so far [q], m; None without softening.
    slide : what has slid [directions - 1, q], m: the elastic part of the slip is B u - slide; None
        where nothing slides. cohesion : of each point [q], Pa; None without residual cohesion.
    jump, jump_rate, slip_rate : of displacement, rate and velocity [directions, q], m and m/s;
        None where nothing asks for them.
    closure : of the springs in front of dashpots [k], m; None without them.
    reaction : of the absorbing ends at the last step [k], N; None without them.
    base_force : on the fixed freedoms at the last step [k], N; None where they do not move.
    ledger : viscous, friction, boundary and load work so far, J; None when not kept.
    """

    fields: np.ndarray
    at: Places
    force: np.ndarray
    drag: Any
    opening: Any
    slide: Any
    cohesion: Any
    jump: Any
    jump_rate: Any
    slip_rate: Any
    closure: Any
    reaction: Any
    base_force: Any
    ledger: Any

    @property
    def u(self) -> np.ndarray:
        """Displacement, m."""
        return self.fields[self.at.u]

    @property
    def v(self) -> np.ndarray:
        """Velocity, m/s."""
        return self.fields[self.at.v]

    @property
    def v_before(self) -> np.ndarray:
        """Velocity of the step before, m/s."""
        return self.fields[self.at.v_before]

    @property
    def rate(self) -> Any:
        """Rate that dashpots see, m/s."""
        return None if self.at.rate is None else self.fields[self.at.rate]

    @property
    def loads(self) -> Any:
        """Forces of the joints, N."""
        return None if self.at.loads is None else self.fields[self.at.loads].reshape(self.at.shape)

    @property
    def drags(self) -> Any:
        """Forces of the joints' dashpots, N."""
        return None if self.at.drags is None else self.fields[self.at.drags].reshape(self.at.shape)


#: The rows of a ledger; of these STATES are energies of the step, the others sums so far.
TERMS = ("kinetic", "elastic", "fracture", "gravity", "viscous", "friction", "boundary", "work")
STATES = 4


class Samples(NamedTuple):
    """What is recorded: waves [row, sample], stress of all sections, then velocity, displacement
    and rotation of all points; energy [term, sample] in the order of `TERMS`, None when not kept.

    sections, points : how many rows stress, velocity and displacement have.
    """

    waves: np.ndarray
    energy: Any
    sections: int
    points: int

    @property
    def stress(self) -> np.ndarray:
        """Of sections, Pa."""
        return self.waves[: self.sections]

    @property
    def velocity(self) -> np.ndarray:
        """Of points, m/s."""
        return self.waves[self.sections : self.sections + self.points]

    @property
    def displacement(self) -> np.ndarray:
        """Of points, m."""
        return self.waves[self.sections + self.points : self.sections + 2 * self.points]

    @property
    def turn(self) -> np.ndarray:
        """Rotation of points, empty where nothing turns."""
        return self.waves[self.sections + 2 * self.points :]
