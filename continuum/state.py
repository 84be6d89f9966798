"""The state of a run, and its samples; absent parts are None."""

from typing import Any, NamedTuple

import numpy as np

from jointwave.continuum.model import Model
from jointwave.continuum.space.simd import WIDTH
from jointwave.joints.law import Law, parts_of
from jointwave.numerics.cache_lines import zeros


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
    strained: Any
    shape: Any


class State(NamedTuple):
    """The state.

    fields : u, v, v_before, rate, loads, drags and strained, one after the other; each is a
        property.
        u : displacement at the step, m; v, v_before : velocity half a step and one and a half
        before; rate : velocity extrapolated to the step, m/s, None without dashpots.
        loads : forces of the joints at the step [directions, q], N, normal (compression positive,
        less the prestress), along x, z; drags : the dashpots' part of them, None without.
        strained : what the stiffness is multiplied by at the step, m; None where that is u.
    force : on each freedom, N; drag : viscous force on each freedom, N; None without dashpots. Of
        rock with a memory all of its force is in it.
    elongation : of the springs of `continuum.model.Memory` [l, n], m; None without.
    opening : the largest of each point so far [q], m; None without softening.
    slide : what has slid [directions - 1, q], m: the elastic part of the slip is B u - slide; None
        where nothing slides. cohesion : of each point [q], Pa; None without residual cohesion.
        path : slid so far [q], m; None where slip changes nothing.
    jump, jump_rate, slip_rate : of displacement, rate and velocity [directions, q], m and m/s;
        None where nothing asks for them.
    closure : of the springs in front of dashpots [k], m; None without them.
    reaction : of the absorbing ends at the last step [k], N; None without them.
    braking : of the dashpots in the plane at the last step [k, 2], N; None without them.
    base_force : on the fixed freedoms at the last step [k], N; None where they do not move.
    ledger : viscous, friction, boundary and load work so far, J; None when not kept.
    """

    fields: np.ndarray
    at: Places
    force: np.ndarray
    drag: Any
    elongation: Any
    opening: Any
    slide: Any
    cohesion: Any
    path: Any
    jump: Any
    jump_rate: Any
    slip_rate: Any
    closure: Any
    reaction: Any
    braking: Any
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
    def strained(self) -> Any:
        """What the stiffness is multiplied by where that is not u, m."""
        return None if self.at.strained is None else self.fields[self.at.strained]

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


def state_at_rest(model: Model, keep_ledger: bool) -> State:
    """Return the state at rest, without arrays for absent effects."""
    n, joints = model.rock.mass.size, model.interfaces
    _, quiet, fixed, dashpots, _ = model.ends
    parts = parts_of(Law(0.0)) if joints is None else joints.parts
    directions, q = (0, 0) if joints is None else (joints.directions, joints.area.size)
    viscous = parts.dashpots or model.rock.viscosity is not None
    viscous = viscous or model.receivers.viscous is not None

    def array(is_asked: bool, *shape: int) -> np.ndarray | None:
        return zeros(shape) if is_asked else None

    cohesion = array(parts.residual and parts.shear, q)
    if joints is not None and cohesion is not None:
        cohesion[:] = joints.law.cohesion
    slide = array(parts.limited, directions - 1, q)
    if joints is not None and joints.prestress is not None and slide is not None:
        slide[:] = joints.prestress[1:] / joints.law.shear_stiffness
    ends = 0 if quiet is None else quiet.freedom.size
    shape = None if joints is None else (directions, q)
    memory = model.rock.memory
    fields, at = _fields(n, viscous, shape, parts.dashpots, memory is not None)
    return State(
        fields=fields,
        at=at,
        force=zeros(n),
        drag=array(viscous or memory is not None, n),
        elongation=None if memory is None else zeros((memory.share.size, n)),
        opening=array(parts.softening, q),
        slide=slide,
        cohesion=cohesion,
        path=array(parts.path, q),
        jump=array(joints is not None, directions, q),
        jump_rate=array(parts.dashpots, directions, q),
        slip_rate=array(parts.limited, directions, q),
        closure=array(quiet is not None and quiet.springs is not None, ends),
        reaction=array(quiet is not None, ends),
        braking=array(dashpots is not None, 0 if dashpots is None else len(dashpots.freedom), 2),
        base_force=None if fixed is None or fixed.step is None else zeros(fixed.freedom.size),
        ledger=array(keep_ledger, 4),
    )


def _fields(
    n: int, viscous: bool, shape: tuple[int, int] | None, damped: bool, relaxes: bool
) -> tuple[np.ndarray, Places]:
    """Return the vectors that receivers read, each from a cache line on."""
    points = 0 if shape is None else shape[0] * shape[1]
    sizes = {"u": n, "v": n, "v_before": n, "rate": n * viscous}
    sizes |= {"loads": points, "drags": points * damped, "strained": n * relaxes}
    places, begin = {}, 0
    for name, size in sizes.items():
        places[name] = slice(begin, begin + size) if size else None
        begin += -(-size // WIDTH) * WIDTH
    return zeros(begin), Places(**places, shape=shape)  # type: ignore[arg-type]


def empty_samples(model: Model, state: State, samples: int) -> Samples:
    """Return empty samples."""
    receivers = model.receivers
    sections, points = receivers.elastic.shape[0], receivers.point.shape[0]
    turns = 0 if receivers.turn is None else receivers.turn.shape[0]
    energy = None if state.ledger is None else np.zeros((len(TERMS), samples))
    return Samples(np.zeros((sections + 2 * points + turns, samples)), energy, sections, points)
