"""Static states: rock and joints at rest under gravity and around openings, by Newton's method.

The static forces are applied in increments, halved if they do not converge, because the state of
joints that slide, open or break depends on the path. Where that ends, as among joints that open and
bear on their edges, the rock creeps on under the whole forces: implicit steps against a drag, mass
times 1/s2, that falls until it is next to nothing. What stands stops (the proximal point method,
Rockafellar, SIAM J. Control Optim. 14, 1976); what does not moves on, however little holds it.

Quiet sides that bear the weight are held by springs far stiffer than the rock; what these carry at
rest goes on to act beside the dashpots, so that how stiff they are does not matter.

Rock that no side holds is at rest wherever it is put. What is excavated from it leaves forces that
cancel, with their moments; a mass matrix that is next to nothing beside the stiffness then makes
Newton's matrix regular and leaves the motion without a mean of the mass, as dynamic relaxation
does. The forces themselves know nothing of it.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.cases.errors import SceneError
from jointwave.cases.schema.rock_mass import RockMass
from jointwave.cases.schema.scene import Scene
from jointwave.continuum.implicit.balance import Matrices, implicit_matrices, trial_forces
from jointwave.continuum.implicit.newton import Outcome, newton
from jointwave.continuum.implicit.pattern import System
from jointwave.continuum.implicit.substeps import UNLOADED
from jointwave.continuum.model import Ends, Model
from jointwave.continuum.space.body import Body
from jointwave.continuum.space.tractions import NN, XX, ZZ
from jointwave.continuum.state import State
from jointwave.joints.law import IN_MOTION
from jointwave.results.arrays import copied, fill

TOLERANCE = 1e-10  # of the residual, over the largest summed force
LEAST_PART = 2.0**-4  # of the steady forces
CREEP = 1e-2  # the first drag, of the largest stiffness over mass, above all modes of joints
LAST_DIGITS = 8 * float(
    np.finfo(float).eps
)  # of the forces that displacements from the start would cause
MOST_LEFT = 1e-8  # of these, over the largest summed force
ROUGH = 1e-3  # residual of a step against a drag, over what the drag bears
EASED = 8.0  # by which the drag falls after a step, and rises after one that does not converge
MOST_CREEPS = 400  # steps against a drag
LEAST_DRAG = 1e-14  # above round-off
PATIENCE = 8  # of these without progress, and at least as many as led there: a stall
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
    still, largest = False, body.communicator.largest
    jointed = largest(float(model.interfaces is not None)) > 0  # of any process
    while not still:
        outcome = system.balance(min(done + part, 1.0))
        steps += len(outcome.errors) - 1
        if outcome.converged:
            # A point that slips loses its cohesion for what follows: balanced again without it.
            still = done >= 1 and outcome.errors[0] <= outcome.tolerance
            done = min(done + part, 1.0)
            still = still or (done == 1 and not jointed)
        elif part > LEAST_PART:
            part /= 2
        else:
            outcome, corrections = _creep(scene, system, done)
            steps, still = steps + corrections, True
    fill(state, system.state)
    memory = system.model.rock.memory
    if memory is not None and state.ledger is not None:
        state.ledger[0] += memory.energy(system.rock.stiffness, state.u, state.elongation)
    ratio = outcome.errors[-1] / (largest(system.size) or 1.0)
    return {"static_steps": steps, "static_out_of_balance": ratio}


def _creep(scene: Scene | RockMass, system: _Static, done: float) -> tuple[Outcome, int]:
    """Let the rock creep to rest under all of its forces; return the last step, which found it
    there, and the corrections made.

    Raises SceneError where rock moves farther than it is large, or the unbalanced forces stop
    falling: rock that goes on to move under them is loose, and where the steps do not converge it
    has not come to rest.
    """
    drag, least = CREEP * system.stiffest, LEAST_DRAG * system.stiffest
    corrections, largest = 0, system.rock.communicator.largest
    best, best_at, moves, far = np.inf, 0, 0, False
    size = largest(float(np.ptp(system.body.x, axis=0).max()))
    for k in range(MOST_CREEPS):
        outcome = system.balance(1.0, drag)
        corrections += len(outcome.errors) - 1
        unbalanced = outcome.errors[0]  # before the step, as nothing drags yet
        if outcome.converged and unbalanced <= largest(system.allowed):
            return outcome, corrections
        if unbalanced < 0.9 * best:
            best, best_at, moves = unbalanced, k, 0
        moves += outcome.converged
        far = largest(float(np.abs(system.state.u).max())) > size
        if far or k - best_at > max(PATIENCE, best_at):
            break
        drag *= EASED if not outcome.converged else 1 / EASED if drag > least else 1
    if far or moves > PATIENCE / 2:
        why = f"{system.fastest()}; it slides, tips or is unsupported"
        raise _refusal(scene, f"no static state beyond {done:.3g} of", why)
    ratio = f"an out-of-balance ratio of {best / largest(system.size):.1e}"
    why = f"{ratio} stays after {corrections} corrections"
    raise _refusal(scene, "has not come to rest under", why)


def _refusal(scene: Scene | RockMass, what: str, why: str) -> SceneError:
    """Return the refusal of a scene: `what` of its weight or excavation, and why."""
    key, of, remedy = "gravity", "the weight", "static = false starts without it"
    if scene.excavated and (scene.gravity is None or not scene.gravity.static):
        key, of, remedy = "prestress", "the excavation", "the joints around it cannot carry it"
    return SceneError(scene.where, key, None, f"{what} {of}: {why}: {remedy}")


def _stiffest(rock: Matrices) -> float:
    """Return the largest stiffness of a freedom over its mass, 1/s2."""
    k, m = rock.stiffness.diagonal()[rock.moves], rock.mass.diagonal()[rock.moves]
    return rock.communicator.largest(float((k[m > 0] / m[m > 0]).max()))


def _holds(body: Body, fixed: np.ndarray) -> bool:
    """Return whether fixed freedoms hold a body in every direction."""
    nodes, somewhere = np.arange(len(body.x)), body.communicator.any
    along = range(body.section.components)
    return all([somewhere(bool(np.isin(body.freedom(nodes, c), fixed).any())) for c in along])


class _Static:
    """The forces of a model at rest, without what absorbs at its ends and without its load.

    state : the last one in balance. size : the largest force that is summed up, N. stiffest : the
    largest stiffness over mass, 1/s2. acceleration : of the free freedoms in the last step, m/s2.
    allowed : what may be left, N: of the forces, and the round-off of those of whole displacements.
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
        self.body, self.stiffest = body, _stiffest(self.rock)
        self.carries, self.allowed = self.rock.stiffness.diagonal(), 0.0
        if hold is not None:
            self.carries = self.carries + hold.diagonal()
        fixed = np.zeros(0, dtype=int) if model.ends.fixed is None else model.ends.fixed.freedom
        if hold is not None:
            stiffness = stiffness + hold
        elif not _holds(body, fixed):
            stiffness = stiffness + LOOSE * self.stiffest * self.rock.mass
        self.system = System(model, self.rock, fixed, [stiffness, self.rock.mass])
        self.acceleration = np.zeros(self.system.free.size)

    def balance(self, share: float, drag: float = 0.0) -> Outcome:
        """Try to balance a share of the weight against a drag (1/s2) on what moves from the state
        before; what comes of it is kept where that succeeds."""
        model = self.model._replace(weight=share * self.model.weight)
        system, communicator = self.system, self.rock.communicator
        set_forces = trial_forces(model, self.rock, self.state, self.trial, system.tangents)
        before = self.state.u.copy()

        def dragged() -> np.ndarray:
            share = drag * (self.rock.mass @ (self.trial.u - before))
            return communicator.total(share)[system.free]

        def residual(u: np.ndarray) -> tuple[np.ndarray, float]:
            self.trial.u[system.free] = u
            self.size, force = set_forces(UNLOADED), self.trial.force
            if self.hold is not None:
                force = force - self.hold @ self.trial.u
            force, borne = communicator.total(force)[system.free], dragged()
            carried = float((self.carries * np.abs(self.trial.u)).max())
            digits = min(LAST_DIGITS * carried, MOST_LEFT * self.size)
            self.allowed = TOLERANCE * self.size + digits
            return force - borne, max(self.allowed, ROUGH * float(np.abs(borne).max(initial=0.0)))

        def correction(rest: np.ndarray) -> np.ndarray:
            if not self.trial.u.any():
                self.stick_joints()
            rock, mass = system.pattern.fixed
            system.factorise(system.with_joints(rock + drag * mass))
            return system.solve(rest)

        outcome = newton(residual, correction, self.state.u[system.free], communicator)
        if outcome.converged:
            self.acceleration = drag * (self.trial.u - before)[system.free]
            self.trial.v_before[:] = 0.0
            fill(self.state, self.trial)
        return outcome

    def fastest(self) -> str:
        """Return where the rock has moved farthest in the last step, in words, with the
        acceleration that the forces borne by the drag would give it."""
        body, free = self.body, self.system.free
        k = int(np.abs(self.acceleration).argmax())
        components = np.arange(body.section.components)
        nodes = np.arange(len(body.x))[:, None]
        node = np.flatnonzero((body.freedom(nodes, components) == free[k]).any(axis=1))[0]
        place = ", ".join(f"{x:.4g}" for x in body.x[node].round(6) + 0.0)
        most = float(np.abs(self.acceleration[k]))
        words = f"the rock at [{place}] moves on, at {most:.3g} m/s2"
        return self.rock.communicator.of_largest(most, words)

    def stick_joints(self) -> None:
        """Give all joints their elastic stiffness: one that nothing presses has no friction, and
        rock at rest on such joints could be anywhere."""
        joints, tangents = self.model.interfaces, self.system.tangents
        if joints is not None:
            tangents[NN] = joints.area * joints.law.normal_stiffness
            shear = joints.law.shear_stiffness
            tangents[[XX, ZZ]] = 0.0 if shear is None else joints.area * shear
