"""One implicit step of jointed rock: generalised alpha in time, solved by Newton's method.

At the end of a step the residual on the freedoms that move is (`generalised_alpha`)

    (1 - alpha_f) G' + alpha_f G - M ((1 - alpha_m) a' + alpha_m a),

G the sum of all forces: rock, joints, dashpots, ends, load, weight. Its derivative by the
displacement is the inertia over beta dt^2 and (1 - alpha_f) times stiffness, dashpots at the rate
factor r = gamma / (beta dt), and tangents of the joints; it is factorised only when it changes.
"""

from typing import NamedTuple

import numpy as np

from continuum.explicit.march import mass_damping
from continuum.implicit.balance import Matrices, balance
from continuum.implicit.generalised_alpha import scheme
from continuum.implicit.newton import Outcome, newton
from continuum.implicit.pattern import System
from continuum.implicit.substeps import (
    Applied,
    applied_at,
    dashpot_matrix,
    end_resistance,
    fixed_motion,
    move,
    shortened,
)
from continuum.implicit.vectors import compiled_joints, move_free, out_of_balance
from continuum.model import Model
from continuum.state import State

RESIDUAL = 1e-10  # tolerance over the largest summed force
#: Of a displacement, and of the prestress that joints carry: what they weigh cannot be balanced.
LAST_DIGITS = 8 * np.finfo(float).eps


class Moment(NamedTuple):
    """A state and its acceleration [n], m/s2; `state.force` counts what ends and mass damping do.

    size : float array [1], the largest force (N) that is summed up.
    """

    state: State
    acceleration: np.ndarray
    size: np.ndarray


class Length(NamedTuple):
    """A length of steps: the model with its dt and half joints; the rate factor r, 1/s; the matrix
    without the joints [nnz], N/m, and what of it is inertia."""

    model: Model
    r: float
    fixed: np.ndarray
    inertia: np.ndarray


class Stepper:
    """What takes steps of 1, 1/2, 1/4 ... of the model's dt from one moment to the next.

    Parameters
    ----------
    model, matrices : of one run; rho : spectral radius of the scheme, 0 .. 1.

    Attributes
    ----------
    counts : int array [2], how many corrections and factorisations there have been.
    """

    def __init__(self, model: Model, matrices: Matrices, rho: float) -> None:
        model = model._replace(interfaces=compiled_joints(model.interfaces))
        self.model, self.scheme = model, scheme(rho)
        self.rock, self.mass, self.communicator = matrices, matrices.mass, matrices.communicator
        self.mass_damping = mass_damping(model.rock.decay, model.dt)
        self.fixed = fixed_motion(model.ends.fixed, model.dt)
        viscosity = 0 * matrices.mass if matrices.viscosity is None else matrices.viscosity
        if model.ends.dashpots is not None:
            viscosity = viscosity + dashpot_matrix(model.ends.dashpots, matrices.mass.shape[0])
        parts = [matrices.mass, matrices.stiffness, viscosity]
        self._system = System(model, matrices, self.fixed.freedom, parts)
        self.free, self._pattern = self._system.free, self._system.pattern
        # A slice takes no time where nothing is held.
        every = self.free.size == matrices.mass.shape[0]
        self._moves: slice | np.ndarray = slice(None) if every else self.free
        self._factored: tuple[Length, np.ndarray] | None = None
        self._weight = np.zeros(self.free.size)
        self._carried = _prestress(model)
        self._lengths: dict[int, Length] = {}
        self.counts = np.zeros(2, dtype=np.int64)

    def step(self, now: Moment, trial: Moment, n: int, share: float, halvings: int) -> Outcome:
        """Try a step of dt / 2**halvings to a share of the way from step n to n + 1; the end is
        left in `trial`."""
        length, (alpha_m, alpha_f, beta, gamma) = self._length(halvings), self.scheme
        old, dt, free, mass = now.state, length.model.dt, self.free, self.mass
        old_u, old_v, square = old.u, old.v, beta * dt**2
        drift = dt * old_v + (0.5 - beta) * dt**2 * now.acceleration
        before = alpha_f * old.force - alpha_m * (mass @ now.acceleration)
        move(self.fixed, trial.state, trial.acceleration, n, share)
        # What no iteration changes: Newton's method takes two of a linear step.
        applied, a, force = applied_at(self.model, n, share), trial.acceleration, trial.state.force
        u, v, rest = trial.state.u, trial.state.v, np.empty_like(old_u)
        matrix, kept = (mass.indptr, mass.indices, mass.data), (1 - gamma) * now.acceleration
        of_step = old_u, old_v, drift, kept, dt, gamma, square

        def residual(moved: np.ndarray) -> tuple[np.ndarray, float]:
            moves = move_free(free, moved, *of_step, self._weight, a, u, v)
            self.set_forces(length.model, now, trial, applied, length.r)
            inertia = out_of_balance(*matrix, a, force, before, 1 - alpha_f, 1 - alpha_m, rest)
            size = max(trial.size[0], now.size[0], inertia)
            left = RESIDUAL * size + LAST_DIGITS * (moves + self._carried)
            return self.communicator.total(rest)[self._moves], left

        def correction(rest: np.ndarray) -> np.ndarray:
            self._factorise(length)
            self.counts[0] += 1
            return self._system.solve(rest)

        start = (drift + square * now.acceleration)[self._moves].copy()
        return newton(residual, correction, start, self.communicator)

    def set_forces(
        self, model: Model, now: Moment, trial: Moment, applied: Applied, r: float = 0.0
    ) -> None:
        """Set the forces and tangents of a trial moment whose displacement and velocity are given;
        r : rate factor, 1/s."""
        state = trial.state
        trial.size[0] = balance(
            model, self.rock, now.state, state, applied, r, self._system.tangents
        )
        if self.mass_damping:
            state.force[:] -= self.mass_damping * (self.mass @ state.v)

    def balance(self, moment: Moment) -> None:
        """Set the acceleration of the freedoms that move by the forces of a moment."""
        rest = self.communicator.total(moment.state.force - self.mass @ moment.acceleration)
        self._system.factorise(self._pattern.fixed[0])
        self._factored = None
        moment.acceleration[self.free] += self._system.solve(rest[self.free])

    def _length(self, halvings: int) -> Length:
        if halvings not in self._lengths:
            self._lengths[halvings] = self._make_length(0.5**halvings)
        return self._lengths[halvings]

    def _make_length(self, share: float) -> Length:
        alpha_m, alpha_f, beta, gamma = self.scheme
        model = shortened(self.model, share)
        r = gamma / (beta * model.dt)
        mass, stiffness, viscosity = self._pattern.fixed
        if model.rock.memory is not None:
            stiffness = model.rock.memory.tangent(model.dt) * stiffness
        inertia = (1 - alpha_m) / (beta * model.dt**2) * mass
        forces = stiffness + r * (viscosity + self.mass_damping * mass)
        if model.ends.quiet is not None:
            freedom, resistance = end_resistance(model.ends.quiet, r, model.dt)
            place = self._pattern.diagonal[np.searchsorted(self.free, freedom)]
            np.add.at(forces, place, resistance)
        return Length(model, r, inertia + (1 - alpha_f) * forces, inertia)

    def _factorise(self, length: Length) -> None:
        """Take the matrix of the last trial moment, unless it is that of the one before."""
        if self._factored is not None:
            last, tangents = self._factored
            if last is length and self.communicator.all(
                np.array_equal(tangents, self._system.tangents)
            ):
                return
        values = self._system.with_joints(length.fixed, 1 - self.scheme.alpha_f)
        self._system.factorise(values)
        self.counts[1] += 1
        diagonal = np.zeros(self.mass.shape[0])
        diagonal[self.free] = (values - length.inertia)[self._pattern.diagonal]
        self._weight = np.abs(self.communicator.total(diagonal)[self.free])
        self._factored = length, self._system.tangents.copy()


def _prestress(model: Model) -> float:
    """Return the largest force (N) of prestress at a point of a joint."""
    joints = model.interfaces
    if joints is None or joints.prestress is None:
        return 0.0
    return float(np.abs(joints.area * joints.prestress).max(initial=0.0))
