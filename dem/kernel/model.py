"""The constants and the state of rigid blocks in one, two or three dimensions.

The freedoms of a block are its `dim` displacements and, if it rotates, one rotation in the plane or
three in space. Masses and forces are per metre of thickness in the plane.
"""

from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from jointwave.dem.contacts.chunks import LANES, Chunks
from jointwave.joints.law import Law, LawFlags
from jointwave.numerics.cache_lines import zeros
from jointwave.results.dataset import TERMS


def rows(**sizes: int) -> Any:
    """Return the offset of each group of rows in a flat array, and the total `size`."""
    begins = LANES * np.append(0, np.cumsum([*sizes.values()]))
    return SimpleNamespace(**dict(zip((*sizes, "size"), begins.tolist(), strict=True)))


class KernelFlags(NamedTuple):
    """The effects of a system of blocks: compile-time constants of its kernel.

    dim : 1, 2 or 3. turns : whether blocks rotate. parts : of the joint law. points : whether
    contacts have points; joints that always hold need none. mass_damping, local_damping, gravity :
    of the blocks. held : whether some blocks have boundary dashpots or external forces. matched :
    whether such dashpots act through springs. ledger : whether energies are recorded. stressed :
    whether contacts start under a traction. shaken : whether walls move. relaxed : whether dynamic
    relaxation uses the same kernel, with mass damping that the ledger leaves out. in_row : whether
    contacts mostly join consecutive blocks. oblique : whether inertia tensors have products of
    inertia. stages : of a step, 1 for leapfrog. finite : whether blocks in space rotate by any
    angle; their contacts then have points.
    """

    dim: int
    turns: bool
    parts: LawFlags
    points: bool
    mass_damping: bool
    local_damping: bool
    gravity: bool
    held: bool
    ledger: bool
    stressed: bool = False
    shaken: bool = False
    relaxed: bool = False
    in_row: bool = False
    oblique: bool = False
    matched: bool = False
    stages: int = 1
    finite: bool = False

    @property
    def rotations(self) -> int:
        """Rotations of a block."""
        return self.turns * self.dim * (self.dim - 1) // 2

    @property
    def freedoms(self) -> int:
        """Displacements and rotations of a block."""
        return self.dim + self.rotations

    @property
    def motions(self) -> int:
        """Components of the relative motion at a contact."""
        return self.dim + (self.spread_rows if self.finite else self.rotations)

    @property
    def rated(self) -> bool:
        """Whether forces or the ledger need rates of relative motion."""
        p = self.parts
        return p.dashpots or (self.points and (self.ledger or p.path))

    @property
    def drags(self) -> bool:
        """Whether the dashpots' share of forces is stored separately."""
        return self.parts.dashpots and self.ledger

    @property
    def spread_rows(self) -> int:
        """First moments of the traction over a face."""
        return self.turns * self.dim * (self.dim - 1)

    @property
    def recorded(self) -> int:
        """Rows of a contact's samples, in its frame: force on block j, first moments of the
        traction about the face's centre, gap and slip."""
        return 2 * self.dim + self.spread_rows

    @property
    def table(self) -> Any:
        """Rows of the table of contacts.

        frame : normal and tangents; in the plane the normal only. arm_i, arm_j : from centroids to
        the centre of the face, m. area : m2. extent : extent of block j behind the centre of the
        face and along its tangents, m (finite rotations). start : gap and slip that give the
        initial traction, m. second : second moments along the first tangent, along the second, and
        mixed, m4. Then place in the face, m, and area, m2, of each point, `dim` rows.
        """
        dim, arms = self.dim, self.dim * self.turns
        return rows(
            frame=(0, 2, 9)[dim - 1],
            arm_i=arms,
            arm_j=arms,
            area=1,
            extent=dim * self.finite,
            start=dim * self.stressed,
            second=dim * (dim - 1) // 2 * (self.turns and not self.points),
        )

    @property
    def buffer(self) -> Any:
        """Rows of a chunk's buffer; they are at the same places whatever the joint law.

        gathered : motion of the blocks, with finite rotations the scalar parts of quaternions last.
        jump : relative motion at the step. rate, now : its rates half a step before, and at the
        step. force : in the frame. spread : first moments of the traction about the face's centre.
        on_j, on_i : force on block j and moments on both blocks. drag : the dashpots' force and
        moment. law : parameters of the law, where joints differ. spare : scratch for one block.
        before : after the last row, velocities of the tile before the step. Points sum into the
        rows from `force` up to `on_j`, and from `drag` up to `law`.
        """
        m = self.motions
        found = rows(
            gathered=self.dim + 2 * self.rotations + 2 * self.finite,
            jump=m,
            rate=m,
            now=m,
            force=self.dim,
            spread=self.spread_rows,
            on_j=self.freedoms,
            on_i=self.rotations,
            drag=m,
            law=len(Law._fields),
            spare=1,
        )
        found.before = found.size
        return found

    @property
    def history(self) -> Any:
        """Rows of a contact's history.

        rate : of relative motion one and a half steps before. drag : the dashpots' force and moment
        at the last step. jump : relative motion at the last step, with finite rotations. Then the
        rows of each point, see `point`.
        """
        rates = self.motions * self.parts.dashpots
        return rows(
            rate=rates, drag=rates * self.ledger, jump=self.motions * (self.finite and self.rated)
        )

    @property
    def remembers(self) -> bool:
        """Whether contacts have a history."""
        return self.history.size > 0 or (self.points and self.point.size > 0)

    @property
    def point(self) -> Any:
        """Rows of a point's history: slide, largest opening, m, steps until it broke, cohesion, Pa,
        path, m."""
        p = self.parts
        return rows(
            slid=self.dim - 1,
            opening=p.softening,
            whole=p.softening,
            cohesion=p.residual,
            path=p.path,
        )


class Held(NamedTuple):
    """Blocks with boundary dashpots or external forces.

    block : their numbers [h], ascending. matrices : [h, 3, freedoms, freedoms], the new velocity is
    the first times the old one plus the second times the one without dashpots; the third holds the
    dashpots, N s/m. springs : [h, 3, freedoms, freedoms], of dashpots behind springs: the new
    closures are the first times the old ones plus the second, s, times the velocity; the third
    times the closures is the force against the block, N/m. None without.
    """

    block: np.ndarray
    matrices: np.ndarray
    springs: Any = None


class Blocks(NamedTuple):
    """Constants of the blocks.

    inertia : mass (kg) and moments of inertia (kg m2) [N, freedoms]. dt : s. keep : factor of
    mass-proportional damping on a velocity per step. local : Cundall's local damping. gravity :
    [dim], m/s2. tensor : inertia tensors [N, 3, 3], kg m2; None without products of inertia. mass :
    gravitational mass [N], kg, where it differs from the inertial mass; else None. stages : kick
    and drift of each stage of a composed step [stages, 2], s; None for leapfrog.
    """

    inertia: np.ndarray
    dt: float
    keep: float
    local: float
    gravity: np.ndarray
    tensor: Any = None
    mass: Any = None
    stages: Any = None


class Model(NamedTuple):
    """The constants of a run.

    laws : the parameters of the joint law [field, column], one column where all joints are equal.
    held : a `Held`; None where no external force or dashpot acts on blocks. places, watched :
    recorded blocks [r] and contacts [w]. walls : their number; a wall is fixed or shaken, has no
    inertia, and is numbered after the blocks.
    """

    form: KernelFlags
    blocks: Blocks
    chunks: Chunks
    laws: np.ndarray
    held: Any
    places: np.ndarray
    watched: np.ndarray
    walls: int = 0

    @property
    def points(self) -> int:
        """Points of a contact; 0 where joints always hold."""
        return (self.chunks.table.shape[1] - self.form.table.size) // (LANES * self.form.dim)

    @property
    def inertia(self) -> np.ndarray:
        """Momentum per unit of `State.v` [N, freedoms]; 1 where that is an angular momentum."""
        found = self.blocks.inertia
        return np.hstack([found[:, :3], np.ones((len(found), 3))]) if self.form.finite else found


class State(NamedTuple):
    """The state of the blocks and then the walls.

    u : displacement [N, freedoms] at a whole step. v : velocity [N, freedoms] half a step before,
    in composed steps at the same time. With finite rotations, u holds the vector parts of unit
    quaternions, `turn` [N] their scalar parts (else None), and v angular momenta, N m s. history :
    of contacts [chunks, rows LANES]; None without. sums : dissipated or supplied energy [terms], J;
    None without a ledger. closure : of the springs of held blocks [h, freedoms], m; None without.
    """

    u: np.ndarray
    v: np.ndarray
    history: Any
    sums: Any
    closure: Any = None
    turn: Any = None


class Samples(NamedTuple):
    """Recorded samples.

    displacement, velocity : of blocks [place, freedoms, sample], as in `State`; with finite
    rotations the scalar parts of quaternions are the last displacement. contact : [watched,
    `KernelFlags.recorded`, sample]. energy : the ledger [term, sample], J; None without. closure :
    of held blocks [h, freedoms, sample], m; None without.
    """

    displacement: np.ndarray
    velocity: np.ndarray
    contact: np.ndarray
    energy: Any
    closure: Any = None


def held_by(
    dashpot: np.ndarray,
    block: np.ndarray,
    masses: np.ndarray,
    dt: float,
    keep: float = 1.0,
    springs: np.ndarray | None = None,
) -> Held:
    """Return held blocks from their dashpots [h, freedoms, freedoms], N s/m, and numbers [h].

    masses : matrices of mass and inertia of all blocks [N, freedoms, freedoms]. keep : as in
    `Blocks`. springs : as in `Held`.

    Dashpots act on the mean velocity of both half steps: with a = dt (1 + keep) / 4,
    (1 + a M^-1 C) v[n+1/2] = v - a M^-1 C v[n-1/2], v the velocity without them.
    """
    lost = 0.25 * dt * (1 + keep) * np.linalg.solve(masses[block], dashpot)
    moves = np.linalg.inv(np.eye(dashpot.shape[1]) + lost)
    return Held(block, np.stack([-moves @ lost, moves, dashpot], axis=1), springs)


def state_at_rest(model: Model) -> State:
    """Return the state at rest, without arrays for absent effects."""
    form, pair = model.form, model.chunks.pair
    count, history = len(model.blocks.inertia) + model.walls, None
    if size := form.history.size + model.points * form.point.size:
        history = zeros((len(pair), size))
        if form.parts.residual:
            cohesion = model.laws[Law._fields.index("cohesion")]
            own = cohesion[pair[:, 2 * LANES :] if form.parts.varied else 0]
            for first in range(form.history.size + form.point.cohesion, size, form.point.size):
                history[:, first : first + LANES] = own
    return State(
        u=zeros((count, form.freedoms)),
        v=zeros((count, form.freedoms)),
        history=history,
        sums=np.zeros(len(TERMS)) if form.ledger else None,
        closure=np.zeros((len(model.held.block), form.freedoms)) if form.matched else None,
        turn=np.ones(count) if form.finite else None,
    )


def samples_for(model: Model, count: int) -> Samples:
    """Return arrays of zeros for `count` samples."""
    form, places, closure = model.form, len(model.places), None
    displacement = np.zeros((places, form.freedoms + form.finite, count))
    velocity = np.zeros((places, form.freedoms, count))
    contact = np.zeros((len(model.watched), form.recorded, count))
    if form.matched:
        closure = np.zeros((len(model.held.block), form.freedoms, count))
    energy = np.zeros((len(TERMS), count)) if form.ledger else None
    return Samples(displacement, velocity, contact, energy, closure)


def first_of(samples: Samples, count: int) -> Samples:
    """Return the first `count` samples."""
    return Samples._make(None if one is None else one[..., :count] for one in samples)
