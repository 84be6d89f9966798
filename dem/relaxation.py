"""Initial state of rigid blocks: unloaded, or by dynamic relaxation under prestress and gravity.

Mass-proportional damping alpha is critical for a mode omega at alpha = 2 omega. The frequency of
the present motion follows from changes of displacement du and unbalanced force dF over a few steps,

    omega^2 = -du . dF / (du . M du),

Rayleigh's quotient. So the damping follows the motion from fast modes to the slowest, which takes
some ln(1 / tolerance) / (omega dt) steps. Underwood, Dynamic relaxation, in: Computational Methods
for Transient Analysis (1983).
"""

from math import ceil, sqrt
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from jointwave.cases.errors import SceneError, placed
from jointwave.cases.material.closure import stresses
from jointwave.dem.blocks.rigid import constants
from jointwave.dem.contacts.chunks import LANES, Chunks
from jointwave.dem.contacts.faces import Contacts
from jointwave.dem.contacts.stability import squared_frequencies
from jointwave.dem.kernel.leapfrog import make_stepper
from jointwave.dem.kernel.model import Model, State, held_by, samples_for, state_at_rest
from jointwave.dem.sides.loads import Loads
from jointwave.dem.system import BlockSystem
from jointwave.joints.law import IN_MOTION, Law, sticking
from jointwave.results.arrays import copied, fill

STEPS_AT_ONCE = 10  # between checks of the forces
STEP_FRACTION = 0.9  # of the critical step: only the final state matters
NEVER = 1 << 60  # sampling interval, in steps, for no samples
UNBORNE = "what quiet boundaries bear of the weight is not found: fix the one below"
#: A stall is no progress for 1 / PATIENCE of the most steps, and for as many steps as led there:
#: blocks that rest on ever fewer contact points come to rest ever more slowly.
PATIENCE = 80
STEADY = 0.9  # ratio of successive distances of steady motion: 1 at constant speed, 3 from rest
STAGES = 40  # stages of releasing the walls of openings where joints may slip or open
STICKING_RATIO = 1e-4  # out-of-balance ratio with sticking joints, before they may slip and open
RESIDUAL = 1e-4  # default residual force, over the force of loads and waves on a block
LEAST = 1e-12  # smallest default of the out-of-balance ratio
CHUNKS_A_STAGE = 0.3  # chunks of ten steps after each stage, over the root of the number of blocks


class Rest(NamedTuple):
    """Outcome of dynamic relaxation: steps taken, out-of-balance ratio (largest unbalanced force
    over the scale), and the block that keeps moving, or None."""

    steps: int
    ratio: float
    moving: str | None = None

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of a result."""
        return {"static_steps": self.steps, "static_out_of_balance": self.ratio}


def start(system: BlockSystem, state: State) -> Rest | None:
    """Set the initial state, and the weight that quiet sides bear; return the outcome of the
    relaxation to a static state, if there was one.

    Raises SceneError where no static state exists.
    """
    scene, blocks = system.blocks.scene, system.model.blocks
    static = scene.gravity is not None and scene.gravity.static
    rest, bears, form = None, bool(system.bearing.any()), system.model.form
    if static or scene.prestress is not None:
        relaxation = BlockRelaxation(system, static)
        walls = relaxation.walls
        before = relaxation.stick() if walls is None else relaxation.excavate(walls)
        rest = relaxation.settle()
        rest = rest._replace(steps=before + rest.steps)
        state.u[:] = relaxation.state.u
        if state.turn is not None:
            state.turn[:] = relaxation.state.turn
        if state.history is not None:
            rows, kept = form.history, form.history.jump
            state.history[:, kept:] = relaxation.state.history[:, kept:]
            if form.parts.softening:  # joints that broke here, broke before the run
                size = state.history.shape[1]
                for first in range(rows.size + form.point.whole, size, form.point.size):
                    state.history[:, first : first + LANES] = 0.0
        if static and bears:
            system.loads.add_steady(relaxation.borne())
    if scene.gravity is not None and not static:
        # Gravity from t = 0 on: the velocity at t = 0 is the mean of those half a step around it.
        count, ahead = len(blocks.inertia), 0.5 * blocks.dt if form.stages == 1 else 0.0
        state.v[:count, : len(blocks.gravity)] = -ahead * blocks.gravity
        if bears:
            relaxation = BlockRelaxation(system, True, sticks=True)
            relaxation.settle(UNBORNE)
            found, loads = relaxation.borne(), system.loads
            loads.add_steady(found)
            impulse = ahead * found @ loads.onto.T
            state.v[loads.rows] -= impulse / system.model.inertia[loads.rows]
    return rest


def unstressed(model: Model) -> Chunks:
    """Return the contacts of a model without tractions under prestress."""
    table, rows = model.chunks.table.copy(), model.form.table
    table[:, rows.start : rows.second] = 0.0
    return model.chunks._replace(table=table)


def mass_factors(contacts: Contacts, squared: np.ndarray) -> np.ndarray:
    """Return factors of the mass matrices [N] that give all blocks the same critical step.

    Groups of blocks without a wall keep their masses: they come to rest about their centre of mass.

    squared : of `stability.squared_frequencies` [N], 1/s2.
    """
    found, count, (i, j) = np.ones(len(squared)), len(squared), contacts.blocks.T
    inner = j < count
    graph = coo_array((np.ones(inner.sum()), (i[inner], j[inner])), shape=(count, count))
    group = connected_components(graph, directed=False)[1]
    held = np.isin(group, group[i[~inner]])
    np.divide(squared, squared.max(), out=found, where=held & (squared > 0.0))
    return found


class BlockRelaxation:
    """Dynamic relaxation of the blocks under their static forces.

    Masses are scaled so that all blocks of a group with a wall have the same critical step
    (Underwood): a static state depends on weight and stiffness only. All dashpots and local damping
    are zero, and friction does not depend on rate. Quiet sides bear the weight by the springs of
    half a block of rock before a wall. The kernel is that of the motion, which saves compiling a
    second one, except for composed steps.

    sticks : apply the weight alone, with joints that cannot open, slip or break.
    """

    def __init__(self, system: BlockSystem, weighed: bool, sticks: bool = False) -> None:
        blocks, model, loads = system.blocks, system.model, system.loads
        self.scene = blocks.scene
        columns = blocks.columns._replace(viscosity=None)
        # Resultants of the springs of quiet sides that bear the weight, per block displacement.
        self.bearing, onto, rows = system.bearing @ loads.onto.T, loads.onto, loads.rows
        springs = np.zeros_like(blocks.masses)
        springs[rows] = weighed * (onto @ self.bearing)
        squared = squared_frequencies(blocks.contacts, columns, blocks.masses, springs)
        factors = mass_factors(blocks.contacts, squared)
        masses = blocks.masses * factors[:, None, None]
        dt = 2 * STEP_FRACTION / sqrt((squared / factors).max())
        own = constants(blocks, dt, masses)._replace(local=0.0, mass=blocks.inertia[:, 0])
        laws = model.laws.copy()
        if not weighed:
            own = own._replace(gravity=np.zeros_like(own.gravity))
        laws[IN_MOTION] = 0.0
        self.rows, self.steady, self.walls, self.alpha = rows, loads.steady, None, 0.0
        stress = blocks.prestress
        if sticks:
            laws, self.steady, stress = sticking(laws), np.zeros_like(self.steady), None
            model = model._replace(chunks=unstressed(model))
        if stress is not None and (walls := blocks.around.opened) and model.form.points:
            rows = np.union1d(rows, walls.block)
            self.walls = Loads(rows, [walls], [], system.time, onto).steady
            self.steady = np.zeros_like(self.walls)
            self.steady[np.searchsorted(rows, loads.rows)] = loads.steady
        held = None
        if model.form.held:
            still, own_springs = np.broadcast_to(np.eye(len(onto)), springs[rows].shape), None
            if model.form.matched:
                own_springs = np.stack([still, dt * still, springs[rows]], axis=1)
            held = held_by(0 * still, rows, masses, dt, springs=own_springs)
        form = model.form._replace(stages=1)
        self.model = model._replace(form=form, blocks=own, laws=laws, held=held)
        self.state, self.samples = state_at_rest(self.model), samples_for(self.model, 0)
        self.count, most = len(own.inertia), STEPS_AT_ONCE
        self._drive = np.zeros((most, *self.steady.shape))
        shake = np.zeros((most, model.walls, blocks.dim)) if model.form.shaken else None
        self._take = make_stepper(
            self.model, self.state, self.samples, most, self._drive, shake, system.threads
        )
        self.mass = own.inertia.ravel()
        weight = float(np.linalg.norm(own.gravity) * blocks.inertia[:, 0].sum())
        self.scale = weight + (blocks.pressed if stress is not None else 0.0)
        numerics, area = self.scene.numerics.dem, blocks.contacts.area
        wave = RESIDUAL * stresses(self.scene)[1] * float(np.median(area) if area.size else 0.0)
        self.goal = numerics.static_tolerance
        if wave and self.scale and "static_tolerance" not in numerics.model_fields_set:
            self.goal = min(self.goal, max(wave / self.scale, LEAST))
        self.masses, self.centroid, self.most_steps = masses, blocks.centroid, blocks.static_steps
        self.rotation = np.ones(masses.shape[1])
        if model.form.finite:  # v has angular momenta; a quaternion's vector is half the rotation
            self.masses = self.model.inertia[:, :, None] * np.eye(6)
            self.rotation[3:] = 2.0
        if weighed and blocks.placed is not None:
            self.place(blocks.placed, blocks.scene.numerics.dem.static_tolerance)

    def excavate(self, walls: np.ndarray) -> int:
        """Release the walls of openings in stages, except the last, and return the steps taken.
        Released at once, blocks would overshoot and slip too far.

        walls : forces of the walls on blocks, in the rows of `steady`.
        """
        whole, chunks = self.steady, ceil(CHUNKS_A_STAGE * np.sqrt(self.count))
        for stage in range(1, STAGES):
            self.steady = whole + (1 - stage / STAGES) * walls
            now = self.look()
            for _ in range(chunks):
                now = self.damp(*now)
            self.state.v[:] = 0.0
        self.steady = whole
        return (STAGES - 1) * chunks * STEPS_AT_ONCE

    def stick(self) -> int:
        """Relax with joints that neither slip nor open, if some can, and return the steps taken.
        From rest, undamped, blocks would overshoot and slip too far."""
        if self.state.history is None or not self.model.form.points:
            return 0
        before, own = copied(self.state), self.model.laws.copy()
        closes = Law._fields.index("maximum_closure")
        self.model.laws[:] = sticking(own)
        self.model.laws[closes] = own[closes]
        self.state.history[:] = state_at_rest(self.model).history
        rest = self.relax(STICKING_RATIO)
        self.model.laws[:] = own
        at = self.state if rest.ratio <= STICKING_RATIO else before
        fill(self.state, before._replace(u=at.u, turn=at.turn, closure=at.closure))
        return rest.steps

    def place(self, moved: np.ndarray, tolerance: float) -> None:
        """Start from this displacement of the blocks [N, F] if it is a static state."""
        before = copied(self.state)
        self.state.u[: self.count] = moved
        if self.state.closure is not None:
            self.state.closure[:] = moved[self.model.held.block]
        force = np.abs(self.unbalanced())
        if not force.max() <= tolerance * self.scale:
            fill(self.state, before)

    def settle(self, unborne: str = "") -> Rest:
        """Bring the blocks to rest under gravity and prestress.

        unborne : remedy to report where quiet sides cannot bear sudden gravity. Raises SceneError
        without a static state within numerics.dem.static_tolerance; its message distinguishes a
        block that keeps moving from a residual that is too large.
        """
        scene, tolerance = self.scene, self.scene.numerics.dem.static_tolerance
        rest = self.relax(self.goal)
        if rest.ratio <= tolerance:
            return rest
        key, remedy = "gravity", unborne or "static = false starts without it"
        if not unborne and (scene.gravity is None or not scene.gravity.static):
            where = " around the openings" if scene.excavated else ""
            key, remedy = "prestress", f"the joints{where} cannot carry it"
        why = (
            f"has not come to rest: out-of-balance ratio {rest.ratio:.1e} after {rest.steps} steps,"
            f" above numerics.dem.static_tolerance = {tolerance:.1e}: raise it to accept this state"
        )
        if rest.moving is not None:
            why = (
                f"no static state: {rest.moving} moves on after {rest.steps} steps of dynamic "
                f"relaxation: it slides, tips or is unsupported; {remedy}"
            )
        raise SceneError(scene.where, key, None, why)

    def relax(self, tolerance: float) -> Rest:
        """Relax until the out-of-balance ratio is within the tolerance.

        End after `most_steps`, or once the ratio stalls while blocks keep moving: during the stall,
        they move farther than before it, or at a speed that does not fall.
        """
        u, force = self.look()
        start, ratio, steps, begin, moving = u, self.ratio(force), 0, 0, None
        best, at_begin, at_half = ratio, start, start
        while tolerance < ratio and steps < self.most_steps and moving is None:
            before = u
            u, force = self.damp(u, force)
            steps, ratio = steps + STEPS_AT_ONCE, self.ratio(force)
            patience = max(self.most_steps / PATIENCE, begin)
            if steps - begin <= patience / 2:
                at_half = u
            elif steps - begin > patience:
                first, second, until = at_half - at_begin, u - at_half, at_begin - start
                farther = self.mass @ (first + second) ** 2 > self.mass @ until**2
                if farther or self.mass @ (first * (second - STEADY * first)) > 0:
                    moving = self.fastest(u - before)
            if ratio < 0.9 * best or steps - begin > patience:
                best, begin, at_begin = min(best, ratio), steps, u
        self.state.v[:] = 0.0
        return Rest(steps, ratio, None if ratio <= tolerance else moving)

    def ratio(self, force: np.ndarray) -> float:
        """Return the largest unbalanced force over the scale."""
        largest = float(np.abs(force).max())
        return largest / self.scale if largest else 0.0

    def look(self) -> tuple[np.ndarray, np.ndarray]:
        """Return displacements and rotations (m, rad), and the unbalanced forces (N, N m)."""
        return (self.rotation * self.state.u[: self.count]).ravel(), self.unbalanced()

    def damp(self, u: np.ndarray, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Take steps with damping that is critical for the last motion; return the new `look`.

        u, force : the `look` before.
        """
        self.advance(STEPS_AT_ONCE, self.alpha)
        now, left = self.look()
        change = now - u
        inertia = float(change @ (self.mass * change))
        stiffness = max(float(change @ (force - left)), 0.0)
        self.alpha = 2 * sqrt(stiffness / inertia) if inertia > 0 else 0.0
        return now, left

    def advance(self, steps: int, alpha: float) -> None:
        """Take steps with mass-proportional damping alpha, 1/s."""
        drag = 0.5 * self.model.blocks.dt * alpha
        self._drive[:] = self.steady
        # From step 1: step 0 would be sampled.
        self._take(NEVER, 1, 1 + steps, (1 - drag) / (1 + drag))

    def unbalanced(self) -> np.ndarray:
        """Return the net force and moment on every freedom, from the velocity after one step."""
        kept = copied(self.state)
        self.state.v[:] = 0.0
        self.advance(1, 0.0)
        gain = self.masses @ self.state.v[: self.count, :, None]
        fill(self.state, kept)
        return gain.ravel() / self.model.blocks.dt

    def borne(self) -> np.ndarray:
        """Return the resultants [h, d + d^2] of the forces by which quiet sides bear the weight."""
        closure = self.state.closure[np.isin(self.model.held.block, self.rows)]
        return -(self.bearing @ closure[:, :, None])[:, :, 0]

    def fastest(self, change: np.ndarray) -> str:
        """Name the block that moves farthest."""
        dim = self.centroid.shape[1]
        moved = np.linalg.norm(change.reshape(self.count, -1)[:, :dim], axis=1)
        k = int(moved.argmax())
        return f"the block at {placed(self.centroid[k].round(6) + 0.0, 4)}"
