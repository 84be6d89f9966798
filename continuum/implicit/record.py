"""Record of implicit steps: receivers and energies of a state in balance."""

from collections.abc import Callable
from functools import cache

import numpy as np

from jointwave.continuum.explicit.leapfrog import read
from jointwave.continuum.explicit.march import Readings
from jointwave.continuum.implicit.balance import Matrices, csr
from jointwave.continuum.implicit.vectors import row_times
from jointwave.continuum.model import Model
from jointwave.continuum.space.tractions import joint_energy
from jointwave.continuum.state import STATES, Samples, State
from jointwave.joints.formula import formula
from jointwave.numerics.arguments import Packed, unpacked
from jointwave.numerics.jit import jitted


def recorder(
    model: Model,
    rock: Matrices,
    readings: Readings,
    state: State,
    acceleration: np.ndarray,
    samples: Samples,
) -> Callable[[int], None]:
    """Return the function of s that records sample s of a state in balance: receivers and ledger.

    readings : of `continuum.explicit.march.readings`, which take velocities half a step before and
    after. acceleration : [n], m/s2, as it is then.
    """
    matrix, added = readings
    memory, joints, seen = model.rock.memory, model.interfaces, np.zeros_like(state.fields)
    points = joints and (joints.table, joints.area, joints.prestress)
    springs = memory and (memory.relaxed, memory.share * memory.stored)
    given = Packed(
        *(state.fields, seen, seen[state.at.v], seen[state.at.v_before], acceleration, model.dt),
        *(csr(matrix), added, samples.waves, samples.energy, state.u, state.v),
        *(csr(rock.mass), csr(rock.stiffness), model.weight, springs, state.elongation),
        *(points, state.jump, state.opening, state.slide, state.path, state.ledger),
    )
    kernel = sample_for(*(2 * (None,) if joints is None else (joints.parts, joints.directions)))
    return lambda s: kernel(given, s)


@cache
def sample_for(parts, directions):
    """Return the kernel of `recorder` for joints of a law with these parts and jumps in so many
    directions, both None without joints."""

    @formula
    def take(
        s,
        fields, seen, seen_v, seen_v_before, acceleration, dt, readings, added, waves, energy,
        u, v, mass, stiffness, weight, springs, elongation,
        points, jump, opening, slide, path, ledger,
    ):  # fmt: skip
        """Take sample s."""
        for i in range(fields.size):
            seen[i] = fields[i]
        for i in range(v.size):
            half = 0.5 * dt * acceleration[i]
            seen_v[i], seen_v_before[i] = v[i] + half, v[i] - half
        read(seen, *readings, added, waves, s)
        if energy is not None:
            stored, spent, kinetic, elastic, fallen = 0.0, 0.0, 0.0, 0.0, 0.0
            if points is not None:
                table, area, prestress = points
                stored, spent = joint_energy(
                    parts, directions, table, area, prestress, jump, opening, slide, path
                )
            relaxed = 1.0 if springs is None else springs[0]
            for i in range(u.size):
                kinetic += 0.5 * v[i] * row_times(*mass, v, i)
                elastic += 0.5 * relaxed * u[i] * row_times(*stiffness, u, i)
                if weight is not None:
                    fallen += weight[i] * u[i]
            if springs is not None:
                for k in range(elongation.shape[0]):
                    e = elongation[k]
                    for i in range(u.size):
                        elastic += 0.5 * springs[1][k] * e[i] * row_times(*stiffness, e, i)
            energy[0, s], energy[1, s] = kinetic, elastic + stored
            energy[2, s], energy[3, s] = spent, -fallen
            for term in range(ledger.size):
                energy[STATES + term, s] = ledger[term]
            if springs is not None:
                energy[STATES, s] -= elastic

    @jitted
    def sample(given, s):
        take(s, *unpacked(given))

    return sample
