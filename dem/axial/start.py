"""Where a scene starts from: unloaded, under its prestress, or in equilibrium with gravity."""

from dataclasses import replace

import numpy as np

from cases.material.calibrate import Properties, calibrate
from cases.schema.scene import Scene
from dem.axial.ends import End
from dem.axial.model import Chain, Model, build_chain, receivers, with_mass_damping
from dem.axial.stability import critical_chain_step
from dem.axial.state import State
from dem.axial.step import joint_stress, march
from dem.static import Rest, settle
from numerics.jit import jitted

STEP_FRACTION = 0.9  # of the critical step: only where it ends counts


def start(scene: Scene, model: Model, state: State) -> Rest | None:
    """Bring the unloaded state to where the scene starts; return how if that is a static state.

    The exact elastic state under gravity and prestress is tried first. Where a joint cannot carry
    it, the pillar is relaxed from its prestress alone. Raises SceneError where that does not end.
    """
    gravity = scene.gravity
    static = gravity is not None and gravity.static
    rest = None
    if static or scene.prestress is not None:
        system = Relaxation(scene, calibrate(scene), state, static)
        system.place(system.chain.weight or 0.0)
        if not system.is_at_rest(scene.numerics.dem.static_tolerance):
            system.place(0.0)
        rest = settle(scene, system)
        forget_steps(state)
    if not static and model.chain.weight is not None:
        # Gravity from t = 0 on: the velocity at t = 0 is the mean of those half a step around it.
        state.v[:] = -0.5 * model.chain.dt * model.chain.weight / model.chain.mass
    return rest


def forget_steps(state: State) -> None:
    """Let joints that broke on the way to rest be broken from the first step on."""
    if state.broke is not None:
        state.broke[state.broke >= 0] = 0


class Relaxation:
    """The pillar at its static forces alone: `dem.static.System` on the arrays of a state.

    Dashpots decide no static state and are left out, with those behind quiet and matched ends.
    """

    def __init__(self, scene: Scene, p: Properties, state: State, weighed: bool) -> None:
        p = _undamped(p)
        held = [kind if kind == "fixed" else "free" for kind in (scene.ends.start, scene.ends.end)]
        ends = held[0], held[1]
        dt = STEP_FRACTION * critical_chain_step(p, *ends)
        chain = build_chain(scene, p, dt, ends)
        self.chain = chain if weighed else chain._replace(weight=None)
        self.model = Model(self.chain, np.zeros(0), None, receivers(scene, p))
        self.state = state._replace(
            gap_rate=None,
            start=state.start if held[0] == "fixed" else None,
            end=state.end if held[1] == "fixed" else None,
            ledger=None,
        )
        self.prestress = scene.prestress.normal * p.area if scene.prestress else 0.0
        self.stiffness = p.stiffness * p.area
        self.mass = np.full(p.block_count, p.block_mass)
        weight = abs(self.chain.weight or 0.0) * p.block_count
        self.scale = max(weight, abs(self.prestress))
        self.most_steps = 10_000 + 1000 * p.block_count

    def advance(self, steps: int, alpha: float) -> None:
        """Take steps under mass-proportional damping alpha, 1/s."""
        march(self.model._replace(chain=with_mass_damping(self.chain, alpha)), self.state, 0, steps)

    def unbalanced(self) -> np.ndarray:
        """Return the net force on every block [N], N."""
        s, contacts = self.state, np.empty(len(self.mass) + 1)
        steady = self.chain.steady or (0.0, 0.0)
        contacts[0] = steady[0] + _held(self.chain.start, s.start)
        contacts[-1] = steady[1] + _held(self.chain.end, s.end)
        joint_forces(self.chain, s.u, s.v, s.opening, contacts)
        return contacts[:-1] - contacts[1:] + (self.chain.weight or 0.0)

    def displacement(self) -> np.ndarray:
        """Return the displacement of every block [N], m."""
        return self.state.u

    def stop(self) -> None:
        """Set all velocities to zero."""
        self.state.v[:] = 0.0

    def is_at_rest(self, tolerance: float) -> bool:
        """Return whether nothing would move."""
        return bool(np.abs(self.unbalanced()).max() <= tolerance * self.scale)

    def place(self, weight: float) -> None:
        """Put the blocks where elastic joints would carry this weight of each (N) and prestress.

        A fixed end keeps its place and turns the pillar's displacement into closure; between two
        that give way the displacement has zero mean.
        """
        s, forces = self.state, self.elastic_forces(weight)
        gaps = -forces[1:-1] / self.stiffness
        u = np.append(0.0, np.cumsum(gaps))
        shift = -u.mean()
        if self.chain.start is not None:
            s.start[0] = forces[0] / self.chain.start.stiffness
            shift = -s.start[0]
        if self.chain.end is not None:
            s.end[0] = forces[-1] / self.chain.end.stiffness
            shift = s.end[0] - u[-1]
        s.u[:] = u + shift
        if s.opening is not None:
            s.opening[:] = np.maximum(gaps, 0.0)

    def elastic_forces(self, weight: float) -> np.ndarray:
        """Return the force of every contact [N + 1], N: all carry the prestress, and the weight
        goes to the fixed ends, between two of them as their springs share it."""
        steps = weight * np.arange(len(self.mass) + 1)
        start, end = self.chain.start, self.chain.end
        first = 0.0
        if start is not None and end is not None:
            c = 1 / np.concatenate([[start.stiffness], self.stiffness, [end.stiffness]])
            first = -float(c @ steps) / float(c.sum())
        elif start is not None:
            first = -steps[-1]
        return self.prestress + first + steps


def _undamped(p: Properties) -> Properties:
    return replace(
        p, time_constant=None, joint_time_constant=None, mass_damping=None, local_damping=None
    )


def _held(end: End | None, state: np.ndarray) -> float:
    return 0.0 if end is None else end.stiffness * state[0]


@jitted
def joint_forces(chain: Chain, u, v, opening, contacts):
    """Write the forces of all joints (N) between the first and the last of the contacts."""
    for j in range(u.size - 1):
        contacts[j + 1] = chain.area * joint_stress(chain, u, v, None, opening, j)
