"""Initial state of a scene: unloaded, under its prestress, or in equilibrium with gravity."""

from collections.abc import Callable
from functools import cache

import numpy as np

from cases.material.calibrate import Properties, calibrate
from cases.schema.scene import Scene
from dem.axial.leapfrog import march
from dem.axial.model import Model, unloaded, with_mass_damping
from dem.axial.springs import spring_forces
from dem.axial.stability import critical_chain_step
from dem.axial.state import State
from dem.static import STEP_FRACTION, Rest, gaps_under, settle, stiffest, undamped
from joints.law import Parts
from numerics.jit import jitted


def start(scene: Scene, model: Model, state: State) -> Rest | None:
    """Set the initial state of the scene; return how a static state was reached, if it is one.

    The exact elastic state under gravity and prestress is tried first. If a joint cannot carry
    it, the pillar is relaxed from its prestress. Raises SceneError if that does not converge.
    """
    gravity = scene.gravity
    static = gravity is not None and gravity.static
    rest = None
    if static or scene.prestress is not None:
        system = ChainRelaxation(scene, calibrate(scene), state, static)
        system.place(system.chain.weight)
        if not system.is_at_rest(scene.numerics.dem.static_tolerance):
            system.place(0.0)
        rest = settle(scene, system)
        forget_steps(state)
    if not static and model.effects.gravity:
        # Gravity from t = 0 on: the velocity at t = 0 is the mean of those half a step around it.
        state.v[:] = -0.5 * model.chain.dt * model.chain.weight / model.chain.mass
    return rest


def forget_steps(state: State) -> None:
    """Set joints that broke during relaxation as broken from the first step."""
    if state.broke is not None:
        state.broke[state.broke >= 0] = 0


class ChainRelaxation:
    """The pillar under its static forces: `dem.static.System` on the arrays of a state.

    Dashpots, also of quiet and matched ends, do not affect a static state and are omitted.
    """

    def __init__(self, scene: Scene, p: Properties, state: State, weighed: bool) -> None:
        p = undamped(p)
        start, end = (
            kind if kind == "fixed" else "free" for kind in (scene.ends.start, scene.ends.end)
        )
        dt = STEP_FRACTION * critical_chain_step(stiffest(scene, p), start, end)
        model = unloaded(scene, p, dt, (start, end))
        if not weighed:
            model = model._replace(chain=model.chain._replace(weight=0.0))
        self.model, self.chain, self.ends = model, model.chain, (start == "fixed", end == "fixed")
        self.state = state._replace(
            gap_rate=None, work=None, last_force=None, viscous=None, behind=None, dashpot_force=None
        )
        self.prestress = scene.prestress.normal * p.area if scene.prestress else 0.0
        self.properties, self.stiffness = p, p.stiffness * p.area
        self.mass = np.full(p.block_count, p.block_mass) if p.masses is None else p.masses
        self.scale = max(abs(self.chain.weight) * p.block_count, abs(self.prestress))
        self.most_steps = 10_000 + 1000 * p.block_count

    def advance(self, steps: int, alpha: float) -> None:
        """Take steps under mass-proportional damping alpha, 1/s."""
        march(with_mass_damping(self.model, alpha), self.state, 0, steps)

    def unbalanced(self) -> np.ndarray:
        """Return the net force on every block [N], N."""
        s, c, force = self.state, self.chain, np.empty(len(self.mass) + 1)
        force[0] = c.start_force + c.start.stiffness * s.start[0]
        force[-1] = c.end_force + c.end.stiffness * s.end[0]
        opening = s.u if s.opening is None else s.opening
        joint_forces = joint_forces_for(self.model.effects.joints)
        joint_forces(c.area, self.model.laws, s.u, opening, force)
        return force[:-1] - force[1:] + c.weight

    def displacement(self) -> np.ndarray:
        """Return the displacement of every block [N], m."""
        return self.state.u

    def stop(self) -> None:
        """Set all velocities to zero."""
        self.state.v[:] = 0.0

    def is_at_rest(self, tolerance: float) -> bool:
        """Return whether the state is in equilibrium."""
        return bool(np.abs(self.unbalanced()).max() <= tolerance * self.scale)

    def place(self, weight: float) -> None:
        """Set the displacements of elastic joints under this weight of each (N) and prestress.

        A fixed end does not move and turns the pillar's displacement into closure; between two
        free ends the displacement has zero mean.
        """
        s, forces = self.state, self.elastic_forces(weight)
        gaps = gaps_under(self.properties, forces[1:-1] / self.chain.area)
        u = np.append(0.0, np.cumsum(gaps))
        shift = -u.mean()
        if self.ends[0]:
            s.start[0] = forces[0] / self.chain.start.stiffness
            shift = -s.start[0]
        if self.ends[1]:
            s.end[0] = forces[-1] / self.chain.end.stiffness
            shift = s.end[0] - u[-1]
        s.u[:] = u + shift
        if s.opening is not None:
            s.opening[:] = np.maximum(gaps, 0.0)

    def elastic_forces(self, weight: float) -> np.ndarray:
        """Return the force of every contact [N + 1], N: all carry the prestress, and the weight
        goes to the fixed ends, between two of them as their springs share it."""
        steps = weight * np.arange(len(self.mass) + 1)
        start, end = self.chain.start.stiffness, self.chain.end.stiffness
        first = 0.0
        if all(self.ends):
            c = 1 / np.concatenate([[start], self.stiffness, [end]])
            first = -float(c @ steps) / float(c.sum())
        elif self.ends[0]:
            first = -steps[-1]
        return self.prestress + first + steps


@cache
def joint_forces_for(parts: Parts) -> Callable:
    """Return `spring_forces` for Python, of laws with these parts."""

    @jitted
    def joint_forces(area, laws, u, opening, force):
        """Set the forces of the joints, N."""
        spring_forces(parts, area, laws, u, opening, force)

    return joint_forces
