"""The constants of a rock mass of rigid blocks in the plane, and what changes in it.

All is per metre of thickness. A contact joins block i to block j along a straight edge; n is its
normal from i to j, t = (-n_y, n_x) its tangent and e the place of a point on it, from its centre
along t. For small rotations, with the displacement and the rotation of both blocks at the centre,

    gap(e) = g - e (phi_j - phi_i),   slip = s,

so that all points of a contact slip alike. The force on block j, and its moment about the centre,

    F = n sum L w t_n + t sum L w t_s,   M = -sum e L w t_n.
"""

from typing import Any, NamedTuple

import numpy as np

from joints.law import Law, Parts
from numerics.cache_lines import zeros

#: Columns of the table of contacts.
N_X, N_Y, I_X, I_Y, J_X, J_Y, LENGTH = range(7)
CONTACT = 8

#: Columns of the force of a contact on its block j: F, the moments about the centroids of j and
#: of i (that on i has the other sign), M and the sum of e L w t_s.
F_X, F_Y, ON_J, ON_I, BENDING, STRETCH = range(6)
FORCE = 6


class PlaneForm(NamedTuple):
    """Which effects a rock mass has: the constants of its compiled kernel.

    parts : of the joint law. points : points of a contact; 0 where joints always hold, which
    need none. mass_damping, local_damping, gravity : of the blocks. held : whether some blocks have
    dashpots of their own, or forces. ledger : whether energies are kept. ruled : whether contacts
    differ in the rule of their points. stressed : whether contacts start under a traction. shaken :
    whether walls move. relaxed : whether the same kernel brings the blocks to rest first, for which
    it can damp their motion, without a place in the ledger.
    """

    parts: Parts
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


class Contacts(NamedTuple):
    """The joints between blocks.

    blocks : int array [c, 2], i and j. table : float array [c, CONTACT], normal, from each block's
    centroid to the contact's centre, m, and length, m. law : int array [c], the column of the
    law's table; None where all joints are alike. start : float array [c, 2], the opening and the
    slip that stand for what a contact carries before anything moves, m; None without prestress.
    """

    blocks: np.ndarray
    table: np.ndarray
    law: Any
    start: Any = None


class Adjacency(NamedTuple):
    """The contacts of each block, in their order.

    first : int array [N + 1]. side : int array, twice the contact, plus 1 where the block is its j.
    """

    first: np.ndarray
    side: np.ndarray


class Held(NamedTuple):
    """Blocks that dashpots beyond the domain, or forces, act on.

    row : int array [N], the row of a block in what follows, -1 of all others. keeps, moves :
    float arrays [h, 3, 3], what is left of its velocity in a step, and the velocity by an impulse.
    dashpot : float array [h, 3, 3], of all its dashpots, N s/m.
    """

    row: np.ndarray
    keeps: np.ndarray
    moves: np.ndarray
    dashpot: np.ndarray


class Blocks(NamedTuple):
    """Constants of the blocks.

    inertia : float array [N, 2], mass (kg) and moment of inertia (kg m2). dt : s. keep : what
    mass-proportional damping leaves of a velocity in a step. local : Cundall's damping.
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

    form: PlaneForm
    blocks: Blocks
    contacts: Contacts
    adjacency: Adjacency
    laws: np.ndarray
    rules: np.ndarray
    held: Any
    places: np.ndarray
    watched: np.ndarray
    walls: int = 0


class PlaneState(NamedTuple):
    """What changes: displacement u [N, 3] at a whole step, velocity v [N, 3] half a step before it,
    of the blocks and then the walls.

    force : float array [c, FORCE], of the contacts at the last step. rate : float array [c, 3], of
    their opening, slip and rotation one and a half steps before; None without dashpots.
    drag : float array [c, 3], N, N and N m, of their dashpots at the last step; None without a
    ledger of them. history : float array [c, points, 3], what has slid, m, the largest opening, m,
    and the cohesion, Pa, of each point, with a fourth, the path, m, where that changes it; None
    where joints always hold. sums : float array [4], J,
    running sums of the ledger: viscous, friction, boundary, work; None without.
    """

    u: np.ndarray
    v: np.ndarray
    force: np.ndarray
    rate: Any
    drag: Any
    history: Any
    sums: Any


def contacts_of(
    blocks: np.ndarray,
    start: np.ndarray,
    end: np.ndarray,
    normal: np.ndarray,
    centroids: tuple[np.ndarray, np.ndarray],
    law: np.ndarray | None = None,
) -> Contacts:
    """Return contacts between blocks i, j [c, 2] along the edges from start to end [c, 2], m.

    normal : float array [c, 2], unit vectors from i to j. centroids : of i and of j where they
    touch [c, 2], m, those of j moved by the period where they touch across periodic sides. law :
    int array [c], column of each; None where all joints are alike.
    """
    centre = (start + end) / 2
    table = np.zeros((len(blocks), CONTACT))
    table[:, [N_X, N_Y]] = normal
    table[:, [I_X, I_Y]] = centre - centroids[0]
    table[:, [J_X, J_Y]] = centre - centroids[1]
    table[:, LENGTH] = np.linalg.norm(end - start, axis=1)
    return Contacts(np.ascontiguousarray(blocks, dtype=np.int64), table, law)


def adjacency_of(blocks: np.ndarray, count: int) -> Adjacency:
    """Return the contacts [c, 2] of each of so many blocks."""
    order = np.argsort(blocks.ravel(), kind="stable")
    first = np.searchsorted(blocks.ravel()[order], np.arange(count + 1))
    return Adjacency(first.astype(np.int64), order.astype(np.int64))


def held_by(dashpot: np.ndarray, index: np.ndarray, inertia: np.ndarray, dt: float) -> Held:
    """Return held blocks from their dashpots [h, 3, 3], N s/m, and their numbers [h].

    inertia : of all blocks [N, 2]. Their dashpots see the mean velocity of both half steps:
    (1 + dt C / 2 M) v[n+1/2] = v - (dt C / 2 M) v[n-1/2], v the velocity without them.
    """
    row = np.full(len(inertia), -1)
    row[index] = np.arange(len(index))
    lost = 0.5 * dt * dashpot / inertia[index][:, [0, 0, 1], None]
    moves = np.linalg.inv(np.eye(3) + lost)
    # In one layout, whatever it comes from: another is another kernel.
    return Held(row, -moves @ lost, moves, np.ascontiguousarray(dashpot))


def state_at_rest(model: PlaneModel) -> PlaneState:
    """Return the state at rest, with no array for any effect that the rock mass does not have."""
    form, contacts = model.form, len(model.contacts.blocks)
    count = len(model.blocks.inertia) + model.walls
    history = None
    if form.points:
        history = zeros((contacts, form.points, 3 + form.parts.path))
        if form.parts.residual:
            row = Law._fields.index("cohesion")
            of = 0 if model.laws.shape[1] == 1 else model.contacts.law
            history[:, :, 2] = np.broadcast_to(model.laws[row, of], contacts)[:, None]
    return PlaneState(
        u=zeros((count, 3)),
        v=zeros((count, 3)),
        force=zeros((contacts, FORCE)),
        rate=zeros((contacts, 3)) if form.parts.dashpots else None,
        drag=zeros((contacts, 3)) if form.parts.dashpots and form.ledger else None,
        history=history,
        sums=np.zeros(4) if form.ledger else None,
    )
