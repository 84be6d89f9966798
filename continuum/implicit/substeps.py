"""The constants of a run for any part of a step: implicit steps that are halved need them."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.continuum.model import Dashpots, Fixed, HalfJoints, Model, Quiet
from jointwave.continuum.state import State


class FixedMotion(NamedTuple):
    """Freedoms that move as they are told.

    freedom, direction : [k]; all move by direction times the same displacement (m), velocity and
    acceleration, each float array [steps + 1] at whole steps; None where they do not move.
    """

    freedom: np.ndarray
    direction: np.ndarray
    motion: np.ndarray | None


def fixed_motion(fixed: Fixed | None, dt: float) -> FixedMotion:
    """Return the motion of fixed freedoms; dt : of whole steps, s.

    Displacements are sums of the given steps; velocity and acceleration are centred differences
    of them, of second order, at rest before t = 0.
    """
    if fixed is None:
        return FixedMotion(np.zeros(0, dtype=np.int64), np.zeros(0), None)
    if fixed.step is None:
        return FixedMotion(fixed.freedom, fixed.direction, None)
    before = np.concatenate([[0.0], fixed.step[:-1]])
    motion = [np.cumsum(before), (before + fixed.step) / (2 * dt), (fixed.step - before) / dt**2]
    return FixedMotion(fixed.freedom, fixed.direction, np.array(motion))


def move(
    fixed_motion: FixedMotion, state: State, acceleration: np.ndarray, n: int, share: float
) -> None:
    """Give fixed freedoms their displacement, velocity and acceleration at step n and a share of
    the next."""
    if fixed_motion.freedom.size == 0:
        return
    given: np.ndarray = np.zeros(3)
    if fixed_motion.motion is not None:
        first = fixed_motion.motion[:, n]
        last = fixed_motion.motion[:, n + 1] if share else first
        given = (1 - share) * first + share * last
    for values, value in zip((state.u, state.v, acceleration), given, strict=True):
        values[fixed_motion.freedom] = value * fixed_motion.direction


class Applied(NamedTuple):
    """What acts at one moment: the pressure of `Ends.loaded`, Pa, and the forces of `Ends.driven`
    [k], N; None without."""

    pressure: float
    driven: np.ndarray | None


UNLOADED = Applied(0.0, None)


def applied_at(model: Model, n: int, share: float) -> Applied:
    """Return what acts at step n and a share of the next, linear in between."""
    loaded, driven, pressure, forces = model.ends.loaded, model.ends.driven, 0.0, None
    if loaded is not None:
        last = loaded.pressure[n + 1] if share else 0.0
        pressure = float((1 - share) * loaded.pressure[n] + share * last)
    if driven is not None:
        first, last = driven.at(n, n + 2)
        forces = (1 - share) * first + share * last
    return Applied(pressure, forces)


def dashpot_matrix(dashpots: Dashpots, size: int) -> csr_matrix:
    """Return the viscosity of dashpots in the plane [size, size], N s/m."""
    (x, y), (xx, yy, xy) = dashpots.freedom.T, dashpots.viscosity.T
    rows, columns = np.concatenate([x, y, x, y]), np.concatenate([x, y, y, x])
    return csr_matrix((np.concatenate([xx, yy, xy, xy]), (rows, columns)), (size, size))


def shortened(model: Model, share: float) -> Model:
    """Return a model whose step is a share of what it was; what depends on it are dt, half joints
    and what rock remembers, but for what the energies of its springs count."""
    quiet = model.ends.quiet
    if quiet is not None and quiet.springs is not None:
        springs = shorter_springs(quiet.springs, share)
        model = model._replace(ends=model.ends._replace(quiet=quiet._replace(springs=springs)))
    memory = model.rock.memory
    if memory is not None:
        decay = memory.decay**share
        memory = memory._replace(decay=decay, gain=(1 - decay) / memory.frequency)
    return model._replace(dt=share * model.dt, rock=model.rock._replace(memory=memory))


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
