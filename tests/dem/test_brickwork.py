"""Brickwork between periodic sides, in the plane and in space, against its assembled equations.

Every mode of the assembled masses and springs stands in leapfrog's steps as a cosine of the
frequency Omega, sin(Omega dt / 2) = omega dt / 2, exactly.
"""

import numpy as np
import pytest

from closed_forms.bloch import leapfrog, modes, periodic
from jointwave.cases import load_tables
from jointwave.dem.kernel.leapfrog import march
from jointwave.dem.kernel.model import samples_for, state_at_rest
from jointwave.dem.prepare import prepared

BED, HEAD = (2e10, 8e9), (1e10, 5e9)  # normal and shear stiffness, Pa/m
STEPS = 2000
RULES = {"midpoint": {"point_rule": "midpoint", "contact_points": 3}, "vertices": {}}
#: Sides that repeat: through the wall, and up; its ends are free, where half bricks are.
SIDES = {2: ("bottom", "top"), 3: ("front", "back", "bottom", "top")}


def wall(dim, rule):
    """Return running bond of bricks of 0.6 m (by 0.5 m) by 0.3 m between periodic sides; rock so
    stiff that joints have their own stiffness."""
    through = [1.0] if dim == 3 else []

    def joints(name, stiffness, **keys):
        normal, shear = stiffness
        own = {"name": name, "normal_stiffness": normal, "shear_stiffness": shear}
        return own | RULES[rule] | keys

    east, north = ({"dip_direction": 90.0}, {"dip_direction": 0.0}) if dim == 3 else ({}, {})
    sets = [
        joints("bed", BED, dip=0.0, spacing=0.3),
        joints("head", HEAD, dip=90.0, spacing=0.6, ends_at=["bed"], offset=0.5, **east),
    ]
    if dim == 3:
        sets.append(joints("collar", BED, dip=90.0, spacing=0.5, **north))
    tables = {
        "title": "running bond",
        "domain": {"size": [1.8, *through, 1.2]},
        "rock": {"density": 2200.0, "intact_modulus": 1e25, "intact_poisson": 0.2},
        "joint_sets": sets,
        "boundaries": dict.fromkeys(SIDES[dim], "periodic"),
        "loads": [
            {
                "kind": "force",
                "quantity": "force",
                "at": [0.9, *([0.25] * (dim - 2)), 0.45],
                "shape": "ricker",
            }
            | {"direction": [1.0, *([0.0] * (dim - 1))], "amplitude": 1.0, "period": 1.0}
        ],
        "time": {"duration": 0.01},
        "record": {"points": [[0.9, *([0.25] * (dim - 2)), 0.45]]},
    }
    return load_tables(tables)


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("dim", [2, 3])
def test_modes_of_running_bond_stand(dim, rule):
    """To 1e-10 of the motion after 2,000 steps, from the slowest that is no rigid motion to the
    fastest. Three midpoints carry 8/9 of the bending stiffness."""
    system = prepared(wall(dim, rule))
    springs = np.array([BED, HEAD, *([BED] * (dim - 2))])
    names, cut = [one.name for one in system.blocks.scene.joint_sets], system.blocks.cut
    cell = periodic(
        cut, 2200.0, springs, names, range(1, dim), 8 / 9 if rule == "midpoint" else 1.0
    )
    omega, shapes = modes(cell, np.zeros(dim))
    assert (omega[:dim] < 1e-6 * omega[-1]).all() and omega[dim] > 1e-3 * omega[-1]
    dt = system.time.dt
    for k in (dim, dim + 1, len(omega) // 3, len(omega) // 2, len(omega) - 1):
        shape = shapes[:, k].real.reshape(cut.count, -1)
        shape = shape / np.abs(shape).max()
        turn = leapfrog(omega[k], dt) * dt
        state = state_at_rest(system.model)
        state.u[:], state.v[:] = shape, shape * 2 * np.sin(turn / 2) ** 2 / dt
        march(system.model, state, samples_for(system.model, 0), 10 * STEPS, (1, 1 + STEPS))
        np.testing.assert_allclose(state.u, shape * np.cos(turn * STEPS), rtol=0, atol=1e-10)
