"""The laws are pure arithmetic: a loop over points compiles to vector instructions."""

import numpy as np
import pytest

from joints.laws import Law, law_of, normal_traction
from joints.shear import cohesion_left, shear_return, shear_strength
from joints.softening import update_opening
from numerics.jit import jitted

PARTS = {
    "normal_stiffness": 9e9,
    "normal_viscosity": 1e5,
    "carries_tension": False,
    "shear_stiffness": 3e9,
    "shear_viscosity": 3e4,
    "cohesion": 1e6,
    "friction": 0.5,
    "residual_cohesion": 1e5,
    "tensile_strength": 1e6,
    "critical_opening": 1e-3,
}
ELASTIC = {"normal_stiffness", "shear_stiffness"}
SOFTENING = {"tensile_strength", "critical_opening"}


@jitted
def read(values, i):
    """Return a value, or None of None."""
    if values is None:
        return None
    return values[i]


@jitted
def write(values, i, value):
    """Keep a value where there is a place for it."""
    if values is not None:
        values[i] = value


@jitted
def load_points(law, motion, memory, force, dt):
    """Set the traction at every point of a face from its motion."""
    opening, ex, ez, cohesion = memory
    gap, gap_rate, dx, dz = motion
    for i in range(gap.size):
        one = law_of(law, i)
        k = update_opening(read(opening, i), gap[i])
        t_n = normal_traction(one, gap[i], gap_rate[i], k)
        tau = shear_strength(one, t_n, gap[i], k, read(cohesion, i))
        x, z = ex[i] + dx[i], ez[i] + dz[i]
        t_x, t_z, x, z, slipped = shear_return(
            one, x, z, ex[i], ez[i], dx[i] / dt, dz[i] / dt, tau, dt
        )
        force[0, i], force[1, i], force[2, i] = t_x, t_n, t_z
        write(opening, i, k)
        ex[i], ez[i] = x, z
        write(cohesion, i, cohesion_left(one, read(cohesion, i), slipped))


@pytest.mark.parametrize("alike", [True, False], ids=["one law", "a law each"])
@pytest.mark.parametrize(
    "parts",
    [
        ELASTIC,
        {*ELASTIC, "carries_tension"},
        {*ELASTIC, "friction", "normal_viscosity", "shear_viscosity"},
        PARTS.keys() - SOFTENING,
        PARTS.keys() - {"carries_tension"},
    ],
    ids=["elastic", "no tension", "friction", "all of shear", "all of softening"],
)
def test_loop_over_points_is_vectorised(parts, alike, instructions):
    """Products of several points at once, of whatever width the machine has."""
    n = 64

    def rows(count, wanted=True):
        return tuple(np.zeros(n) for _ in range(count)) if wanted else (None,) * count

    values = {name: part for name, part in PARTS.items() if name in parts}
    if not alike:
        values = {name: np.full(n, part) for name, part in values.items()}
    law = Law(**values)
    memory = (
        *rows(1, law.tensile_strength is not None),
        *rows(2),
        *rows(1, law.residual_cohesion is not None),
    )
    arguments = (law, rows(4), memory, np.zeros((3, n)), 1e-5)
    assert instructions(load_points, arguments, r"fmul <\d+ x double>") > 0
