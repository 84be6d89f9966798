"""Initial state of a spatial scene: unloaded, under its prestress, at rest under gravity."""

from dataclasses import replace

import numpy as np

from cases.material.calibrate import Properties
from cases.sampling import Clock
from cases.schema.scene import Scene
from dem.spatial.build import buffers_for, build_model, samples_for, state_at_rest
from dem.spatial.ends import CLOSURE, contact_points, face_of
from dem.spatial.layout import LANES, STRIDE, packed, unpacked
from dem.spatial.march import marcher
from dem.spatial.model import RowModel, RowState
from dem.spatial.stability import critical_spatial_step
from dem.static import Rest, prestressed, settle, stiffest
from results.arrays import copied, fill

NEVER = 1 << 60  # steps between samples where none are taken
STEP_FRACTION = 0.9  # of the critical step: only where it ends counts


def start(scene: Scene, p: Properties, model: RowModel, state: RowState) -> Rest | None:
    """Bring the unloaded state to where the scene starts; return how if that is a static state.

    Raises SceneError where there is none.
    """
    gravity = scene.gravity
    static = gravity is not None and gravity.static
    rest = None
    if static or scene.prestress is not None:
        relaxation = Relaxation(scene, p, static)
        rest = settle(scene, relaxation)
        relaxation.leave(model, state)
    if not static and gravity is not None:
        # Gravity from t = 0 on: the velocity at t = 0 is the mean of those half a step around it.
        for k, gain in enumerate(model.block.fall[:3]):
            rows = state.motion.reshape(len(state.motion), -1, STRIDE)
            rows[:, model.form.freedoms + k, :LANES] = -0.5 * gain
    return rest


class Relaxation:
    """The blocks under their static forces alone: `dem.static.System`.

    Damping decides no static state and is left out, with what is behind quiet and matched ends.
    """

    def __init__(self, scene: Scene, p: Properties, weighed: bool) -> None:
        p = replace(
            p, time_constant=None, joint_time_constant=None, mass_damping=None, local_damping=None
        )
        scene = _at_rest(scene, weighed)
        turns, face = scene.motion.rotation != "none", face_of(contact_points(scene))
        dt = STEP_FRACTION * critical_spatial_step(
            stiffest(scene, p), face, (scene.ends.start, scene.ends.end), turns
        )
        self.blocks = p.block_count
        model = build_model(scene, p, Clock(dt, 1, 1))._replace(stride=NEVER)
        self.model = model._replace(form=model.form._replace(mass_damping=True))
        self.state = state_at_rest(self.model)
        self.buffers, self.samples = buffers_for(self.model, 1), samples_for(self.model, 1)
        inertia = model.block.inertia[: model.form.freedoms]
        # With finite rotations: half the rotation, and the angular momentum.
        self.turned, self.moving = np.ones_like(inertia), inertia.copy()
        if model.form.finite:
            self.turned[3:], self.moving[3:] = 2.0, 1.0
        self.mass = np.repeat(inertia, p.block_count)
        weight = np.abs(model.block.weight).max()
        self.prestress = scene.prestress.normal if scene.prestress else 0.0
        self.scale = max(float(weight) * p.block_count, abs(self.prestress) * p.area)
        self.most_steps = 10_000 + 20_000 * p.block_count
        self._load(scene, p)

    def advance(self, steps: int, alpha: float) -> None:
        """Take steps under mass-proportional damping alpha, 1/s."""
        # From step 1: only step 0 would be a sample.
        march = marcher(self._damped(alpha), self.state, self.buffers, self.samples)
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

    def leave(self, model: RowModel, state: RowState) -> None:
        """Put the static state into the state of a run, whose joints may have rates besides."""
        state.motion[:] = self.state.motion
        if self.state.history is not None:
            state.history[:, -self.state.history.shape[1] :] = self.state.history
        if self.state.ends is not None and state.ends is not None:
            state.ends[:, CLOSURE] = self.state.ends[:, CLOSURE]

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
        half = self.prestress / (2 * p.regular_stiffness)
        for side, kind, closure in ((0, scene.ends.start, -half), (1, scene.ends.end, half)):
            if kind == "fixed":
                self.state.ends[side, CLOSURE, 1] = closure
        self.state.motion[:, STRIDE : 2 * STRIDE] = packed(along, STRIDE)


def _at_rest(scene: Scene, weighed: bool) -> Scene:
    """Return the scene without load, receivers and ledger, and ends that give way free."""
    held = {k: v if v == "fixed" else "free" for k, v in scene.ends.model_dump().items()}
    still = scene.load.model_copy(update={"amplitude": 0.0, "shape": "step", "quantity": "stress"})
    return scene.model_copy(
        update={
            "load": still,
            "ends": scene.ends.model_copy(update=held),
            "gravity": scene.gravity if weighed else None,
            "record": scene.record.model_copy(
                update={"stress": [], "velocity": [], "energy": False}
            ),
        }
    )
