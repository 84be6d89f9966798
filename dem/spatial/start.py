"""Initial state of a spatial scene: unloaded, under its prestress, at rest under gravity."""

import numpy as np

from jointwave.cases.material.calibrate import Properties
from jointwave.cases.sampling import Interpolation
from jointwave.cases.schema.scene import Scene
from jointwave.dem.spatial.build import (
    buffers_for,
    build_block,
    build_ends,
    build_receivers,
    samples_for,
    state_at_rest,
)
from jointwave.dem.spatial.ends import (
    CLOSURE,
    STEADY,
    STIFFNESS,
    contact_points,
    face_of,
    lever_matrix,
)
from jointwave.dem.spatial.layout import LANES, STRIDE, packed, unpacked
from jointwave.dem.spatial.march import make_stepper
from jointwave.dem.spatial.model import Load, RowModel, RowState
from jointwave.dem.spatial.stability import critical_spatial_step
from jointwave.dem.static import (
    NEVER,
    STEP_FRACTION,
    UNBORNE,
    Rest,
    fastest_of_row,
    held_ends,
    prestressed,
    settle,
    stiffest,
    undamped,
)
from jointwave.joints.law import IN_MOTION, sticking
from jointwave.numerics.divergence import guard
from jointwave.results.arrays import copied, fill

NOWHERE = Interpolation(np.arange(0), np.arange(0), np.zeros(0))


def start(scene: Scene, p: Properties, model: RowModel, state: RowState) -> Rest | None:
    """Set the initial state of the scene, and what its ends bear of the weight; return how a static
    state was reached, if it is one.

    Raises SceneError where there is none.
    """
    gravity, rest = scene.gravity, None
    static = gravity is not None and gravity.static
    if static or scene.prestress is not None:
        relaxation = RowRelaxation(scene, p, model, static)
        rest = settle(scene, relaxation)
        relaxation.leave(model, state)
        if static:
            relaxation.rest_on(model, scene.bears)
    if not static and gravity is not None:
        # Gravity from t = 0 on: the velocity at t = 0 is the mean of those half a step around it.
        rows = state.motion.reshape(len(state.motion), -1, STRIDE)
        for k, gain in enumerate(model.block.fall[:3]):
            rows[:, model.form.freedoms + k, :LANES] = -0.5 * gain
        if any(scene.bears):
            standing = gravity.model_copy(update={"static": True})
            held = scene.model_copy(update={"gravity": standing})
            relaxation = RowRelaxation(held, p, model, True, sticks=True)
            settle(held, relaxation, UNBORNE)
            _push_back(model, rows, relaxation.rest_on(model, scene.bears))
    return rest


def _push_back(model: RowModel, rows: np.ndarray, sudden: np.ndarray) -> None:
    """Take from the velocities half a step before the start [tiles, rows, STRIDE] what half a step
    of the ends' sudden forces [2, freedoms] (N, N m) adds."""
    block, size = model.block, model.form.freedoms
    push = block.push[:size].copy()
    if model.form.finite:
        push[3:] = block.push[0] * block.mass  # of angular momentum
    for side, i, force in ((1.0, 0, sudden[0]), (-1.0, model.block_count - 1, sudden[1])):
        lever = lever_matrix(side * block.arm if size == 6 else None, size)
        rows[i // LANES, size : 2 * size, i % LANES] -= 0.5 * push * (lever.T @ force)


class RowRelaxation:
    """The blocks under their static forces: `dem.static.System`.

    Damping and rates do not affect a static state: dashpots and local damping are zero, and
    friction is independent of rate. Quiet and matched ends are held where they bear the weight.
    The kernel is that of the motion, so that a first run compiles one. sticks : whether no joint
    opens, slips or breaks.
    """

    def __init__(
        self, scene: Scene, p: Properties, model: RowModel, weighed: bool, sticks: bool = False
    ) -> None:
        p = undamped(p)
        run, scene, form = scene, _at_rest(scene, weighed), model.form
        turns, face = scene.motion.rotation != "none", face_of(contact_points(scene))
        dt = STEP_FRACTION * critical_spatial_step(
            stiffest(scene, p), face, (scene.ends.start, scene.ends.end), turns
        )
        self.blocks, self.properties = p.block_count, p
        self.rigid = run.ends.start == "fixed", run.ends.end == "fixed"
        block = build_block(scene, p, dt, model.points)
        table = model.table.reshape(len(model.table), -1, LANES).copy()
        table[:, IN_MOTION] = 0.0
        if sticks:
            table = sticking(table.swapaxes(0, 1)).swapaxes(0, 1)
        base = np.zeros(0) if form.base else None
        self.model = model._replace(
            block=block,
            table=table.reshape(model.table.shape),
            load=Load(np.zeros(0), np.zeros(form.freedoms), base),
            ends=None if model.ends is None else build_ends(scene, p, block),
            receivers=build_receivers(NOWHERE, NOWHERE),
            stride=NEVER,
        )
        self.state, self.samples = state_at_rest(self.model), samples_for(self.model, 1)
        # A guard that finds nothing, as the run has one: the same kernel.
        self.buffers = buffers_for(self.model, 1, guard([np.inf] * form.freedoms))
        inertia = block.inertia[: form.freedoms]
        # With finite rotations: half the rotation, and the angular momentum.
        self.turned, self.moving = np.ones_like(inertia), inertia.copy()
        if form.finite:
            self.turned[3:], self.moving[3:] = 2.0, 1.0
        self.mass = np.repeat(inertia, p.block_count)
        weight = np.abs(block.weight).max()
        self.prestress = scene.prestress.normal if scene.prestress else 0.0
        self.scale = max(float(weight) * p.block_count, abs(self.prestress) * p.area)
        self.most_steps = 40_000 + 80_000 * p.block_count
        self._load(scene, p)

    def advance(self, steps: int, alpha: float) -> None:
        """Take steps under mass-proportional damping alpha, 1/s."""
        # From step 1: only step 0 would be a sample.
        march = make_stepper(self._damped(alpha), self.state, self.buffers, self.samples)
        march(1, 1 + steps)

    def unbalanced(self) -> np.ndarray:
        """Return the net force and moment on every freedom, from the step it would cause."""
        own, freedoms = (self.state.motion, self.state.ends), self.model.form.freedoms
        kept = copied(own)
        self.stop()
        self.advance(1, 0.0)
        gain = self.moving[:, None] * self._rows()[freedoms : 2 * freedoms]
        fill(own, kept)
        return gain.ravel() / self.model.block.dt

    def displacement(self) -> np.ndarray:
        """Return displacements (m) and rotations (rad), as if those were small."""
        return (self.turned[:, None] * self._rows()[: self.model.form.freedoms]).ravel()

    def stop(self) -> None:
        """Set all velocities to zero."""
        first = self.model.form.freedoms * STRIDE
        self.state.motion[:, first : 2 * first] = 0.0

    def fastest(self, change: np.ndarray) -> tuple[str, float]:
        """Return the block that moves farthest in a step, and how fast, m/s."""
        moved = change.reshape(-1, self.blocks)[:3]
        return fastest_of_row(self.properties, moved, self.model.block.dt)

    def leave(self, model: RowModel, state: RowState) -> None:
        """Put the static state into the state of a run, whose joints may have rates besides."""
        state.motion[:] = self.state.motion
        if state.history is not None:
            own = model.form.rate_rows * LANES
            state.history[:, own:] = self.state.history[:, own:]
        if state.ends is not None:
            springs = self.state.ends[:, CLOSURE]
            state.ends[:, CLOSURE] = np.where(np.array(self.rigid)[:, None], springs, 0.0)

    def rest_on(self, model: RowModel, bears: tuple[bool, bool]) -> np.ndarray:
        """Give the ends of a run that bear the weight the forces that they are held by here, and
        return what that adds to them [2, freedoms], N and N m."""
        before = model.ends[:, STEADY].copy()
        springs = self.model.ends[:, STIFFNESS] * self.state.ends[:, CLOSURE]
        model.ends[:, STEADY] = np.where(np.array(bears)[:, None], -springs, before)
        return model.ends[:, STEADY] - before

    def _damped(self, alpha: float) -> RowModel:
        block = self.model.block
        drag = 0.5 * block.dt * alpha
        return self.model._replace(
            block=block._replace(
                keep=(1 - drag) / (1 + drag),
                push=block.push / (1 + drag),
                fall=block.fall / (1 + drag),
            )
        )

    def _rows(self) -> np.ndarray:
        return unpacked(self.state.motion, STRIDE, self.blocks)

    def _load(self, scene: Scene, p: Properties) -> None:
        """Place the blocks where elastic joints carry the prestress."""
        along = prestressed(scene, p)[None]
        half = self.prestress / p.wall_stiffness
        for side, kind, closure in ((0, scene.ends.start, -half), (1, scene.ends.end, half)):
            if kind == "fixed":
                self.state.ends[side, CLOSURE, 1] = closure
        self.state.motion[:, STRIDE : 2 * STRIDE] = packed(along, STRIDE)


def _at_rest(scene: Scene, weighed: bool) -> Scene:
    """Return the scene with ends that are fixed or free, and without gravity unless it is
    weighed."""
    held = dict(zip(("start", "end"), held_ends(scene), strict=True))
    return scene.model_copy(
        update={
            "ends": scene.ends.model_copy(update=held),
            "gravity": scene.gravity if weighed else None,
        }
    )
