"""The constants and the state of a rock mass of rigid blocks in the plane.

All per metre of thickness. A contact joins block i to block j along a straight edge; n is its
normal from i to j, t = (-n_y, n_x) its tangent and e the place of a point on it, from its centre
along t. For small rotations, with the displacement and the rotation of both blocks at the centre,

    gap(e) = g - e (phi_j - phi_i),   slip = s,

so that all points of a contact slip alike. The force on block j, and its moment about the centre,

    F = n sum L w t_n + t sum L w t_s,   M = -sum e L w t_n.
"""

from typing import Any, NamedTuple

import numpy as np

from jointwave.dem.blocks.tiles import LANES, START, Contacts
from jointwave.joints.law import Law, LawFlags
from jointwave.numerics.cache_lines import zeros
from jointwave.results.rock_mass import TERMS


class KernelFlags(NamedTuple):
    """The effects of a rock mass: compile-time constants of its kernel.

    parts : of the joint law. points : points of a contact; 0 where joints always hold, which
    need none. mass_damping, local_damping, gravity : of the blocks. held : whether some blocks have
    dashpots of their own, or forces. ledger : whether energies are kept. ruled : whether contacts
    differ in the rule of their points. stressed : whether contacts start under a traction. shaken :
    whether walls move. relaxed : whether the same kernel brings the blocks to rest first, for which
    it can damp their motion, without a place in the ledger.
    """

    parts: LawFlags
    points: int
    mass_damping: bool
    local_damping: bool
    gravity: bool
    held: bool
    ledger: bool
    ruled: bool = False
    stressed: bool = False
    shaken: bool = False
    relaxed: bool = False

    @property
    def rate_rows(self) -> int:
        """Rows of history with the rates of a contact's relative motion, and its dashpots' forces
        for the ledger."""
        return 3 * self.parts.dashpots * (1 + self.ledger)

    @property
    def point_rows(self) -> int:
        """Rows of history for each point: what has slid, opening, cohesion, path."""
        p = self.parts
        return (1 + p.softening + p.residual + p.path) * (self.points > 0)

    @property
    def bend_row(self) -> int:
        """Row of the contacts' table with what bends joints that always hold."""
        return START + 2 * self.stressed


class Held(NamedTuple):
    """Blocks with boundary dashpots or external forces.

    block : int array [h], ascending. keeps, moves : float arrays [h, 3, 3], what is left of its
    velocity in a step, and the share of the velocity without its dashpots. dashpot : float array
    [h, 3, 3], of all its dashpots, N s/m.
    """

    block: np.ndarray
    keeps: np.ndarray
    moves: np.ndarray
    dashpot: np.ndarray


class Blocks(NamedTuple):
    """Constants of the blocks.

    inertia : float array [N, 3], mass (kg), twice, and moment of inertia (kg m2). dt : s. keep :
    what mass-proportional damping leaves of a velocity in a step. local : Cundall's damping.
    gravity_x, gravity_y : m/s2.
    """

    inertia: np.ndarray
    dt: float
    keep: float
    local: float
    gravity_x: float
    gravity_y: float


class PlaneModel(NamedTuple):
    """The constants of a run.

    laws : the parameters of the joint law [field, column], one column where all joints are alike.
    rules : place over length, from the contact's centre, and weight of its points [1, 2, points],
    or [column, 2, points] by the columns of the law. held : None where nothing acts on blocks from
    outside. places, watched : int arrays [r] and [w], recorded blocks and contacts.

    Contacts may name blocks beyond the last that has an inertia: walls, which stand still or are
    shaken.
    """

    form: KernelFlags
    blocks: Blocks
    contacts: Contacts
    laws: np.ndarray
    rules: np.ndarray
    held: Any
    places: np.ndarray
    watched: np.ndarray
    walls: int = 0


class PlaneState(NamedTuple):
    """The state: displacement u [N, 3] at a whole step, velocity v [N, 3] half a step before it,
    of the blocks and then the walls.

    history : float array [chunks, rows LANES], what contacts remember; None where that is nothing.
    Rows: with dashpots the rates of opening, slip and rotation one and a half steps before, with a
    ledger too their forces at the last step (N, N and N m), and then for each point what has slid,
    m, and where the law asks for them the largest opening, m, the cohesion, Pa, and the path, m.
    sums : float array [terms], J, what has been dissipated or put in; None without a ledger.
    """

    u: np.ndarray
    v: np.ndarray
    history: Any
    sums: Any


def held_by(dashpot: np.ndarray, block: np.ndarray, inertia: np.ndarray, dt: float) -> Held:
    """Return held blocks from their dashpots [h, 3, 3], N s/m, and their numbers [h], ascending.

    inertia : of all blocks [N, 3]. Their dashpots see the mean velocity of both half steps:
    (1 + dt C / 2 M) v[n+1/2] = v - (dt C / 2 M) v[n-1/2], v the velocity without them.
    """
    lost = 0.5 * dt * dashpot / inertia[block][:, :, None]
    moves = np.linalg.inv(np.eye(3) + lost)
    # In one layout, whatever it comes from: another is another kernel.
    return Held(block, -moves @ lost, moves, np.ascontiguousarray(dashpot))


def state_at_rest(model: PlaneModel) -> PlaneState:
    """Return the state at rest, without arrays for absent effects."""
    form, pair = model.form, model.contacts.pair
    count = len(model.blocks.inertia) + model.walls
    rows, history = form.rate_rows + form.points * form.point_rows, None
    if rows:
        history = zeros((len(pair), rows, LANES))
        if form.parts.residual:
            cohesion = model.laws[Law._fields.index("cohesion")]
            own = cohesion[pair[:, None, 2 * LANES :] if form.parts.varied else 0]
            history[:, form.rate_rows + 1 + form.parts.softening :: form.point_rows] = own
        history = history.reshape(len(pair), rows * LANES)
    return PlaneState(
        u=zeros((count, 3)),
        v=zeros((count, 3)),
        history=history,
        sums=np.zeros(len(TERMS)) if form.ledger else None,
    )
