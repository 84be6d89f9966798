"""Implicit steps of a body: the generalised-alpha method, with Newton's method in each step.

Displacement u, velocity v and acceleration a advance by Newmark's formulas,

    u' = u + dt v + dt^2 ((1/2 - beta) a + beta a'),   v' = v + dt ((1 - gamma) a + gamma a'),

and the equation of motion holds within the step, with the sum F of all forces (J. Chung &
G. M. Hulbert, J. Appl. Mech. 60, 1993, 371-375):

    M ((1 - alpha_m) a' + alpha_m a) = (1 - alpha_f) F' + alpha_f F.

A step that does not converge is halved.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import diags

from jointwave.cases.errors import StoppedError
from jointwave.continuum.stepping.arrays import BOUNDARY, FRICTION, VISCOUS, WORK, samples_for
from jointwave.continuum.stepping.balance import LAST_DIGITS, Balance, Forces
from jointwave.continuum.stepping.newton import Factors, newton
from jointwave.continuum.stepping.problem import Held, Problem
from jointwave.results.arrays import copied, fill, size_of

HALVINGS = 10
RESIDUAL = 1e-10  # tolerance over the largest summed force


class Scheme(NamedTuple):
    """The constants of the method; alpha_m and alpha_f are weights of the start of the step."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float


def scheme(rho: float) -> Scheme:
    """Return the second-order, unconditionally stable scheme with spectral radius `rho`, 0 .. 1, at
    infinite frequency; 1 is the trapezoidal rule."""
    alpha_m, alpha_f = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    share = 1 - alpha_m + alpha_f
    return Scheme(alpha_m, alpha_f, share**2 / 4, share - 0.5)


class Moment(NamedTuple):
    """A state and its forces: u, m; v, m/s; a, m/s2 [freedoms]. sums : of the ledger, J."""

    u: np.ndarray
    v: np.ndarray
    a: np.ndarray
    forces: Forces
    sums: np.ndarray


class Implicit:
    """Implicit steps of a problem.

    now : the state at the last step. samples : recorded ones. counts : iterations, factorisations
    and halvings. work_of_a_step : approximately, over that of an explicit step.
    """

    work_of_a_step = 100

    def __init__(
        self, problem: Problem, dt: float, samples: int, rho: float, energy: bool = True
    ) -> None:
        self.problem, self.dt, self.rho, self.scheme = problem, dt, rho, scheme(rho)
        self.balance, self.counts = Balance(problem), np.zeros(3, np.int64)
        self.samples = samples_for(problem.readings, samples, energy)
        own, (u, v, a, none) = self.balance, np.zeros((4, problem.body.mass.size))
        forces = own.forces(u, v, u, dt, own.past, none)
        self.now = Moment(u, v, a, copied(forces), np.zeros(4))
        self._factors: tuple[float, np.ndarray, Factors] | None = None
        self._weighs, self._motion = problem.stiffness.diagonal(), np.zeros((3, 1, 0))

    @property
    def u(self) -> np.ndarray:
        """Displacement, m."""
        return self.now.u

    @property
    def v(self) -> np.ndarray:
        """Velocity, m/s."""
        return self.now.v

    @property
    def last(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Displacement, m, and velocity, m/s, at the last step, and the displacement at which
        elastic rock would have the same stress, m."""
        elongation = self.now.forces.past.elongation
        return self.u, self.v, self.balance.memory(self.dt).strained(self.u, elongation)

    @property
    def parts(self) -> tuple:
        """All arrays that change."""
        return self.now, self.counts

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of a result."""
        names = "newton_iterations", "factorisations", "halved_steps"
        counts = dict(zip(names, self.counts.tolist(), strict=True))
        return {"spectral_radius": self.rho, **counts}

    @property
    def bytes(self) -> int:
        """Bytes of matrices, without their factors, and state."""
        own = self.balance
        every = own.stiffness, own.damping, own.quiet, own.jumps
        return size_of(self.now, own.points, *((m.data, m.indices, m.indptr) for m in every))

    def start(self, u: np.ndarray, history: np.ndarray) -> None:
        """Start at rest at displacements u (m) with the history of points."""
        now, own = self.now, self.balance
        now.u[:] = u
        now.forces.past.history[:] = history
        memory = own.memory(self.dt)
        if memory.share.size:
            now.sums[VISCOUS] = memory.energy(own.stiffness, u, own.past.elongation)

    def take(self, first: int, last: int, stride: int) -> None:
        """Advance to the steps first .. last - 1, with a sample at each multiple of `stride`."""
        self._motion = motion_of(self.problem.held, last + 1, self.dt)
        for n in range(first, last):
            if n == 0:
                self._begin()
            else:
                self._advance(n - 1, 0.0, 1.0, stride)
            if n % stride == 0:
                self._record(n // stride)

    def _begin(self) -> None:
        """Set the acceleration at t = 0 from the forces."""
        now, own = self.now, self.balance
        self._move_held(now, 0, 0.0)
        past, external = copied(now.forces.past), self._external(0, 0.0)
        forces = own.forces(now.u, now.v, 0 * now.u, self.dt, past, external)
        now.a[own.free] = (forces.whole / own.mass)[own.free]
        fill(now.forces, forces)

    def _advance(self, n: int, begin: float, end: float, stride: int) -> None:
        """Advance from one fraction of step n to another, in halves if that does not converge."""
        if self._step(n, begin, end):
            return
        self.counts[2] += 1
        if end - begin <= 2.0**-HALVINGS:
            error = StoppedError(
                f"the implicit steps do not converge at t = {(n + begin) * self.dt:.6g} s even "
                f"with steps of {(end - begin) * self.dt:.3g} s; take shorter ones "
                "(numerics.continuum.steps_per_period) or explicit ones"
            )
            error.samples = n // stride + 1
            raise error
        middle = (begin + end) / 2
        self._advance(n, begin, middle, stride)
        self._advance(n, middle, end, stride)

    def _step(self, n: int, begin: float, end: float) -> bool:
        """Try a step, and keep its result if it converges; return whether it does."""
        alpha_m, alpha_f, beta, gamma = self.scheme
        own, now, dt = self.balance, self.now, (end - begin) * self.dt
        trial, external = copied(now), self._external(n, end)
        self._move_held(trial, n, end)
        drift = dt * now.v + (0.5 - beta) * dt**2 * now.a
        before = alpha_f * now.forces.whole - alpha_m * (own.mass * now.a)
        forces, r, free = [now.forces], gamma / (beta * dt), own.free

        def residual(moved: np.ndarray) -> tuple[np.ndarray, float]:
            trial.a[free] = (moved - drift[free]) / (beta * dt**2)
            trial.u[free] = now.u[free] + moved
            trial.v[free] = now.v[free] + dt * ((1 - gamma) * now.a + gamma * trial.a)[free]
            forces[0] = own.forces(trial.u, trial.v, trial.u - now.u, dt, now.forces.past, external)
            inertia = own.mass * trial.a
            rest = (1 - alpha_f) * forces[0].whole + before - (1 - alpha_m) * inertia
            size = max(forces[0].size[0], now.forces.size[0], np.abs(inertia).max(initial=0.0))
            weighs = np.abs(self._weighs * trial.u).max(initial=0.0) + self.balance.carried
            return rest[free], RESIDUAL * size + LAST_DIGITS * weighs

        def correction(rest: np.ndarray) -> np.ndarray:
            self.counts[0] += 1
            history = now.forces.past.history
            tangents = own.of_joints(trial.u, trial.v, dt, r, history)
            return self._factored(dt, r, tangents).solve(rest)

        outcome = newton(residual, correction, (drift + beta * dt**2 * now.a)[free])
        if outcome.converged:
            self._add_work(trial, forces[0])
            fill(now, trial._replace(forces=forces[0]))
        return outcome.converged

    def _factored(self, dt: float, r: float, tangents: np.ndarray) -> Factors:
        """Return the factors of a step's matrix, the last ones if nothing has changed."""
        if self._factors is not None:
            last, known, factors = self._factors
            if last == dt and np.array_equal(known, tangents):
                return factors
        alpha_m, alpha_f, beta, _ = self.scheme
        own, share = self.balance, 1 - alpha_f
        inertia = (1 - alpha_m) / (beta * dt**2) * diags(own.mass)
        found = own.factors(inertia + share * own.resistance(dt, r), share * tangents)
        self._factors = dt, tangents, found
        self.counts[1] += 1
        return found

    def _add_work(self, trial: Moment, forces: Forces) -> None:
        """Add the work of all forces over a step to the ledger, by the trapezoidal rule."""
        now, sums, held = self.now, trial.sums, self.problem.held.freedom
        moved = trial.u - now.u
        sums[VISCOUS] += (now.forces.viscous + forces.viscous) @ moved / 2
        sums[BOUNDARY] += (now.forces.boundary + forces.boundary) @ moved / 2
        sums[WORK] += (now.forces.external + forces.external) @ moved / 2
        sums[FRICTION] += forces.energies[2]
        if held.size:
            gained = (self.balance.mass * (trial.v - now.v))[held] @ (now.v + trial.v)[held]
            sums[WORK] += (gained - (now.forces.whole + forces.whole)[held] @ moved[held]) / 2

    def _external(self, n: int, share: float) -> np.ndarray:
        """Return the forces with a history at step n plus a fraction of the step."""
        found, forces = np.zeros(self.balance.mass.size), self.problem.forces
        if forces is not None:
            first, last = forces.at(n, n + 2)
            found[forces.freedom] = (1 - share) * first + share * last
        return found

    def _move_held(self, moment: Moment, n: int, share: float) -> None:
        """Set the motion of held freedoms at step n plus a fraction of the step."""
        held = self.problem.held
        if held.moved is not None:
            given = (1 - share) * self._motion[:, n] + share * self._motion[:, n + 1]
            for values, value in zip(moment[:3], given, strict=True):
                values[held.freedom] = held.direction @ value

    def _record(self, s: int) -> None:
        """Record sample s."""
        now, read, out = self.now, self.problem.readings, self.samples
        forces = now.forces
        out.velocity[:, s] = read.motion @ now.v
        out.displacement[:, s] = read.motion @ now.u
        out.stress[:, s] = read.stress @ self.last[2] + read.constant + read.viscous @ now.v
        if read.inertia is not None:
            balancing = forces.whole / self.balance.mass
            held = self.problem.held.freedom
            balancing[held] = now.a[held]
            out.stress[:, s] += read.inertia @ (balancing + self.problem.alpha * now.v)
        out.traction[:, s] = read.traction @ forces.loads + read.carried
        out.jump[:, s] = read.jump @ forces.jump
        if out.energy.size:
            viscous, friction, boundary, work = now.sums
            joints, spent, _ = forces.energies
            memory = self.balance.memory(self.dt)
            rock = memory.energy(self.balance.stiffness, now.u, forces.past.elongation)
            if memory.share.size:
                viscous -= rock
            kinetic = 0.5 * (now.v @ (self.balance.mass * now.v))
            fallen = self.balance.steady @ now.u
            terms = kinetic, rock + joints, viscous, friction, spent, boundary, -fallen, work
            out.energy[:, s] = terms


def motion_of(held: Held, count: int, dt: float) -> np.ndarray:
    """Return displacement, velocity and acceleration of held freedoms at `count` steps [3, count,
    motions]: sums of the given moves and their centred differences, at rest before t = 0."""
    if held.moved is None:
        return np.zeros((3, count, 0))
    after = held.moved(np.arange(count))
    before = np.concatenate([np.zeros_like(after[:1]), after[:-1]])
    return np.array([before.cumsum(axis=0), (before + after) / (2 * dt), (after - before) / dt**2])
