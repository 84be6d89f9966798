"""A column that bends: static deflection and first mode, for every face of contact points."""

import numpy as np
import pytest

from closed_forms import cantilever, leapfrog
from jointwave import dem
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.blocks import spatial
from jointwave.dem.spatial.ends import CLOSURE

FACES = {
    "2 x 2 midpoint": ({"contact_points": 2}, 3 / 4),
    "3 x 3 midpoint": ({"contact_points": 3}, 8 / 9),
    "2 x 2 Gauss": ({"contact_points": 2, "point_rule": "gauss"}, 1.0),
}
ACROSS = {"load": {"shape": "step", "amplitude": 0.0}, "ends__end": "fixed"}
UNLOADED = {"load__direction": [0, 1, 0], "load__at": [0.0, 0.0]}
TOLERANCE = 1e-8


@pytest.mark.parametrize("joints, share", FACES.values(), ids=FACES)
@pytest.mark.parametrize("axis, turn, sign", [(0, 5, 1), (2, 3, -1)], ids="xz")
def test_static_deflection_is_the_explicit_sum(row, joints, share, axis, turn, sign):
    """What is out of balance by 1e-8 W moves no freedom by more than 1e-8 W sum |K^-1|."""
    direction = [0.0, 0.0, 0.0]
    direction[axis] = 1.0
    y = (0.25 + 0.5 * np.arange(16)).tolist()
    scene = row(
        **{**UNLOADED, **ACROSS},
        joints=joints,
        gravity={"direction": direction},
        record={"stress": [], "velocity": y, "interval": 0.01},
    )
    p, result = calibrate(scene), dem.simulate(scene)
    bending = p.regular_stiffness * share * p.side**4 / 12
    weight, shear = 9.81 * p.block_mass, p.regular_shear_stiffness * p.area
    u, theta = cantilever.deflection(16, p.spacing, weight, shear, bending)
    plane = spatial.plane(spatial.row(scene), (axis, turn))
    B = plane.relative[:, plane.blocks]
    flexibility = np.abs(np.linalg.inv(B.T @ plane.stiffness @ B)).sum(axis=1).reshape(16, 2)
    bound = TOLERANCE * 16 * weight * flexibility
    assert (np.abs(result.displacement.values[:, 0, axis] - u) <= bound[:, 0]).all()
    turned = result.rotation.values[:, 0, turn - 3]
    assert (np.abs(turned - sign * theta) <= bound[:, 1]).all()
    assert result.attrs["static_out_of_balance"] <= TOLERANCE


@pytest.mark.parametrize("joints, share", FACES.values(), ids=FACES)
def test_first_mode_swings_at_its_frequency(row, at_rest, joints, share):
    """Let go from its first bending mode, the column is in cos(Omega t) times it at every step.

    sin(Omega dt / 2) = omega dt / 2; round-off of a thousand steps.
    """
    scene = row(
        **{**UNLOADED, **ACROSS},
        joints=joints,
        gravity={"direction": [1, 0, 0], "static": False, "acceleration": 0.0},
    )
    modes = leapfrog.plane_modes(spatial.plane(spatial.row(scene), (0, 5)))
    first = np.argmin(modes.omega)
    shape = modes.shapes[:, first].reshape(16, 2)
    column, moved = at_rest(scene), np.zeros((12, 16))
    angle = 2 * np.arcsin(modes.omega[first] * column.time.dt / 2)
    moved[[0, 5]] = shape.T
    moved[[6, 11]] = (1 - np.cos(angle)) / column.time.dt * shape.T
    column.put(moved)
    u, theta = shape[-1]
    column.state.ends[1, CLOSURE, [0, 5]] = u - column.p.spacing / 2 * theta, theta
    column.take(1, 1001, guarded=False)
    expected = np.cos(1000 * angle) * shape.T
    assert np.abs(column.motion[[0, 5]] - expected).max() < 1e-10 * np.abs(shape).max()


@pytest.mark.parametrize("joints, share", FACES.values(), ids=FACES)
def test_first_frequency_is_that_of_a_slender_beam(row, joints, share):
    """1.8751^2 sqrt(E I_eff / (rho A L^4)): 100 blocks leave out less than 1e-3 of it.

    Shear and rotation of the section lower it by some 5 (1 + E / G) I / (A L^2), 1.6e-4.
    """
    scene = row(
        **{**UNLOADED, **ACROSS},
        pillar__length=50.0,
        joints=joints,
        gravity={"direction": [1, 0, 0]},
    )
    p = calibrate(scene)
    omega = leapfrog.plane_modes(spatial.plane(spatial.row(scene), (0, 5))).omega.min()
    inertia = share * p.side**4 / 12
    beam = 1.875104**2 * np.sqrt(p.modulus * inertia / (p.density * p.area * 50.0**4))
    assert omega == pytest.approx(beam, rel=1e-3)
