"""One implicit step of jointed rock: generalised alpha in time, solved by Newton's method.

At the end of a step the residual on the freedoms that move is (`generalised_alpha`)

    (1 - alpha_f) G' + alpha_f G - M ((1 - alpha_m) a' + alpha_m a),

G the sum of all forces: rock, joints, dashpots, ends, load, weight. Its derivative by the
displacement is the inertia over beta dt^2 and (1 - alpha_f) times stiffness, dashpots at the rate
factor r = gamma / (beta dt), and tangents of the joints; it is factorised only when it changes.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from jointwave.continuum.explicit.march import mass_damping
from jointwave.continuum.implicit.balance import Matrices, trial_forces
from jointwave.continuum.implicit.generalised_alpha import scheme
from jointwave.continuum.implicit.newton import Outcome, newton
from jointwave.continuum.implicit.pattern import System
from jointwave.continuum.implicit.substeps import (
    Applied,
    applied_at,
    dashpot_matrix,
    end_resistance,
    fixed_motion,
    move,
    shortened,
)
from jointwave.continuum.implicit.vectors import Vectors, differ, move_free, out_of_balance, predict
from jointwave.continuum.model import Model
from jointwave.continuum.state import State
from jointwave.numerics.arguments import Packed
from jointwave.results.arrays import copied

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
    """A length of steps: the matrix without the joints [nnz], N/m, and what of it is inertia; what
    sets the forces of the trial, and what its vectors are given (`Vectors`)."""

    fixed: np.ndarray
    inertia: np.ndarray
    set_forces: Callable[[Applied], float]
    vectors: Packed


class Stepper:
    """What takes steps of 1, 1/2, 1/4 ... of the model's dt from one moment to the next.

    Parameters
    ----------
    model, state, matrices : of one run; rho : spectral radius of the scheme, 0 .. 1.

    Attributes
    ----------
    now, trial : the moment that steps start from, of `state` itself, and the one they try to reach.
    counts : int array [2], how many corrections and factorisations there have been.
    """

    def __init__(self, model: Model, state: State, matrices: Matrices, rho: float) -> None:
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
        self._carried = _prestress(model)
        self._lengths: dict[int, Length] = {}
        self.now, self.trial = (
            Moment(s, np.zeros_like(state.u), np.zeros(1)) for s in (state, copied(state))
        )
        self._moved, self._weight = np.zeros((2, self.free.size))
        self._drift, self._kept, self._before, self._rest = np.zeros((4, state.u.size))
        self.counts = np.zeros(2, dtype=np.int64)

    def step(self, n: int, share: float, halvings: int) -> Outcome:
        """Try a step of dt / 2**halvings to a share of the way from step n to n + 1; the end is
        left in `trial`."""
        length, now, trial = self.length(halvings), self.now, self.trial
        predict(length.vectors)
        move(self.fixed, trial.state, trial.acceleration, n, share)
        applied = applied_at(self.model, n, share)

        def residual(moved: np.ndarray) -> tuple[np.ndarray, float]:
            self._moved[:] = moved
            moves = move_free(length.vectors)
            trial.size[0] = length.set_forces(applied)
            inertia = out_of_balance(length.vectors)
            size = max(trial.size[0], now.size[0], inertia)
            left = RESIDUAL * size + LAST_DIGITS * (moves + self._carried)
            return self.communicator.total(self._rest)[self._moves], left

        def correction(rest: np.ndarray) -> np.ndarray:
            self._factorise(length)
            self.counts[0] += 1
            return self._system.solve(rest)

        return newton(residual, correction, self._moved, self.communicator)

    def forces_of(
        self, trial: State, model: Model | None = None, r: float = 0.0
    ) -> Callable[[Applied], float]:
        """Return what sets the forces and tangents of a trial state whose displacement and
        velocity are given; model : None for that of whole steps. r : rate factor, 1/s."""
        tangents, now, model = self._system.tangents, self.now.state, model or self.model
        return trial_forces(model, self.rock, now, trial, tangents, r, self.mass_damping)

    def balance(self, moment: Moment) -> None:
        """Set the acceleration of the freedoms that move by the forces of a moment."""
        rest = self.communicator.total(moment.state.force - self.mass @ moment.acceleration)
        self._system.factorise(self._pattern.fixed[0])
        self._factored = None
        moment.acceleration[self.free] += self._system.solve(rest[self.free])

    def length(self, halvings: int) -> Length:
        """Return what steps need that are halved so often."""
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
        fixed = inertia + (1 - alpha_f) * forces
        set_forces = self.forces_of(self.trial.state, model, r)
        return Length(fixed, inertia, set_forces, self._vectors(model.dt))

    def _vectors(self, dt: float) -> Packed:
        now, trial, mass = self.now, self.trial, self.mass
        scratch = self._drift, self._kept, self._before
        moments = now.state.u, now.state.v, now.acceleration, now.state.force
        ends = trial.state.u, trial.state.v, trial.acceleration, trial.state.force, self._rest
        free = self.free, self._moved, self._weight
        matrix = mass.indptr, mass.indices, mass.data
        return Packed(Vectors(*free, *moments, *scratch, *ends, *matrix, *self.scheme, dt))

    def _factorise(self, length: Length) -> None:
        """Take the matrix of the last trial moment, unless it is that of the one before."""
        if self._factored is not None:
            last, tangents = self._factored
            changed = differ(tangents.reshape(-1), self._system.tangents.reshape(-1))
            if last is length and self.communicator.all(changed == 0):
                return
        values = self._system.with_joints(length.fixed, 1 - self.scheme.alpha_f)
        self._system.factorise(values)
        self.counts[1] += 1
        diagonal = np.zeros(self.mass.shape[0])
        diagonal[self.free] = (values - length.inertia)[self._pattern.diagonal]
        self._weight[:] = np.abs(self.communicator.total(diagonal)[self.free])
        self._factored = length, self._system.tangents.copy()


def _prestress(model: Model) -> float:
    """Return the largest force (N) of prestress at a point of a joint."""
    joints = model.interfaces
    if joints is None or joints.prestress is None:
        return 0.0
    return float(np.abs(joints.area * joints.prestress).max(initial=0.0))
