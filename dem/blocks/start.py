"""Initial state of a rock mass of rigid blocks: unloaded, under its prestress, at rest under
gravity."""

from __future__ import annotations

from math import ceil
from typing import TYPE_CHECKING

import numpy as np

from cases.material.prestress import refuse_beyond_strength
from dem.blocks.leapfrog import marcher, samples_for
from dem.blocks.model import PlaneState, held_by, state_at_rest
from dem.blocks.sources import Sources, reactions
from dem.blocks.stability import critical_plane_step
from dem.blocks.tiles import LANES
from dem.static import NEVER, STEP_FRACTION, STEPS_BETWEEN_LOOKS, Damped, Rest, settle
from joints.law import IN_MOTION
from results.arrays import copied, fill

if TYPE_CHECKING:
    from dem.blocks.system import PlaneSystem

PARTS = 40  # in which walls of openings are released where joints may slip or open
LOOKS = 0.3  # stretches of ten steps after each part, over the root of the number of blocks


def start(system: PlaneSystem, state: PlaneState) -> Rest | None:
    """Set the initial state of the scene; return how a static state was reached, if it is one.

    Raises SceneError where there is none.
    """
    scene, blocks = system.blocks.scene, system.model.blocks
    static = scene.gravity is not None and scene.gravity.static
    rest = None
    if not static:
        refuse_beyond_strength(scene)
    if static or scene.prestress is not None:
        relaxation = PlaneRelaxation(system, static)
        before = relaxation.excavate()
        rest = settle(scene, relaxation)
        rest = rest._replace(steps=before + rest.steps)
        state.u[:] = relaxation.state.u
        if state.history is not None:
            points = LANES * system.model.form.rate_rows
            state.history[:, points:] = relaxation.state.history[:, points:]
    if scene.gravity is not None and not static:
        # Gravity from t = 0 on: the velocity at t = 0 is the mean of those half a step around it.
        count = len(blocks.inertia)
        state.v[:count, :2] = -0.5 * blocks.dt * np.array([blocks.gravity_x, blocks.gravity_y])
    return rest


class PlaneRelaxation:
    """The blocks under their static forces: `dem.static.System`.

    Damping and rates do not affect a static state: dashpots, also of quiet sides, and local
    damping are zero, and friction is independent of rate. The kernel is that of the motion, so
    that a first run compiles one.
    """

    def __init__(self, system: PlaneSystem, weighed: bool) -> None:
        blocks, model, sources = system.blocks, system.model, system.sources
        columns = blocks.columns._replace(time_constants=None)
        dt = STEP_FRACTION * critical_plane_step(blocks.links, columns, blocks.inertia, 0.0)
        own, laws = model.blocks._replace(dt=dt, local=0.0), model.laws.copy()
        if not weighed:
            own = own._replace(gravity_x=0.0, gravity_y=0.0)
        laws[IN_MOTION] = 0.0
        rows, self.steady, self.walls = sources.rows, sources.steady, None
        stress, partition = blocks.scene.prestress, blocks.partition
        if stress is not None and blocks.scene.excavated and model.form.points:
            openings = [name for name in partition.sides if name.startswith("opening")]
            walls = reactions(partition, openings, stress)
            rows = np.union1d(rows, walls.block)
            self.walls = Sources(rows, [walls], [], system.time).steady
            self.steady = np.zeros_like(self.walls)
            self.steady[np.searchsorted(rows, sources.rows)] = sources.steady
        nothing = np.zeros((len(rows), 3, 3))
        held = held_by(nothing, rows, own.inertia, dt) if model.form.held else None
        self.model = model._replace(blocks=own, laws=laws, held=held)
        self.state, self.samples = state_at_rest(self.model), samples_for(self.model, 0)
        self.count, most = len(own.inertia), STEPS_BETWEEN_LOOKS
        self._drive = np.zeros((most, *self.steady.shape))
        shake = np.zeros((most, model.walls, 2)) if model.form.shaken else None
        self._take = marcher(
            self.model, self.state, self.samples, most, self._drive, shake, system.threads
        )
        self.mass = blocks.masses.ravel()
        g = np.hypot(own.gravity_x, own.gravity_y)
        pressed = 0.0 if stress is None else max(map(abs, (stress.xx, stress.yy, stress.xy)))
        self.scale = float(
            g * blocks.inertia.mass.sum() + pressed * partition.boundary.length.sum()
        )
        self.most_steps = 10_000 + 10_000 * int(np.sqrt(self.count))

    def excavate(self) -> int:
        """Release the walls of openings but for the last part, and return the steps taken: all at
        once blocks overshoot, and slip further than they must."""
        if self.walls is None:
            return 0
        whole, looks = self.steady, ceil(LOOKS * np.sqrt(self.count))
        for part in range(1, PARTS):
            self.steady = whole + (1 - part / PARTS) * self.walls
            damped = Damped(self)
            for _ in range(looks):
                damped.advance()
            self.stop()
        self.steady = whole
        return (PARTS - 1) * looks * STEPS_BETWEEN_LOOKS

    def advance(self, steps: int, alpha: float) -> None:
        """Take steps under mass-proportional damping alpha, 1/s."""
        drag = 0.5 * self.model.blocks.dt * alpha
        self._drive[:] = self.steady
        # From step 1: only step 0 would be a sample.
        self._take(NEVER, 1, 1 + steps, (1 - drag) / (1 + drag))

    def unbalanced(self) -> np.ndarray:
        """Return the net force and moment on every freedom, from the step that they would cause."""
        kept = copied(self.state)
        self.stop()
        self.advance(1, 0.0)
        gain = self.state.v[: self.count].ravel().copy()
        fill(self.state, kept)
        return self.mass * gain / self.model.blocks.dt

    def displacement(self) -> np.ndarray:
        """Return displacements (m) and rotations (rad)."""
        return self.state.u[: self.count].ravel()

    def stop(self) -> None:
        """Set all velocities to zero."""
        self.state.v[:] = 0.0
