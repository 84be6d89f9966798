"""Implicit runs of jointed rock: time steps, and the subdivision of those that do not converge.

Such a step is taken in halves, down to a 1024th of the whole; halves that are done make way for
longer ones again, so that whole steps end on the clock.
"""

from collections.abc import Callable

import numpy as np

from jointwave.cases.errors import StoppedError
from jointwave.continuum.explicit.march import readings
from jointwave.continuum.implicit.balance import Matrices
from jointwave.continuum.implicit.newton import Outcome
from jointwave.continuum.implicit.record import recorder
from jointwave.continuum.implicit.step import Stepper
from jointwave.continuum.implicit.substeps import Applied, applied_at, move
from jointwave.continuum.model import Model
from jointwave.continuum.monitor import Monitor
from jointwave.continuum.state import Samples, State
from jointwave.results.arrays import arrays, changed, copied, fill

HALVINGS = 10
WHOLE = 1 << HALVINGS


class Implicit:
    """A run by implicit steps.

    Parameters
    ----------
    model, state : constants and initial state, as for explicit steps. The state follows the run,
        at whole steps: v_before equals v, `force` is the sum of all forces.
    samples : what is recorded. matrices : of the rock, as `model.rock` has them.
    rho : spectral radius, 0 .. 1.

    Attributes
    ----------
    stepper : counts iterations and factorisations. outcome : of the last step or part of one.
    counts : int array [2], how many steps were halved, and the last whole step that was done, -1
        none. parts : all arrays that change beside the state.
    """

    def __init__(
        self, model: Model, state: State, samples: Samples, matrices: Matrices, rho: float
    ) -> None:
        self.stepper, self.state, self.model = Stepper(model, state, matrices, rho), state, model
        self.now, self.trial = self.stepper.now, self.stepper.trial
        self.communicator = matrices.communicator
        mass = self.communicator.total(model.rock.mass)
        self.mass = np.where(mass > 0, mass, np.inf)  # massless freedoms do not move
        self.counts = np.array([0, -1])
        self._balancing, self._samples = np.zeros_like(state.u), samples
        self._sample = self._recorder(state, samples)
        self._pairs = list(zip(arrays(self.now), arrays(self.trial), strict=True))
        self.outcome: Outcome | None = None
        self.parts = self.now[1:], self.trial, self.counts, self.stepper.counts

    @property
    def halvings(self) -> int:
        """How many steps were halved."""
        return int(self.counts[0])

    def run(self, stride: int, first: int, last: int, monitor: Monitor | None = None) -> None:
        """Go from step first - 1 to each of first .. last - 1, and take a sample at every step that
        `stride` divides. Raises StoppedError where a step does not converge; ends where the
        monitor finds the run out of bounds."""
        for n in range(first, last):
            if n == 0:
                self._begin()
            else:
                self._reach(n, stride)
            self.counts[1] = n
            if n % stride == 0:
                self._record(n // stride)
            if monitor is not None and monitor.finds(n):
                break

    def compile(self) -> None:
        """Compile the kernels of the run, and change nothing."""
        spare, one = copied(self.state), changed(self._samples, lambda rows: rows[:, :1].copy())
        with self.communicator.in_turn():
            self.stepper.forces_of(spare)(applied_at(self.model, 0, 0.0))
            self._recorder(spare, one)(0)

    def _begin(self) -> None:
        """Balance the forces of the first moment by its acceleration."""
        now, trial, stepper = self.now, self.trial, self.stepper
        move(stepper.fixed, now.state, now.acceleration, 0, 0.0)
        fill(trial.state, now.state)
        trial.size[0] = stepper.forces_of(trial.state)(applied_at(self.model, 0, 0.0))
        trial.acceleration[:] = now.acceleration
        stepper.balance(trial)
        self._accept(0, 0.0, 0.0)

    def _reach(self, n: int, stride: int) -> None:
        """Go from step n - 1 to step n, whole or in parts of it; samples are `stride` apart."""
        halvings, done = 0, 0
        while done < WHOLE:
            part = WHOLE >> halvings
            share = (done + part) / WHOLE
            self.outcome = self.stepper.step(n - 1, share, halvings)
            if self.outcome.converged:
                self._accept(n - 1, done / WHOLE, share)
                done += part
                if halvings and done % (2 * part) == 0:
                    halvings -= 1
            elif halvings < HALVINGS:
                halvings += 1
                self.counts[0] += 1
            else:
                error = StoppedError(self._why(n - 1 + done / WHOLE))
                error.samples = (n - 1) // stride + 1
                raise error

    def _why(self, step: float) -> str:
        assert self.outcome is not None
        error, tolerance, dt = self.outcome.errors[-1], self.outcome.tolerance, self.model.dt
        return (
            f"the implicit steps do not converge at t = {step * dt:.6g} s: forces are out of "
            f"balance by {error:.3g} N (tolerance {tolerance:.3g} N) even with steps of "
            f"{dt / WHOLE:.3g} s; take shorter ones (numerics.continuum.steps_per_period) or "
            "explicit ones"
        )

    def _accept(self, n: int, before: float, share: float) -> None:
        """Make the trial the present, and add the work of the part of step n that led there."""
        trial = self.trial
        if trial.state.ledger is not None and share:
            self._book(trial.state.ledger, *(applied_at(self.model, n, s) for s in (before, share)))
        trial.state.v_before[:] = trial.state.v
        for present, tried in self._pairs:
            present[...] = tried

    def _book(self, ledger: np.ndarray, first: Applied, last: Applied) -> None:
        """Add the work of all forces by the trapezoidal rule, friction apart; with rho = 1 their
        balance is exact."""
        now, trial, ends = self.now.state, self.trial.state, self.model.ends
        moved, mass = trial.u - now.u, self.stepper.mass
        if trial.drag is not None:
            ledger[0] -= (now.drag + trial.drag) @ moved / 2
        if self.stepper.mass_damping:
            ledger[0] += self.stepper.mass_damping * (mass @ (now.v + trial.v)) @ moved / 2
        if ends.quiet is not None:
            ledger[2] += (now.reaction + trial.reaction) @ moved[ends.quiet.freedom] / 2
        if ends.dashpots is not None:
            ledger[2] += ((now.braking + trial.braking) * moved[ends.dashpots.freedom]).sum() / 2
        if ends.loaded is not None:
            pressure = (first.pressure + last.pressure) / 2
            ledger[3] += pressure * (ends.loaded.share @ moved[ends.loaded.freedom])
        if first.driven is not None and last.driven is not None:
            ledger[3] += (first.driven + last.driven) @ moved[ends.driven.freedom] / 2
        if self.stepper.fixed.motion is not None:
            fixed = self.stepper.fixed.freedom
            gained = (mass @ (trial.v - now.v))[fixed] @ (now.v + trial.v)[fixed]
            ledger[3] += (gained - (now.force + trial.force)[fixed] @ moved[fixed]) / 2

    def _record(self, s: int) -> None:
        """Take sample s. Accelerations are those that balance the forces at the step itself: those
        of the scheme are of an earlier time, by alpha_f - alpha_m of a step."""
        fixed, balancing = self.stepper.fixed.freedom, self._balancing
        np.divide(self.communicator.total(self.state.force), self.mass, out=balancing)
        balancing[fixed] = self.now.acceleration[fixed]
        self._sample(s)

    def _recorder(self, state: State, samples: Samples) -> Callable[[int], None]:
        rock, read = self.stepper.rock, readings(self.model, state)
        return recorder(self.model, rock, read, state, self._balancing, samples)
