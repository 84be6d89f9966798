"""Initial state of a scene: unloaded, under its prestress, or in equilibrium with gravity."""

from collections.abc import Callable
from functools import cache

import numpy as np

from jointwave.cases.material.calibrate import Properties, calibrate
from jointwave.cases.schema.scene import Scene
from jointwave.dem.axial.build import unloaded, with_mass_damping
from jointwave.dem.axial.leapfrog import march
from jointwave.dem.axial.model import Chain, Model
from jointwave.dem.axial.springs import spring_forces
from jointwave.dem.axial.stability import critical_chain_step
from jointwave.dem.axial.state import State
from jointwave.dem.static import (
    STEP_FRACTION,
    Rest,
    fastest_of_row,
    gaps_under,
    held_ends,
    settle,
    stiffest,
    undamped,
)
from jointwave.joints.law import LawFlags
from jointwave.numerics.jit import jitted


def start(scene: Scene, model: Model, state: State) -> tuple[Model, Rest | None]:
    """Set the initial state of the scene; return its model, whose ends bear what rests on them, and
    how a static state was reached, if it is one.

    The exact elastic state under gravity and prestress is tried first. If a joint cannot carry
    it, the pillar is relaxed from its prestress. Raises SceneError if that does not converge.
    """
    gravity = scene.gravity
    static = gravity is not None and gravity.static
    rest, chain, p = None, model.chain, calibrate(scene)
    if static or scene.prestress is not None:
        system = ChainRelaxation(scene, p, state, static)
        system.place(system.chain.weight)
        if not system.is_at_rest(scene.numerics.dem.static_tolerance):
            system.place(0.0)
        rest = settle(scene, system)
        forget_steps(state)
        if static:
            chain = bearing(scene, chain, system.end_forces())
            for side, bears in zip((state.start, state.end), scene.bears, strict=True):
                side[0] = 0.0 if bears else side[0]  # what gives way counts from here
    if not static and model.effects.gravity:
        # Gravity from t = 0 on: the velocity at t = 0 is the mean of those half a step around it.
        if gravity is not None and any(scene.bears):
            standing = gravity.model_copy(update={"static": True})
            held = scene.model_copy(update={"gravity": standing})
            system = ChainRelaxation(held, p, state, True)
            chain = bearing(scene, chain, system.elastic_forces(chain.weight)[[0, -1]])
        net = np.full(state.v.size, chain.weight)
        net[0] += chain.start_force - model.chain.start_force
        net[-1] -= chain.end_force - model.chain.end_force
        state.v[:] = -0.5 * chain.dt * net / chain.mass
    return model._replace(chain=chain), rest


def bearing(scene: Scene, chain: Chain, forces: np.ndarray) -> Chain:
    """Return the chain with the forces [2] (N) of start and end where those bear its weight."""
    start, end = scene.bears
    return chain._replace(
        start_force=float(forces[0]) if start else chain.start_force,
        end_force=float(forces[1]) if end else chain.end_force,
    )


def forget_steps(state: State) -> None:
    """Set joints that broke during relaxation as broken from the first step."""
    if state.broke is not None:
        state.broke[state.broke >= 0] = 0


class ChainRelaxation:
    """The pillar under its static forces: `dem.static.System` on the arrays of a state.

    Dashpots do not affect a static state and are omitted; quiet and matched ends are held where
    they bear the weight.
    """

    def __init__(self, scene: Scene, p: Properties, state: State, weighed: bool) -> None:
        p = undamped(p)
        start, end = held_ends(scene)
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
        self.most_steps = 40_000 + 4000 * p.block_count

    def advance(self, steps: int, alpha: float) -> None:
        """Take steps under mass-proportional damping alpha, 1/s."""
        march(with_mass_damping(self.model, alpha), self.state, 0, steps)

    def unbalanced(self) -> np.ndarray:
        """Return the net force on every block [N], N."""
        s, c, force = self.state, self.chain, np.empty(len(self.mass) + 1)
        force[0], force[-1] = self.end_forces()
        opening = s.u if s.opening is None else s.opening
        joint_forces = joint_forces_for(self.model.effects.joints)
        joint_forces(c.area, self.model.laws, s.u, opening, force)
        return force[:-1] - force[1:] + c.weight

    def end_forces(self) -> np.ndarray:
        """Return the forces of the start and the end [2], N."""
        c, s = self.chain, self.state
        springs = c.start.stiffness * s.start[0], c.end.stiffness * s.end[0]
        return np.array([c.start_force + springs[0], c.end_force + springs[1]])

    def displacement(self) -> np.ndarray:
        """Return the displacement of every block [N], m."""
        return self.state.u

    def stop(self) -> None:
        """Set all velocities to zero."""
        self.state.v[:] = 0.0

    def fastest(self, change: np.ndarray) -> tuple[str, float]:
        """Return the block that moves farthest in a step, and how fast, m/s."""
        return fastest_of_row(self.properties, change[None], self.chain.dt)

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
def joint_forces_for(parts: LawFlags) -> Callable:
    """Return `spring_forces` for Python, of laws with these parts."""

    @jitted
    def joint_forces(area, laws, u, opening, force):
        """Set the forces of the joints, N."""
        spring_forces(parts, area, laws, u, opening, force)

    return joint_forces
