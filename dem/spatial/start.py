"""Where a spatial scene starts from: unloaded, under its prestress, at rest under gravity."""

from dataclasses import replace

import numpy as np

from cases.material.calibrate import Properties
from cases.sampling import Clock
from cases.schema.scene import Scene
from dem.spatial.build import build_model, room_for, samples_for, state_at_rest
from dem.spatial.layout import LANES, STRIDE, freedoms, packed, unpacked
from dem.spatial.model import Model, State
from dem.spatial.section import contact_points, face_of, section
from dem.spatial.stability import critical_spatial_step
from dem.spatial.step import march
from dem.static import Rest, prestressed, settle

NEVER = 1 << 60  # steps between samples where none are taken
STEP_FRACTION = 0.9  # of the critical step: only where it ends counts


def start(scene: Scene, p: Properties, model: Model, state: State) -> Rest | None:
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
    if not static and model.motion.fall is not None:
        # Gravity from t = 0 on: the velocity at t = 0 is the mean of those half a step around it.
        for k, gain in enumerate(model.motion.fall):
            rows = state.motion.reshape(len(state.motion), -1, STRIDE)
            rows[:, freedoms(model.contact.rows) + k, :LANES] = -0.5 * gain
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
        turns, face = scene.motion.rotation != "none", face_of(section(contact_points(scene)))
        dt = STEP_FRACTION * critical_spatial_step(
            p, face, (scene.ends.start, scene.ends.end), turns
        )
        self.blocks = p.block_count
        self.model = build_model(scene, p, Clock(dt, 1, 1))._replace(stride=NEVER)
        self.state = state_at_rest(self.model, p.block_count)
        self.room, self.samples = room_for(self.model, 1), samples_for(self.model, 1)
        inertia = [p.block_mass] * 3 + [p.inertia_across, p.inertia_along, p.inertia_across]
        self.mass = np.repeat(inertia[: freedoms(self.model.contact.rows)], p.block_count)
        weight = 0.0 if self.model.weight is None else np.abs(self.model.weight).max()
        self.prestress = scene.prestress.normal if scene.prestress else 0.0
        self.scale = max(float(weight) * p.block_count, abs(self.prestress) * p.area)
        self.most_steps = 10_000 + 20_000 * p.block_count
        self._press(scene, p)

    def advance(self, steps: int, alpha: float) -> None:
        """Take steps under mass-proportional damping alpha, 1/s."""
        # From step 1: only step 0 would be a sample.
        march(self._damped(alpha), self.state, self.room, self.samples, 1, 1 + steps)

    def unbalanced(self) -> np.ndarray:
        """Return the net force and moment on every freedom, from the step it would cause."""
        s = self.state
        kept = [array.copy() for array in (s.motion, *_closures(s))]
        self.stop()
        self.advance(1, 0.0)
        gain = self._rows()[len(self._rows()) // 2 :].ravel()
        for array, old in zip((s.motion, *_closures(s)), kept, strict=True):
            array[:] = old
        return self.mass * gain / self.model.motion.dt

    def displacement(self) -> np.ndarray:
        """Return displacements (m) and rotations (rad)."""
        return self._rows()[: len(self._rows()) // 2].ravel()

    def stop(self) -> None:
        """Set all velocities to zero."""
        self.state.motion[:, freedoms(self.model.contact.rows) * STRIDE :] = 0.0

    def leave(self, model: Model, state: State) -> None:
        """Put the static state into the state of a run, whose joints may have rates besides."""
        state.motion[:] = self.state.motion
        if self.state.history is not None:
            state.history[:, -self.state.history.shape[1] :] = self.state.history
        for mine, theirs in ((self.state.start, state.start), (self.state.end, state.end)):
            if mine is not None and theirs is not None:
                theirs.closure[:] = mine.closure

    def _damped(self, alpha: float) -> Model:
        m = self.model.motion
        drag = 0.5 * m.dt * alpha
        return self.model._replace(
            motion=m._replace(
                keep=(1 - drag) / (1 + drag),
                push=m.push / (1 + drag),
                twist=None if m.twist is None else tuple(t / (1 + drag) for t in m.twist),
                fall=None if m.fall is None else tuple(f / (1 + drag) for f in m.fall),
            )
        )

    def _rows(self) -> np.ndarray:
        return unpacked(self.state.motion, STRIDE, self.blocks)

    def _press(self, scene: Scene, p: Properties) -> None:
        """Place the blocks where elastic joints carry the prestress."""
        along = np.zeros((len(self.model.contact.rows.motion), p.block_count))
        along[1] = prestressed(scene, p)
        half = self.prestress / (2 * p.regular_stiffness)
        for kind, end, closure in (
            (scene.ends.start, self.state.start, -half),
            (scene.ends.end, self.state.end, half),
        ):
            if kind == "fixed":
                end.closure[1] = closure
        self.state.motion[:] = packed(along, STRIDE)


def _closures(state: State) -> list[np.ndarray]:
    return [end.closure for end in (state.start, state.end) if end is not None]


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
