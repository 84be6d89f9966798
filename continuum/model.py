"""The constants of a run in one, two or three dimensions, and what changes in it.

Two objects; absent parts are None. A freedom is one component of the displacement of one node;
where it stands in a vector, `continuum.space.operator.layout` says.

Where several processes share a run, each holds part of the rock and of the joints. Every force,
mass, viscosity and weight is then its own share, and `total` and `beta` are of all together.
"""

from typing import Any, NamedTuple

import numpy as np

from continuum.space.operator import Operator
from continuum.space.sparse import Rows
from joints.laws import Law


class Rock(NamedTuple):
    """The deformable rock.

    stiffness : N/m; viscosity : N s/m, None without dashpots.
    mass : float array [n], kg; step_over_mass : dt over the total mass, s/kg.
    keep : (1 - alpha dt / 2) / (1 + alpha dt / 2) of mass-proportional damping alpha, None without;
        step_over_mass is then divided by 1 + alpha dt / 2.
    """

    stiffness: Operator
    viscosity: Any
    mass: np.ndarray
    step_over_mass: np.ndarray
    keep: Any


class Interfaces(NamedTuple):
    """The joints, at their quadrature points.

    opening : B_n [q, n], the gap is opening times u.
    slip_x, slip_z : B_x, B_z [q, n], likewise; None where nothing moves that way.
    area : W [q], m2.
    law : per unit area; parts are one number or an array [q].
    prestress : normal traction (Pa) that every point and the rock between them carry at u = 0;
        the gap is then short by prestress / K_n; None without.
    runs : opening, slip_x, slip_z by runs of alike points.
    """

    opening: Rows
    slip_x: Any
    slip_z: Any
    area: np.ndarray
    law: Law
    prestress: Any
    runs: Any


class Memory(NamedTuple):
    """What the points of the joints remember, float arrays [q].

    opening : the largest so far, m; None without softening.
    slide_x, slide_z : what has slid, m: the elastic part of the slip is B u - slide; None where
        nothing slides, or has no such direction.
    cohesion : of the point, Pa; None without residual cohesion.
    """

    opening: Any
    slide_x: Any
    slide_z: Any
    cohesion: Any


class Tractions(NamedTuple):
    """On the joints at the step, float arrays [q], Pa: normal (compression positive), along x, z.

    x, z : None without slip in that direction.
    drag_n, drag_x, drag_z : the dashpots' part of these; None without dashpots.
    """

    normal: np.ndarray
    x: Any
    z: Any
    drag_n: Any
    drag_x: Any
    drag_z: Any


class Measured(NamedTuple):
    """Jumps of all points at the step, float arrays [q]; None where nothing asks for them.

    gap, x, z : of the displacement, m. gap_rate, rate_x, rate_z : of the rate, m/s.
    way_x, way_z : of the velocity, m/s. pull : room for a component of the points' forces, N.
    """

    gap: np.ndarray
    x: Any
    z: Any
    gap_rate: Any
    rate_x: Any
    rate_z: Any
    way_x: Any
    way_z: Any
    pull: np.ndarray


class Loaded(NamedTuple):
    """The load: freedom [k], share [k] (m2) of each; force on them share times load[n] (Pa).

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


class Held(NamedTuple):
    """Freedoms whose motion is given: freedom [k]; way [k] times step[n] (m) from n to n + 1.

    step : float array [steps + 1], m; None where they stand still.
    """

    freedom: np.ndarray
    way: np.ndarray
    step: Any


class Ends(NamedTuple):
    """loaded : `Loaded`; quiet : `Quiet`; held : `Held`; each None where there is none."""

    loaded: Any
    quiet: Any
    held: Any


class Receivers(NamedTuple):
    """point, turn : [r components, n], displacement and rotation (rad; None without) of points.

    A section's force over its area = elastic (u + eta rate) + inertia (u'' + alpha u') + weight,
    Pa [s components, n].
    viscous : the elastic rows times their eta; None without dashpots.
    contact : [s, q], tractions that sections on joints read; None where none is.
    weight : of the rock that `inertia` accelerates, Pa [s components]; None without gravity.
    """

    point: Rows
    turn: Any
    elastic: Rows
    viscous: Any
    inertia: Rows
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


class State(NamedTuple):
    """What changes.

    u : displacement at the step, m; v, v_before : velocity half a step and one and a half before.
    force : on each freedom, N.
    rate : velocity extrapolated to the step, m/s; drag : viscous force on each freedom, N; both
        None without dashpots.
    memory : `Memory`; tractions : `Tractions`; jumps : `Measured`; None without joints.
    closure : of the springs in front of dashpots [k], m; None without them.
    reaction : of the absorbing ends at the last step [k], N; None without them.
    wall : force (N) on the held freedoms at the last step [k]; None where they stand still.
    ledger : viscous, friction, boundary and load work so far, J; None when not kept.
    """

    u: np.ndarray
    v: np.ndarray
    v_before: np.ndarray
    force: np.ndarray
    rate: Any
    drag: Any
    memory: Any
    tractions: Any
    jumps: Any
    closure: Any
    reaction: Any
    wall: Any
    ledger: Any


class Samples(NamedTuple):
    """Room for what is recorded [row of the receivers' matrices, sample]; turn None without.

    energy : [term, sample] in the order of `continuum.explicit.record.TERMS`, None when not kept.
    """

    stress: np.ndarray
    velocity: np.ndarray
    displacement: np.ndarray
    turn: Any
    energy: Any
