"""One implicit step of jointed rock: generalised alpha in time, solved by Newton's method.

At the end of a step the residual on the freedoms that move is (`continuum.implicit.generalised_alpha`)

    (1 - alpha_f) G' + alpha_f G - M ((1 - alpha_m) a' + alpha_m a),

G the sum of all forces: rock, joints, dashpots, ends, load, weight. Its derivative by the
displacement is the inertia over beta dt^2 and (1 - alpha_f) times stiffness, dashpots at the rate
factor r = gamma / (beta dt), and tangents of the joints; it is factorised only when it changes.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, diags

from continuum.implicit.balance import settle, stiffen
from continuum.implicit.generalised_alpha import scheme
from continuum.implicit.newton import Outcome, factors_of, newton
from continuum.implicit.pattern import pattern
from continuum.implicit.substeps import (
    end_resistance,
    mass_damping,
    motion_at,
    pressure_at,
    shortened,
    wall,
)
from continuum.model import Model, State
from continuum.parallel.serial import ALONE, Alone
from continuum.space.body import Body, whole

RESIDUAL = 1e-10  # what may be left, of the largest force that is summed up
LAST_DIGITS = 8 * np.finfo(float).eps  # of a displacement: what they weigh cannot be balanced


class Matrices(NamedTuple):
    """Of the rock, [n, n]: stiffness, N/m; viscosity, N s/m, None without dashpots; mass, kg,
    diagonal or consistent. moves : bool array [n], false for padding. team : the processes that
    share the rock, each with its share of the matrices."""

    stiffness: csr_matrix
    viscosity: csr_matrix | None
    mass: csr_matrix
    moves: np.ndarray
    team: Alone = ALONE


def rock_matrices(body: Body) -> Matrices:
    """Return the matrices of discretised rock."""
    stiffness, viscosity = whole(body.layout, body.mesh, body.blocks), None
    if body.viscous_blocks:
        viscosity = whole(body.layout, body.mesh, body.viscous_blocks)
    mass = csr_matrix(diags(body.mass)) if body.consistent is None else body.consistent
    moves = body.team.total(stiffness.diagonal()) > 0
    return Matrices(stiffness, viscosity, mass, moves, body.team)


class Moment(NamedTuple):
    """A state and its acceleration [n], m/s2; `state.force` counts what ends and mass damping do.

    size : float array [1], the largest force (N) that is summed up.
    """

    state: State
    acceleration: np.ndarray
    size: np.ndarray


def joint_room(model: Model) -> np.ndarray:
    """Return room for the joints' stiffness in a step [6, q]."""
    return np.zeros((6, 0 if model.interfaces is None else model.interfaces.area.size))


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
        self.model, self.scheme = model, scheme(rho)
        self.mass, self.team = matrices.mass, matrices.team
        self.mass_damping = mass_damping(model)
        self.wall = wall(model.ends.held, model.dt)
        moves = matrices.moves.copy()
        moves[self.wall.freedom] = False
        self.free = np.flatnonzero(moves)
        viscosity = 0 * matrices.mass if matrices.viscosity is None else matrices.viscosity
        parts = [matrices.mass, matrices.stiffness, viscosity]
        self._pattern = pattern(parts, model.interfaces, self.free)
        place = self._pattern.start, self._pattern.column, self.free
        self._factors = factors_of(*place, self.team)
        self._joints = joint_room(model)
        self._factored: tuple[Length, np.ndarray] | None = None
        self._weight = np.zeros(self.free.size)
        self._lengths: dict[int, Length] = {}
        self.counts = np.zeros(2, dtype=np.int64)

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
            return self.team.total(rest)[free], RESIDUAL * size + digits

        def correction(rest: np.ndarray) -> np.ndarray:
            self._factorise(length, now, trial)
            self.counts[0] += 1
            return self._factors.solve(rest)

        start = (drift + beta * dt**2 * now.acceleration)[free]
        return newton(residual, correction, start, self.team)

    def settle(self, model: Model, now: Moment, trial: Moment, n: int, share: float) -> None:
        """Set the forces of a trial moment whose displacement and velocity are given."""
        state = trial.state
        if state.rate is not None:
            state.rate[:] = state.v
        trial.size[0] = settle(model, now.state, state, pressure_at(self.model, n, share))
        if self.mass_damping:
            state.force[:] -= self.mass_damping * (self.mass @ state.v)

    def balance(self, moment: Moment) -> None:
        """Set the acceleration of the freedoms that move by the forces of a moment."""
        rest = self.team.total(moment.state.force - self.mass @ moment.acceleration)
        self._factors.factorise(self._pattern.fixed[0])
        self._factored = None
        moment.acceleration[self.free] += self._factors.solve(rest[self.free])

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
        stiffen(length.model, now.state, trial.state, length.r, self._joints)
        if self._factored is not None:
            last, joints = self._factored
            if last is length and self.team.all(np.array_equal(joints, self._joints)):
                return
        of_joints = self._pattern.joints @ self._joints.ravel()
        values = length.fixed + (1 - self.scheme.alpha_f) * of_joints
        self._factors.factorise(values)
        self.counts[1] += 1
        diagonal = np.zeros(self.mass.shape[0])
        diagonal[self.free] = (values - length.inertia)[self._pattern.diagonal]
        self._weight = np.abs(self.team.total(diagonal)[self.free])
        self._factored = length, self._joints.copy()
