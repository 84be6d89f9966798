"""The forces of a trial state that an implicit step has to balance, and the joints' tangents.

A trial starts from what the state before the step remembers, and changes nothing of it.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, diags

from jointwave.continuum.implicit.substeps import Applied
from jointwave.continuum.implicit.vectors import add_transposed, larger, row_times
from jointwave.continuum.model import Model
from jointwave.continuum.parallel.serial import SERIAL, Serial
from jointwave.continuum.space.body import Body, rock_matrices
from jointwave.continuum.space.tractions import joint_tangents, loads_for
from jointwave.continuum.state import State
from jointwave.joints.formula import formula
from jointwave.numerics.arguments import Packed, unpacked
from jointwave.numerics.denormals import flush_denormals, restore_denormals
from jointwave.numerics.jit import jitted


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
    return Matrices(stiffness, viscosity, mass, moves, body.communicator)


def trial_forces(
    model: Model,
    rock: Matrices,
    now: State,
    trial: State,
    tangents: np.ndarray,
    r: float = 0.0,
    alpha: float = 0.0,
) -> Callable[[Applied], float]:
    """Return the function of the loads that sets the forces of a trial state and what it would
    remember, and the joints' tangents.

    now : state at the beginning of the step. trial : u and v are given; v_before is set to the
    mean velocity of the step, and the reactions of the ends count among the forces.
    r : rate factor, 1/s (`joints.tangent`). alpha : of mass-proportional damping, 1/s.
    The function returns the largest force (N) that is summed up, of rock, dashpots, load and
    weight. It is for these arrays, and for as long as they live.
    """
    joints, driven = model.interfaces, model.ends.driven
    drive = None if driven is None else np.zeros(driven.freedom.size)
    kernel = forces_for(*(2 * (None,) if joints is None else (joints.parts, joints.directions)))
    given = arguments(model, rock, now, trial, tangents, drive, r, alpha)

    def set_forces(applied: Applied) -> float:
        if drive is not None:
            drive[:] = applied.driven
        return kernel(given, applied.pressure)

    return set_forces


def arguments(
    model: Model,
    rock: Matrices,
    now: State,
    trial: State,
    tangents: np.ndarray,
    drive: Any,
    r: float,
    alpha: float,
) -> Packed:
    """Return what the kernel of `forces_for` is given, in its order; None for what is absent."""
    memory, joints, ends = model.rock.memory, model.interfaces, model.ends
    springs = None if ends.quiet is None else ends.quiet.springs
    relaxed = None if memory is None else (memory.relaxed, memory.share, memory.decay, memory.gain)
    points = None if joints is None else (joints.table, joints.area, joints.prestress)
    return Packed(
        *(trial.u, now.u, trial.v, trial.v_before, trial.rate, trial.force, trial.drag),
        *(csr(rock.stiffness), csr(rock.viscosity), csr(rock.mass if alpha else None)),
        *(model.dt, r, alpha, model.weight, relaxed, trial.strained),
        *(trial.elongation, now.elongation, csr(joints and joints.jump), points),
        *(trial.jump, trial.jump_rate, trial.slip_rate),
        *map(_flat, (trial.jump, trial.jump_rate, trial.slip_rate)),
        *(trial.opening, trial.slide, trial.cohesion, trial.path),
        *(now.opening, now.slide, now.cohesion, now.path),
        *(trial.loads, trial.drags, _flat(trial.loads), _flat(trial.drags), tangents),
        *(trial.ledger, now.ledger, ends.loaded and ends.loaded[:2]),
        *(None if drive is None else (ends.driven.freedom, drive), ends.dashpots, trial.braking),
        *(ends.quiet and ends.quiet[:2], trial.reaction),
        *(springs and tuple(springs), trial.closure, now.closure),
    )


def csr(matrix: Any) -> Any:
    """Return a matrix as kernels take it: start, column and value; None if absent."""
    return None if matrix is None else (matrix.indptr, matrix.indices, matrix.data)


def _flat(points: np.ndarray | None) -> np.ndarray | None:
    return None if points is None else points.reshape(-1)


@cache
def forces_for(parts, directions):
    """Return the kernel of `trial_forces` for joints of a law with these parts and jumps in so
    many directions, both None without joints."""
    joint_loads: Any = None if parts is None else loads_for(parts, directions)

    @formula
    def trial(
        pressure,
        u, old_u, v, mean, rate, force, drag, stiffness, viscosity, mass, dt, r, alpha, weight,
        memory, strained, elongation, old_elongation, jumps, points,
        jump, jump_rate, slip_rate, jump_vector, jump_rate_vector, slip_rate_vector,
        opening, slide, cohesion, path, old_opening, old_slide, old_cohesion, old_path,
        loads, drags, load_vector, drag_vector, tangents, ledger, old_ledger, loaded, driven,
        dashpots, braking, quiet, reaction, springs, closure, old_closure,
    ):  # fmt: skip
        """Set the forces; return the largest that is summed up, N."""
        setting, found = flush_denormals(), 0.0
        for i in range(u.size):
            mean[i] = (u[i] - old_u[i]) / dt
        if ledger is not None:
            for term in range(ledger.size):
                ledger[term] = old_ledger[term]

        # The rock. All of the force of one that remembers counts as viscous.
        if memory is None:
            for i in range(u.size):
                force[i] = -row_times(*stiffness, u, i)
                found = larger(found, force[i])
        if rate is not None:
            for i in range(u.size):
                rate[i], drag[i] = v[i], 0.0
            if viscosity is not None:
                for i in range(u.size):
                    drag[i] = -row_times(*viscosity, v, i)
                    found = larger(found, drag[i])
        if memory is not None:
            relaxed, shares, decays, gains = memory
            for i in range(u.size):
                force[i], strained[i] = 0.0, relaxed * u[i]
                for k in range(shares.size):
                    elongation[k, i] = decays[k] * old_elongation[k, i] + gains[k] * mean[i]
                    strained[i] += shares[k] * elongation[k, i]
            for i in range(u.size):
                drag[i] = -row_times(*stiffness, strained, i)
                found = larger(found, drag[i])

        # The joints, which slide by what they slip in the step, whatever the velocity at its end.
        if points is not None:
            table, area, prestress = points
            for k in range(jump_vector.size):
                jump_vector[k] = row_times(*jumps, u, k)
            if jump_rate is not None:
                for k in range(jump_vector.size):
                    jump_rate_vector[k] = row_times(*jumps, rate, k)
            if slip_rate is not None:
                for k in range(jump_vector.size):
                    slip_rate_vector[k] = row_times(*jumps, mean, k)
            for q in range(area.size):
                if opening is not None:
                    opening[q] = old_opening[q]
                if cohesion is not None:
                    cohesion[q] = old_cohesion[q]
                if path is not None:
                    path[q] = old_path[q]
                if slide is not None:
                    for d in range(slide.shape[0]):
                        slide[d, q] = old_slide[d, q]
            joint_tangents(
                parts, directions, table, area, prestress, jump, jump_rate,
                old_opening, old_slide, old_cohesion, old_path, dt, r, tangents,
            )  # fmt: skip
            sliding = joint_loads(
                table, area, prestress,
                jump, jump_rate, slip_rate, opening, slide, cohesion, path, loads, drags, dt,
            )  # fmt: skip
            if ledger is not None:
                ledger[1] += sliding
            add_transposed(*jumps, load_vector, force)
            if drags is not None:
                add_transposed(*jumps, drag_vector, drag)

        # What acts on the freedoms, and what absorbs there.
        if drag is not None:
            for i in range(u.size):
                force[i] += drag[i]
        if weight is not None:
            for i in range(u.size):
                force[i] += weight[i]
                found = larger(found, weight[i])
        if loaded is not None:
            freedom, share = loaded
            for k in range(freedom.size):
                force[freedom[k]] += share[k] * pressure
                found = larger(found, share[k] * pressure)
        if driven is not None:
            freedom, drive = driven
            for k in range(freedom.size):
                force[freedom[k]] += drive[k]
                found = larger(found, drive[k])
        if dashpots is not None:
            for k in range(dashpots.freedom.shape[0]):
                i, j = dashpots.freedom[k, 0], dashpots.freedom[k, 1]
                xx, yy, xy = (
                    dashpots.viscosity[k, 0], dashpots.viscosity[k, 1], dashpots.viscosity[k, 2],
                )  # fmt: skip
                braking[k, 0], braking[k, 1] = xx * v[i] + xy * v[j], xy * v[i] + yy * v[j]
                force[i] -= braking[k, 0]
                force[j] -= braking[k, 1]
        if quiet is not None:
            freedom, resistance = quiet
            for k in range(freedom.size):
                i = freedom[k]
                reaction[k] = resistance[k] * v[i]
                if springs is not None:
                    stiff, decay, gain = springs
                    closure[k] = decay[k] * old_closure[k] + gain[k] * mean[i]
                    reaction[k] += stiff[k] * closure[k]
                force[i] -= reaction[k]
        if mass is not None:
            for i in range(u.size):
                force[i] -= alpha * row_times(*mass, v, i)
        restore_denormals(setting)
        return found

    @jitted
    def forces(given, pressure):
        return trial(pressure, *unpacked(given))

    return forces
