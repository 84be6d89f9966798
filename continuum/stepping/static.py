"""Static states: rock and joints at rest under gravity and around openings, by Newton's method.

Forces are applied in increments, halved if they do not converge, because the state of joints that
slide, open or break depends on the path. If the smallest increments fail, as among joints that open
and bear on their edges, the rock creeps under the full forces against a drag, mass times 1/s2, that
falls to almost zero (the proximal point method; Rockafellar, SIAM J. Control Optim. 14, 1976). It
stops if a static state exists.

Quiet sides that bear the weight are held by springs far stiffer than the rock. For rock that no
side holds, a tiny multiple of the mass matrix regularises Newton's matrix, not the residual.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, diags

from jointwave.cases.errors import SceneError, placed
from jointwave.cases.scene_type import AnyScene
from jointwave.continuum.stepping.balance import LAST_DIGITS, Balance
from jointwave.continuum.stepping.newton import Outcome, newton
from jointwave.continuum.stepping.problem import NO_DASHPOTS, Problem
from jointwave.joints.law import IN_MOTION, Law

TOLERANCE = 1e-10  # of the residual, over the largest summed force
LEAST_PART = 2.0**-4  # smallest increment, over the steady forces
CREEP = 1e-2  # first drag, over the largest stiffness per mass: above all modes of joints
MOST_LEFT = 1e-8  # most residual due to round-off of displacements, over the largest summed force
ROUGH = 1e-3  # residual of a step over the force of its drag, or of round-off over all forces
EASED = 8.0  # factor by which the drag falls after a step, or rises if one does not converge
MOST_CREEPS = 400  # steps against a drag
LEAST_DRAG = 1e-14  # as CREEP; above round-off
PATIENCE = 8  # steps without progress, and at least as many as led there, that are a stall
LOOSE = 1e-10  # stiffness per mass that holds loose rock, over the largest one
STIFF = 1e3  # stiffness that holds sides that bear the weight, over the largest one


class Rest(NamedTuple):
    """A static state: u [freedoms], m; history of points; steps, number of corrections; ratio of
    the largest unbalanced force to the largest summed force."""

    u: np.ndarray
    history: np.ndarray
    steps: int
    ratio: float


def holding(problem: Problem, borne: csr_matrix | None) -> csr_matrix | None:
    """Return the springs [freedoms, freedoms], N/m, that hold sides which bear the weight; None
    without. borne : their areas."""
    if borne is None:
        return None
    stiffest = float(problem.body.stiffness.diagonal().max())
    return csr_matrix(STIFF * stiffest / float(borne.diagonal().max()) * borne)


def elastic_rest(problem: Problem, weight: np.ndarray, hold: csr_matrix | None) -> np.ndarray:
    """Return the static displacements [freedoms], m, under a weight (N) with sticking joints."""
    own, u = _Static(problem, hold), np.zeros_like(weight)
    free = own.balance.free
    u[free] = own.balance.factors(own.matrix + own.sticking).solve(weight[free])
    return u


def settled(scene: AnyScene, problem: Problem, hold: csr_matrix | None = None) -> Rest:
    """Return the static state under the steady forces of a problem; raises SceneError if there is
    none. hold : springs of `holding`."""
    own, done, part, steps, still = _Static(problem, hold), 0.0, 1.0, 0, False
    while not still:
        outcome = own.settle(min(done + part, 1.0))
        steps += len(outcome.errors) - 1
        if outcome.converged:
            # A point that slips loses its cohesion only afterwards: balance again without it.
            still = done >= 1 and outcome.errors[0] <= outcome.tolerance
            done = min(done + part, 1.0)
            still = still or (done == 1 and problem.parts is None)
        elif outcome.errors[-1] <= min(own.digits, ROUGH * own.size):
            ratio = f"an out-of-balance ratio of {outcome.errors[-1] / own.size:.1e}"
            why = f"round-off of displacements leaves {ratio}; rock is far stiffer than joints"
            raise _refusal(scene, "has not come to rest under", why)
        elif part > LEAST_PART:
            part /= 2
        else:
            outcome, corrections = _creep(scene, own, done)
            steps, still = steps + corrections, True
    return Rest(own.u, own.past.history, steps, outcome.errors[-1] / (own.size or 1.0))


def _creep(scene: AnyScene, own: "_Static", done: float) -> tuple[Outcome, int]:
    """Let the rock creep to rest under its full forces; return the last outcome, and corrections.

    Raises SceneError if rock moves farther than its size, or the unbalanced forces stop falling.
    """
    drag, least, corrections = CREEP * own.stiffest, LEAST_DRAG * own.stiffest, 0
    best, best_at, moves, far = np.inf, 0, 0, False
    size = float(np.ptp(own.problem.body.x, axis=0).max())
    for k in range(MOST_CREEPS):
        outcome = own.settle(1.0, drag)
        corrections += len(outcome.errors) - 1
        unbalanced = outcome.errors[0]  # before the step, where the drag is zero
        if outcome.converged and unbalanced <= own.allowed:
            return outcome, corrections
        if unbalanced < 0.9 * best:
            best, best_at, moves = unbalanced, k, 0
        moves += outcome.converged
        far = float(np.abs(own.u).max()) > size
        if far or k - best_at > max(PATIENCE, best_at):
            break
        drag *= EASED if not outcome.converged else 1 / EASED if drag > least else 1
    if far or moves > PATIENCE / 2:
        why = f"{own.fastest()}; it slides, tips or is unsupported"
        carried = f"beyond {done:.3g} of" if done else "under"
        raise _refusal(scene, f"no static state {carried}", why)
    why = f"an out-of-balance ratio of {best / own.size:.1e} stays after {corrections} corrections"
    raise _refusal(scene, "has not come to rest under", why)


def _refusal(scene: AnyScene, what: str, why: str) -> SceneError:
    """Return the error of a scene: `what` about its weight or excavation, and why."""
    key, of, remedy = "gravity", "the weight", "static = false starts without it"
    if scene.excavated and (scene.gravity is None or not scene.gravity.static):
        key, of, remedy = "prestress", "the excavation", "the joints around it cannot carry it"
    return SceneError(scene.where, key, None, f"{what} {of}: {why}: {remedy}")


def _at_rest(problem: Problem) -> Problem:
    """Return a problem with relaxed rock and without dashpots."""
    law, relaxes, none = problem.law, problem.mechanisms, csr_matrix(problem.body.damping.shape)
    body = problem.body._replace(damping=none)
    if relaxes is not None:
        body = body._replace(stiffness=csr_matrix(relaxes.relaxed * body.stiffness))
    if law is not None:
        names = (Law._fields[row] for row in IN_MOTION)
        still = {name: 0.0 * value for name in names if (value := getattr(law, name)) is not None}
        law = law._replace(**still)
    return problem._replace(body=body, law=law, mechanisms=None, alpha=0.0, quiet=NO_DASHPOTS)


class _Static:
    """The static forces of a problem, without dashpots and loads.

    u, past : the last state in balance. size : the largest summed force, N. stiffest : the largest
    stiffness per mass, 1/s2. digits : residual that round-off leaves, N. allowed : tolerance of the
    residual, N. moved : displacement times
    drag in the last step, m/s2.
    """

    def __init__(self, problem: Problem, hold: csr_matrix | None) -> None:
        problem = _at_rest(problem)
        self.problem, self.balance, self.hold = problem, Balance(problem), hold
        own, dim, law = self.balance, problem.body.components, problem.law
        k, self.sticking = own.stiffness.diagonal(), csr_matrix(own.stiffness.shape)
        if law is not None:
            self.sticking = problem.of_joints(law.normal_stiffness, law.shear_stiffness)
        self.stiffest = float((k / own.mass).max())
        self.size, self.digits, self.allowed = 0.0, 0.0, 0.0
        self.u, self.past = np.zeros_like(k), own.past
        self.matrix, self.carries = own.stiffness, k
        if hold is not None:
            self.matrix, self.carries = csr_matrix(self.matrix + hold), k + hold.diagonal()
        elif np.unique(problem.held.freedom % dim).size < dim:
            self.matrix = csr_matrix(self.matrix + LOOSE * self.stiffest * diags(own.mass))
        self.moved = np.zeros_like(k)

    def settle(self, share: float, drag: float = 0.0) -> Outcome:
        """Try to balance a share of the steady forces, with a drag (1/s2) on displacements from the
        last state, and keep the new state if this converges."""
        own, free, still = self.balance, self.balance.free, np.zeros_like(self.u)
        trial, after = self.u.copy(), self.past

        def residual(u: np.ndarray) -> tuple[np.ndarray, float]:
            nonlocal after
            trial[free] = u
            found = own.forces(trial, still, trial - self.u, 1.0, self.past, still, share)
            most = float(np.abs(found.loads).max(initial=0.0))
            self.size = max(float(found.size[0]), most, own.carried)
            after, force = found.past, found.whole
            if self.hold is not None:
                force = force - self.hold @ trial
            borne = drag * own.mass * (trial - self.u)
            self.digits = LAST_DIGITS * float((self.carries * np.abs(trial)).max(initial=0.0))
            self.allowed = TOLERANCE * self.size + min(self.digits, MOST_LEFT * self.size)
            left = max(self.allowed, ROUGH * float(np.abs(borne).max(initial=0.0)))
            return (force - borne)[free], left

        def correction(rest: np.ndarray) -> np.ndarray:
            matrix = self.matrix + drag * diags(own.mass)
            if not trial.any() and own.steady[free].any():
                # First without opening or sliding, which leads to the static state if one exists.
                return own.factors(matrix + self.sticking).solve(share * own.steady[free])
            tangents = own.of_joints(trial, still, 1.0, 0.0, self.past.history)
            return own.factors(matrix, tangents).solve(rest)

        outcome = newton(residual, correction, self.u[free])
        if outcome.converged:
            self.moved = drag * (trial - self.u)
            self.u, self.past = trial, after
        return outcome

    def fastest(self) -> str:
        """Return in words where the rock moved farthest in the last step, and the acceleration that
        it would have without the drag."""
        k, body = int(np.abs(self.moved).argmax()), self.problem.body
        place = placed(body.x[k // body.components].round(6) + 0.0, 4)
        return f"the rock at {place} moves on, at {np.abs(self.moved[k]):.3g} m/s2"
