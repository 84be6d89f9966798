"""The forces of a trial state that an implicit step has to balance, and the joints' tangents.

A trial starts from what the state before the step remembers, and changes nothing of it. Rock and
ends are linear, sums of arrays; the law of the joints is compiled.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, diags

from continuum.implicit.substeps import Applied
from continuum.implicit.vectors import Matrix, largest, mean_velocity, rock_forces
from continuum.model import Model
from continuum.parallel.serial import SERIAL, Serial
from continuum.space.body import Body, rock_matrices
from continuum.space.tractions import joint_energy, joint_loads, joint_tangents
from continuum.state import STATES, Samples, State
from numerics.denormals import flush_tiny, restore_tiny
from numerics.jit import jitted


class Matrices(NamedTuple):
    """Of the rock, [n, n]: stiffness, N/m; viscosity, N s/m, None without dashpots; mass, kg,
    diagonal or consistent. moves : bool array [n], false for padding. communicator : of those who
    share the rock, each with its share of the matrices."""

    stiffness: csr_matrix
    viscosity: csr_matrix | None
    mass: csr_matrix
    moves: np.ndarray
    communicator: Serial = SERIAL


def implicit_matrices(body: Body) -> Matrices:
    """Return the matrices of discretised rock."""
    stiffness, viscosity = rock_matrices(body)
    mass = csr_matrix(diags(body.mass)) if body.consistent is None else body.consistent
    moves = body.communicator.total(stiffness.diagonal()) > 0
    viscosity = None if viscosity is None else Matrix(viscosity)
    return Matrices(Matrix(stiffness), viscosity, Matrix(mass), moves, body.communicator)


def balance(
    model: Model,
    rock: Matrices,
    now: State,
    trial: State,
    applied: Applied,
    r: float,
    tangents: np.ndarray,
) -> float:
    """Set the forces of a trial state and what it would remember, and the joints' tangents.

    now : state at the beginning of the step. trial : u and v are given; v_before is set to the
    mean velocity of the step, and the reactions of the ends count among the forces.
    applied : of the loads. r : rate factor, 1/s (`joints.tangent`).
    Returns the largest force (N) that is summed up, of rock, dashpots, load and weight.
    """
    u, mean, force, K = trial.u, trial.v_before, trial.force, rock.stiffness
    mean_velocity(u, now.u, model.dt, mean)
    for own, before in zip(_history(trial), _history(now), strict=True):
        if own is not None:
            own[:] = before
    if trial.ledger is not None:
        trial.ledger[:] = now.ledger
    memory = model.rock.memory
    if memory is None:
        sizes = [rock_forces(K.indptr, K.indices, K.data, u, force)]
    else:
        force[:], sizes = 0.0, [0.0]
    if trial.at.rate is not None:
        v = trial.v
        trial.rate[:] = v
        trial.drag[:] = 0.0 if rock.viscosity is None else -(rock.viscosity @ v)
        sizes.append(largest(trial.drag))
    if memory is not None:
        trial.elongation[:] = memory.advanced(now.elongation, mean)
        trial.strained[:] = memory.strained(u, trial.elongation)
        trial.drag[:] = -(K @ trial.strained)  # all of it counts as viscous
        sizes.append(largest(trial.drag))
    if model.weight is not None:
        sizes.append(largest(model.weight))
    if model.ends.loaded is not None:
        sizes.append(largest(model.ends.loaded.share * applied.pressure))
    if applied.driven is not None:
        sizes.append(largest(applied.driven))
    if model.interfaces is not None:
        _add_joint_forces(model, now, trial, r, tangents)
    if trial.drag is not None:
        force += trial.drag
    if model.weight is not None:
        force += model.weight
    if model.ends.loaded is not None:
        force[model.ends.loaded.freedom] += model.ends.loaded.share * applied.pressure
    if applied.driven is not None:
        force[model.ends.driven.freedom] += applied.driven
    _add_ends(model, now, trial)
    return max(sizes)


def _history(state: State) -> tuple:
    return state.opening, state.slide, state.cohesion, state.path


def _add_joint_forces(
    model: Model, now: State, trial: State, r: float, tangents: np.ndarray
) -> None:
    """Add the forces of the joints, and set their tangents."""
    joints, shape = model.interfaces, trial.jump.shape
    # A joint slides by what it slips in the step, whatever the velocity at the end of it.
    for jump, moved in (
        (trial.jump, trial.u),
        (trial.jump_rate, trial.rate),
        (trial.slip_rate, trial.v_before),
    ):
        if jump is not None:
            jump[:] = (joints.jump @ moved).reshape(shape)
    loads, drags = trial.loads, trial.drags
    work = joint_balance_for(joints.parts, joints.directions)(
        joints.table, joints.area, joints.prestress,
        trial.jump, trial.jump_rate, trial.slip_rate,
        trial.opening, trial.slide, trial.cohesion, trial.path, loads, drags, model.dt,
        now.opening, now.slide, now.cohesion, now.path, r, tangents,
    )  # fmt: skip
    if trial.ledger is not None:
        trial.ledger[1] += work
    force = trial.force
    force += joints.spread @ loads.ravel()
    if drags is not None:
        trial.drag[:] += joints.spread @ drags.ravel()


def _add_ends(model: Model, now: State, trial: State) -> None:
    """Add what absorbs at the ends; springs in front of dashpots close by the mean velocity."""
    quiet, dashpots = model.ends.quiet, model.ends.dashpots
    if dashpots is not None:
        (x, y), (xx, yy, xy) = trial.v[dashpots.freedom].T, dashpots.viscosity.T
        trial.braking[:] = np.stack([xx * x + xy * y, xy * x + yy * y], axis=1)
        trial.force[dashpots.freedom] -= trial.braking
    if quiet is None:
        return
    trial.reaction[:] = quiet.viscosity * trial.v[quiet.freedom]
    if now.closure is not None:
        springs = quiet.springs
        moved = springs.gain * trial.v_before[quiet.freedom]
        trial.closure[:] = springs.decay * now.closure + moved
        trial.reaction[:] += springs.stiffness * trial.closure
    np.subtract.at(trial.force, quiet.freedom, trial.reaction)


@cache
def joint_balance_for(parts, directions):
    """Return the kernel of the joints in a trial state, for a law with these parts and jumps in so
    many directions."""
    shears = True if directions != 1 else None

    @jitted
    def joint_balance(
        table, area, prestress, jump, jump_rate, slip_rate, opening, slide, cohesion, path, loads,
        drags, dt, opening_before, slide_before, cohesion_before, path_before, r, tangents,
    ):  # fmt: skip
        """Set forces, history and tangents of all points; return the work of sliding, J."""
        flushing = flush_tiny()
        joint_tangents(
            parts, directions, shears, table, area, prestress, jump, jump_rate,
            opening_before, slide_before, cohesion_before, path_before, dt, r, tangents,
        )  # fmt: skip
        sliding = joint_loads(
            parts, directions, shears, table, area, prestress,
            jump, jump_rate, slip_rate, opening, slide, cohesion, path, loads, drags, dt,
        )  # fmt: skip
        restore_tiny(flushing)
        return sliding

    return joint_balance


@cache
def joint_energy_for(parts, directions):
    """Return the kernel of `continuum.space.tractions.joint_energy`."""

    @jitted
    def energy(table, area, prestress, jump, opening, slide, path, loads):
        """Return elastic energy and what opening has spent, J."""
        return joint_energy(
            parts, directions, table, area, prestress, jump, opening, slide, path, loads
        )

    return energy


def record(
    model: Model,
    rock: Matrices,
    receivers: tuple[csr_matrix, np.ndarray],
    state: State,
    acceleration: np.ndarray,
    samples: Samples,
    s: int,
) -> None:
    """Record sample s of a state in balance: receivers and ledger.

    receivers : of `continuum.explicit.march.readings`, which take velocities half a step before and
    after. acceleration : m/s2.
    """
    matrix, added = receivers
    fields, half = state.fields.copy(), 0.5 * model.dt * acceleration
    fields[state.at.v], fields[state.at.v_before] = state.v + half, state.v - half
    samples.waves[:, s] = matrix @ fields + added
    if samples.energy is None:
        return
    stored, spent, joints = 0.0, 0.0, model.interfaces
    if joints is not None:
        stored, spent = joint_energy_for(joints.parts, joints.directions)(
            joints.table, joints.area, joints.prestress,
            state.jump, state.opening, state.slide, state.path, state.loads,
        )  # fmt: skip
    elastic = elastic_energy(model, rock, state)
    samples.energy[:STATES, s] = (
        state.v @ (rock.mass @ state.v) / 2,
        elastic + stored,
        spent,
        0.0 if model.weight is None else -(model.weight @ state.u),
    )
    samples.energy[STATES:, s] = state.ledger
    if model.rock.memory is not None:
        samples.energy[STATES, s] -= elastic


def elastic_energy(model: Model, rock: Matrices, state: State) -> float:
    """Return what the rock's springs store, J."""
    memory = model.rock.memory
    if memory is None:
        return float(state.u @ (rock.stiffness @ state.u)) / 2
    return memory.energy(rock.stiffness, state.u, state.elongation)
