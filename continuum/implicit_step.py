"""One implicit step of jointed rock: generalised alpha in time, solved by Newton's method.

At the end of a step the residual on the freedoms that move is (`continuum.generalised_alpha`)

    (1 - alpha_f) G' + alpha_f G - M ((1 - alpha_m) a' + alpha_m a),

G the sum of all forces: rock, joints, dashpots, ends, load, weight. Its derivative by the
displacement is the inertia over beta dt^2 and (1 - alpha_f) times stiffness, dashpots at the rate
factor r = gamma / (beta dt), and tangents of the joints; it is factorised only when it changes.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from continuum.balance import settle, stiffen
from continuum.generalised_alpha import scheme
from continuum.held import motion_at, wall
from continuum.model import HalfJoints, Model, Quiet, State
from continuum.newton import Factors, Outcome, newton
from continuum.pattern import pattern

RESIDUAL = 1e-10  # what may be left, of the largest force that is summed up
LAST_DIGITS = 8 * np.finfo(float).eps  # of a displacement: what they weigh cannot be balanced


class Matrices(NamedTuple):
    """Of the rock, [n, n]: stiffness, N/m; viscosity, N s/m, None without dashpots; mass, kg,
    diagonal or consistent. moves : bool array [n], false for padding."""

    stiffness: csr_matrix
    viscosity: csr_matrix | None
    mass: csr_matrix
    moves: np.ndarray


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
    iterations, factorisations : how many there have been.
    """

    def __init__(self, model: Model, matrices: Matrices, rho: float) -> None:
        self.model, self.mass, self.scheme = model, matrices.mass, scheme(rho)
        self.mass_damping = mass_damping(model)
        self.wall = wall(model.ends.held, model.dt)
        moves = matrices.moves.copy()
        moves[self.wall.freedom] = False
        self.free = np.flatnonzero(moves)
        viscosity = 0 * matrices.mass if matrices.viscosity is None else matrices.viscosity
        parts = [matrices.mass, matrices.stiffness, viscosity]
        self._pattern = pattern(parts, model.interfaces, self.free)
        self._factors = Factors(self._pattern.start, self._pattern.column)
        joints = model.interfaces
        self._joints = None if joints is None else np.zeros((6, joints.area.size))
        self._factored: tuple[Length, np.ndarray | None] | None = None
        self._weight = np.zeros(self.free.size)
        self._lengths: dict[int, Length] = {}
        self.iterations = self.factorisations = 0

    def step(self, now: Moment, trial: Moment, n: int, share: float, halvings: int) -> Outcome:
        """Try a step of dt / 2**halvings to a share of the way from step n to n + 1; the end is
        left in `trial`."""
        length, (alpha_m, alpha_f, beta, gamma) = self._length(halvings), self.scheme
        old, dt, free = now.state, length.model.dt, self.free
        drift = dt * old.v + (0.5 - beta) * dt**2 * now.acceleration
        before = alpha_f * old.force - alpha_m * (self.mass @ now.acceleration)
        self._hold(trial, n, share)

        def residual(moved: np.ndarray) -> tuple[np.ndarray, float]:
            state, a = trial.state, trial.acceleration
            a[free] = (moved - drift[free]) / (beta * dt**2)
            state.u[free] = old.u[free] + moved
            state.v[free] = (old.v + dt * ((1 - gamma) * now.acceleration + gamma * a))[free]
            self.settle(length.model, now, trial, n, share)
            inertia = self.mass @ a
            rest = (1 - alpha_f) * state.force + before - (1 - alpha_m) * inertia
            size = max(trial.size[0], now.size[0], np.abs(inertia).max())
            digits = LAST_DIGITS * np.abs(self._weight * state.u[free]).max(initial=0.0)
            return rest[free], RESIDUAL * size + digits

        def correction(rest: np.ndarray) -> np.ndarray:
            self._factorise(length, now, trial)
            self.iterations += 1
            return self._factors.solve(rest)

        return newton(residual, correction, (drift + beta * dt**2 * now.acceleration)[free])

    def settle(self, model: Model, now: Moment, trial: Moment, n: int, share: float) -> None:
        """Set the forces of a trial moment whose displacement and velocity are given."""
        state = trial.state
        if state.rate is not None:
            state.rate[:] = state.v
        trial.size[0] = settle(model, now.state, state, pressure_at(self.model, n, share))
        if self.mass_damping:
            state.force[:] -= self.mass_damping * (self.mass @ state.v)

    def _hold(self, trial: Moment, n: int, share: float) -> None:
        motion = motion_at(self.wall, n, share)
        for values, given in zip(
            (trial.state.u, trial.state.v, trial.acceleration), motion, strict=True
        ):
            values[self.wall.freedom] = given

    def _length(self, halvings: int) -> Length:
        if halvings not in self._lengths:
            self._lengths[halvings] = self._make_length(0.5**halvings)
        return self._lengths[halvings]

    def _make_length(self, share: float) -> Length:
        alpha_m, alpha_f, beta, gamma = self.scheme
        model = shortened(self.model, share)
        r = gamma / (beta * model.dt)
        mass, stiffness, viscosity = self._pattern.fixed
        inertia = (1 - alpha_m) / (beta * model.dt**2) * mass
        forces = stiffness + r * (viscosity + self.mass_damping * mass)
        if model.ends.quiet is not None:
            freedom, resistance = end_resistance(model.ends.quiet, r, model.dt)
            place = self._pattern.diagonal[np.searchsorted(self.free, freedom)]
            np.add.at(forces, place, resistance)
        return Length(model, r, inertia + (1 - alpha_f) * forces, inertia)

    def _factorise(self, length: Length, now: Moment, trial: Moment) -> None:
        """Take the matrix of a trial moment, unless it is the last one."""
        if self._joints is not None:
            stiffen(length.model, now.state, trial.state, length.r, self._joints)
        if self._factored is not None:
            last, joints = self._factored
            if last is length and (joints is None or np.array_equal(joints, self._joints)):
                return
        values = length.fixed
        if self._joints is not None:
            joints = self._joints.copy()
            values = values + (1 - self.scheme.alpha_f) * (self._pattern.joints @ joints.ravel())
        self._factors.factorise(values)
        self.factorisations += 1
        self._weight = np.abs(values - length.inertia)[self._pattern.diagonal]
        self._factored = length, None if self._joints is None else joints


def mass_damping(model: Model) -> float:
    """Return the mass-proportional damping alpha, 1/s, that `rock.keep` stands for."""
    keep = model.rock.keep
    return 0.0 if keep is None else 2 * (1 - keep) / (1 + keep) / model.dt


def pressure_at(model: Model, n: int, share: float) -> float:
    """Return the pressure of the load (Pa) at step n and a share of the next, linear in between."""
    loaded = model.ends.loaded
    if loaded is None:
        return 0.0
    last = loaded.pressure[n + 1] if share else 0.0
    return float((1 - share) * loaded.pressure[n] + share * last)


def shortened(model: Model, share: float) -> Model:
    """Return a model whose step is a share of what it was; only dt and half joints know it."""
    quiet = model.ends.quiet
    if quiet is not None and quiet.springs is not None:
        springs = shorter_springs(quiet.springs, share)
        model = model._replace(ends=model.ends._replace(quiet=quiet._replace(springs=springs)))
    return model._replace(dt=share * model.dt)


def shorter_springs(springs: HalfJoints, share: float) -> HalfJoints:
    """Return half joints for a share of the step: decay = (1 - lag) / (1 + lag) and gain =
    dt share / (1 + lag), lag in proportion to dt (`joints.ends.half_spring`)."""
    lag = (1 - springs.decay) / (1 + springs.decay)
    gain = springs.gain * (1 + lag) * share / (1 + share * lag)
    return HalfJoints(springs.stiffness, (1 - share * lag) / (1 + share * lag), gain)


def end_resistance(quiet: Quiet, r: float, dt: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the freedoms that ends absorb from and how they resist displacement there, N/m."""
    resistance = r * quiet.viscosity
    if quiet.springs is not None:
        resistance = resistance + quiet.springs.stiffness * quiet.springs.gain / dt
    return quiet.freedom, resistance
