"""A run by leapfrog: the arguments of its kernel, and how receivers read the state."""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.sparse import csr_matrix

from jointwave.continuum.explicit.leapfrog import leapfrog_for
from jointwave.continuum.model import Memory, Model
from jointwave.continuum.state import Samples, State
from jointwave.numerics.arguments import Packed
from jointwave.numerics.divergence import Guard

#: A matrix [receivers, fields], and what is added.
Readings = tuple[csr_matrix, np.ndarray]


def run(model: Model, state: State, samples: Samples, stride: int, first: int, last: int) -> None:
    """Take steps first .. last - 1 and a sample at every step that `stride` divides, whatever comes
    of them."""
    march(model, state, samples, stride, None)(first, last)


def march(
    model: Model,
    state: State,
    samples: Samples,
    stride: int,
    limits: Guard | None,
    link: Any = None,
    read: Readings | None = None,
) -> Callable[[int, int], int]:
    """Return a function of (first, last) that takes steps first .. last - 1, and a sample at every
    step that `stride` divides; it returns MPI's error code, 0 without.

    limits : end the run where it exceeds them; None without. link : to those who share the run,
        `continuum.parallel.exchange.Link`, who then go on to where all of them look.
    read : how receivers read the state, of `readings`; None: as the model has it.
    """
    joints = model.interfaces
    constants = (None, None) if joints is None else (joints.parts, joints.directions)
    kernel = leapfrog_for(*constants, shared=link is not None)
    read = readings(model, state) if read is None else read
    given = arguments(model, state, samples, limits, read)
    driven = model.ends.driven
    if driven is None:
        return lambda first, last: kernel(given, link, first, last, stride, model.dt)

    def in_parts(first: int, last: int) -> int:
        failed = 0
        for begin, end in driven.filled(first, last):
            failed = failed or kernel(given, link, begin, end, stride, model.dt)
            if link is None and limits is not None and limits.found[0] >= 0:
                break
        return failed

    return in_parts


def arguments(
    model: Model, state: State, samples: Samples, limits: Guard | None, read: Readings
) -> Packed:
    """Return what the kernel is given, in its order; None for what is absent."""
    rock, joints = model.rock, model.interfaces
    loaded, quiet, fixed, dashpots, driven = model.ends
    viscosity = 3 * (None,) if rock.viscosity is None else rock.viscosity[2:]
    springs = None if quiet is None else quiet.springs
    jumps: tuple[Any, ...] = 8 * (None,)
    matrix, added = read
    if joints is not None:
        along = int(np.searchsorted(joints.stencils.first, joints.area.size))
        along = 0 if joints.parts.dilation else along
        jumps = *joints.stencils, along, joints.table, joints.area, joints.prestress
    return Packed(
        *(state.u, state.v, state.v_before, state.force, state.rate, state.drag),
        *(*rock.stiffness, *viscosity),
        *(rock.step_over_mass, rock.mass, rock.decay, model.weight),
        *_memory(rock.memory, state),
        *(*jumps, state.jump, state.jump_rate, state.slip_rate),
        *(state.opening, state.slide, state.cohesion, state.path),
        *(state.loads, state.drags, _flat(state.jump), _flat(state.jump_rate)),
        *(_flat(state.slip_rate), _flat(state.loads), _flat(state.drags)),
        *(3 * (None,) if loaded is None else loaded),
        *(2 * (None,) if driven is None else (driven.freedom, driven.force)),
        *(3 * (None,) if quiet is None else quiet[:3]),
        state.reaction,
        *(3 * (None,) if springs is None else (springs.stiffness, springs.decay, springs.gain)),
        state.closure,
        *(3 * (None,) if dashpots is None else dashpots),
        state.braking,
        *(3 * (None,) if fixed is None else fixed),
        state.base_force,
        *(state.fields, matrix.indptr, matrix.indices, matrix.data, added, samples.waves),
        *(state.ledger, samples.energy),
        *(2 * (None,) if limits is None else (limits.limit.view(float)[0], limits.found)),
    )


def _memory(memory: Memory | None, state: State) -> tuple[Any, ...]:
    if memory is None:
        return 7 * (None,)
    spring = memory.share * memory.stored
    constants = memory.relaxed, memory.share, spring, memory.decay, memory.gain
    return (*constants, state.strained, state.elongation)


def _flat(points: np.ndarray | None) -> np.ndarray | None:
    return None if points is None else points.reshape(-1)


def readings(model: Model, state: State) -> Readings:
    """Return how the rows of `Samples.waves` follow from `State.fields`: a matrix, and what is
    added.

    Velocity at the step is the mean of those half a step before and after, acceleration their
    difference over dt.
    """
    r, at, dt = model.receivers, state.at, model.dt
    alpha = mass_damping(model.rock.decay, dt)
    sections, points = r.elastic.shape[0], r.point.shape[0]
    added = np.zeros(sections) if r.constant is None else r.constant
    entries = [
        (0, r.elastic, at.u if at.strained is None else at.strained),
        (0, r.viscous, at.rate),
        (0, (alpha / 2 + 1 / dt) * r.inertia, at.v),
        (0, (alpha / 2 - 1 / dt) * r.inertia, at.v_before),
        (0, r.contact, at.loads),
        (0, r.contact, at.drags),
        (sections, 0.5 * r.point, at.v),
        (sections, 0.5 * r.point, at.v_before),
        (sections + points, r.point, at.u),
        (sections + 2 * points, r.turn, at.u),
    ]
    parts = [
        (first, matrix.tocoo(), place.start)
        for first, matrix, place in entries
        if matrix is not None and place is not None
    ]
    row = np.concatenate([first + part.row for first, part, _ in parts])
    column = np.concatenate([begin + part.col for _, part, begin in parts])
    value = np.concatenate([part.data for _, part, _ in parts])
    count = sections + 2 * points + (0 if r.turn is None else r.turn.shape[0])
    matrix = csr_matrix((value, (row, column)), (count, state.fields.size))
    return matrix, np.append(added, np.zeros(count - sections))


def mass_damping(decay: float | None, dt: float) -> float:
    """Return the alpha (1/s) of mass-proportional damping that `Rock.decay` stands for."""
    return 0.0 if decay is None else 2 * (1 - decay) / (1 + decay) / dt
