"""The constants of a run, and what changes in it, as two objects; absent parts are None."""

from typing import Any, NamedTuple

import numpy as np

from continuum.sparse import Rows
from joints.laws import Law


class Rock(NamedTuple):
    """The deformable rock.

    stiffness : [n, n], N/m; time_constant : Kelvin-Voigt eta, s, or None.
    mass : float array [n], kg; step_over_mass : dt / mass, s/kg.
    """

    stiffness: Rows
    time_constant: Any
    mass: np.ndarray
    step_over_mass: np.ndarray


class Interfaces(NamedTuple):
    """The joints, at their quadrature points.

    jump : B [q, n]; gather : B^T W [n, q], m2; area : W [q], m2; law : per unit area.
    """

    jump: Rows
    gather: Rows
    area: np.ndarray
    law: Law


class HalfJoints(NamedTuple):
    """The springs in front of dashpots [k] (`joints.ends`): N/m in the reaction, and how their
    closure advances; all zero where an end has none."""

    stiffness: np.ndarray
    decay: np.ndarray
    gain: np.ndarray


class Quiet(NamedTuple):
    """Nodes on dashpots: node [k]; viscosity [k], N s/m; beta = viscosity dt / 2 mass.

    springs : `HalfJoints`, None where every dashpot is on its node itself.
    """

    node: np.ndarray
    viscosity: np.ndarray
    beta: np.ndarray
    springs: Any = None


class Ends(NamedTuple):
    """loaded : the node at y = 0; quiet : `Quiet` or None; fixed : int array of nodes or None."""

    loaded: int
    quiet: Any
    fixed: Any


class Receivers(NamedTuple):
    """point [r, n]; stress of a section = elastic (u + eta rate) + inertia u'', Pa [s, n].

    contact : [s, q], sections that read a joint's traction; None where there is none.
    """

    point: Rows
    elastic: Rows
    inertia: Rows
    contact: Any


class Model(NamedTuple):
    """The constants of a run; load : float array [steps + 1], N, mean over each step; dt : s."""

    rock: Rock
    interfaces: Any
    ends: Ends
    receivers: Receivers
    load: np.ndarray
    dt: float


class State(NamedTuple):
    """What changes.

    u : displacement at the step, m; v, v_before : velocity half a step and one and a half before.
    force : on each node, N.
    rate : velocity extrapolated to the step, m/s; drag : viscous force on each node, N; both None
        without dashpots.
    traction, dashpot : of the joints' springs and dashpots, Pa; None without them.
    closure : of the springs in front of dashpots [k], m; None without them.
    reaction : of the absorbing ends at the last step [k], N; None without them.
    ledger : viscous, boundary and load work so far, J; None when not kept.
    """

    u: np.ndarray
    v: np.ndarray
    v_before: np.ndarray
    force: np.ndarray
    rate: Any
    traction: Any
    dashpot: Any
    drag: Any
    closure: Any
    reaction: Any
    ledger: Any


class Samples(NamedTuple):
    """Room for what is recorded [receiver, sample]; energy [5, sample] or None."""

    stress: np.ndarray
    velocity: np.ndarray
    displacement: np.ndarray
    energy: Any


def state_at_rest(model: Model, keep_ledger: bool) -> State:
    """Return the state at rest, with no array for anything that the model does not have."""
    n, joints = model.rock.mass.size, model.interfaces
    q = 0 if joints is None else joints.area.size
    viscous_joints = joints is not None and joints.law.normal_viscosity is not None
    quiet = model.ends.quiet
    sprung = quiet is not None and quiet.springs is not None
    viscous = viscous_joints or model.rock.time_constant is not None
    return State(
        u=np.zeros(n),
        v=np.zeros(n),
        v_before=np.zeros(n),
        force=np.zeros(n),
        rate=np.zeros(n) if viscous else None,
        traction=np.zeros(q) if q else None,
        dashpot=np.zeros(q) if viscous_joints else None,
        drag=np.zeros(n) if viscous else None,
        closure=np.zeros(quiet.node.size) if sprung else None,
        reaction=np.zeros(quiet.node.size) if quiet is not None else None,
        ledger=np.zeros(3) if keep_ledger else None,
    )


def room(model: Model, state: State, samples: int) -> Samples:
    """Return empty samples."""
    sections, points = model.receivers.elastic.start.size - 1, model.receivers.point.start.size - 1
    return Samples(
        stress=np.zeros((sections, samples)),
        velocity=np.zeros((points, samples)),
        displacement=np.zeros((points, samples)),
        energy=None if state.ledger is None else np.zeros((5, samples)),
    )
