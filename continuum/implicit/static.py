"""Static states: rock and joints at rest under gravity and around openings, by Newton's method.

The static forces are applied in increments, halved if they do not converge, because the state of
joints that slide, open or break depends on the path.

Quiet sides that bear the weight are held by springs far stiffer than the rock; what these carry at
rest goes on to act beside the dashpots, so that how stiff they are does not matter.

Rock that no side holds is at rest wherever it is put. What is excavated from it leaves forces that
cancel, with their moments; a mass matrix that is next to nothing beside the stiffness then makes
Newton's matrix regular and leaves the motion without a mean of the mass, as dynamic relaxation
does. The forces themselves know nothing of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cases.errors import SceneError
from continuum.implicit.balance import Matrices, implicit_matrices, trial_forces
from continuum.implicit.newton import Outcome, newton
from continuum.implicit.pattern import System
from continuum.implicit.substeps import UNLOADED
from continuum.model import Ends, Model
from continuum.space.body import Body
from continuum.space.tractions import NN, XX, ZZ
from continuum.state import State
from joints.law import IN_MOTION
from results.arrays import copied, fill

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

    from cases.schema.rock_mass import RockMass
    from cases.schema.scene import Scene

TOLERANCE = 1e-10  # of the residual, over the largest summed force
LEAST_PART = 2.0**-10  # of the steady forces
#: Of the largest stiffness over mass: what holds loose rock. Far below its slowest mode, by 1e-3
#: and less, and far above the round-off of the largest.
LOOSE = 1e-10
#: Of the largest stiffness: what holds sides that bear the weight. Far more would be round-off.
STIFF = 1e3


def holding(body: Body, borne: csr_matrix | None) -> csr_matrix | None:
    """Return the springs (N/m) that hold the areas [freedoms, freedoms] of sides that bear the
    weight; None without."""
    if borne is None:
        return None
    largest = body.communicator.largest
    rock = largest(float(implicit_matrices(body).stiffness.diagonal().max()))
    return STIFF * rock / largest(float(borne.diagonal().max(initial=0.0))) * borne


def elastic_rest(
    model: Model, state: State, body: Body, weight: np.ndarray, hold: csr_matrix
) -> np.ndarray:
    """Return the displacements [n] (m) at rest under a weight (N) where no joint opens or slips."""
    system = _Static(model, state, body, hold)
    system.stick_joints()
    equations, u = system.system, np.zeros_like(weight)
    equations.factorise(equations.with_joints(equations.pattern.fixed[0]))
    u[equations.free] = equations.solve(body.communicator.total(weight)[equations.free])
    return u


def settle_static(
    scene: Scene | RockMass,
    model: Model,
    state: State,
    body: Body,
    hold: csr_matrix | None = None,
) -> dict[str, float]:
    """Bring a state to rest under the steady forces of its model, on springs `holding`; raises
    SceneError where there is no static state.

    Returns what a result says of it: how many corrections were made, and the largest unbalanced
    force over the largest force at work.
    """
    system = _Static(model, state, body, hold)
    done, part, steps = 0.0, 1.0, 0
    still = False
    while not still:
        outcome = system.balance(min(done + part, 1.0))
        steps += len(outcome.errors) - 1
        if outcome.converged:
            # A point that slips loses its cohesion for what follows: balanced again without it.
            still = done >= 1 and outcome.errors[0] <= outcome.tolerance
            done = min(done + part, 1.0)
        elif part > LEAST_PART:
            part /= 2
        else:
            _refuse(scene, done)
    fill(state, system.state)
    memory = system.model.rock.memory
    if memory is not None and state.ledger is not None:
        state.ledger[0] += memory.energy(system.rock.stiffness, state.u, state.elongation)
    ratio = outcome.errors[-1] / (body.communicator.largest(system.size) or 1.0)
    return {"static_steps": steps, "static_out_of_balance": ratio}


def _refuse(scene: Scene | RockMass, done: float) -> None:
    key, what, remedy = "gravity", "the weight", "static = false starts without it"
    if scene.excavated and (scene.gravity is None or not scene.gravity.static):
        key, what, remedy = "prestress", "the excavation", "the joints around it cannot carry it"
    raise SceneError(
        scene.where,
        key,
        None,
        f"no static state beyond {done:.3g} of {what}: a joint slides or opens, or a block is "
        f"unsupported: {remedy}",
    )


def _hold(stiffness: csr_matrix, rock: Matrices) -> csr_matrix:
    """Return what holds loose rock, N/m."""
    k, m = stiffness.diagonal()[rock.moves], rock.mass.diagonal()[rock.moves]
    return LOOSE * rock.communicator.largest(float((k[m > 0] / m[m > 0]).max())) * rock.mass


class _Static:
    """The forces of a model at rest, without what absorbs at its ends and without its load.

    state : the last one in balance. size : the largest force that is summed up, N.
    """

    def __init__(
        self, model: Model, state: State, body: Body, hold: csr_matrix | None = None
    ) -> None:
        self.rock, self.hold = implicit_matrices(body), hold
        self.model = model._replace(ends=Ends(None, None, model.ends.fixed))
        if model.interfaces is not None:
            table = model.interfaces.table.copy()
            table[IN_MOTION] = 0.0
            self.model = self.model._replace(interfaces=model.interfaces._replace(table=table))
        stiffness, memory = self.rock.stiffness, model.rock.memory
        if memory is not None:
            self.model = self.model._replace(rock=model.rock._replace(memory=memory.at_rest()))
            stiffness = memory.relaxed * stiffness
        self.state, self.trial, self.size = copied(state), copied(state), 0.0
        fixed = np.zeros(0, dtype=int) if model.ends.fixed is None else model.ends.fixed.freedom
        if hold is not None:
            stiffness = stiffness + hold
        elif model.ends.fixed is None:
            stiffness = stiffness + _hold(stiffness, self.rock)
        self.system = System(model, self.rock, fixed, [stiffness])

    def balance(self, share: float) -> Outcome:
        """Try to balance a share of the weight; what comes of it is kept where that succeeds."""
        model = self.model._replace(weight=share * self.model.weight)
        system, communicator = self.system, self.rock.communicator
        set_forces = trial_forces(model, self.rock, self.state, self.trial, system.tangents)

        def residual(u: np.ndarray) -> tuple[np.ndarray, float]:
            self.trial.u[system.free] = u
            self.size, force = set_forces(UNLOADED), self.trial.force
            if self.hold is not None:
                force = force - self.hold @ self.trial.u
            return communicator.total(force)[system.free], TOLERANCE * self.size

        def correction(rest: np.ndarray) -> np.ndarray:
            if not self.trial.u.any():
                self.stick_joints()
            system.factorise(system.with_joints(system.pattern.fixed[0]))
            return system.solve(rest)

        outcome = newton(residual, correction, self.state.u[system.free], communicator)
        if outcome.converged:
            self.trial.v_before[:] = 0.0
            fill(self.state, self.trial)
        return outcome

    def stick_joints(self) -> None:
        """Give all joints their elastic stiffness: one that nothing presses has no friction, and
        rock at rest on such joints could be anywhere."""
        joints, tangents = self.model.interfaces, self.system.tangents
        if joints is not None:
            tangents[NN] = joints.area * joints.law.normal_stiffness
            shear = joints.law.shear_stiffness
            tangents[[XX, ZZ]] = 0.0 if shear is None else joints.area * shear
