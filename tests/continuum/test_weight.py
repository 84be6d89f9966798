"""Weight and mass-proportional damping act on every piece of rock, and on what sections read."""

import numpy as np
import pytest

from jointwave.continuum import simulate

STILL = {"load": {"shape": "step", "amplitude": 0.0}}
RECORD = {"stress": [0.1, 0.5, 1.3], "velocity": [0.0, 0.7]}


def test_rock_in_free_fall_carries_no_stress(short):
    """From rest at t = 0: v = g t and u = g t^2 / 2, which leapfrog steps exactly."""
    way = np.array([0.48, 0.6, -0.64])
    gravity = {"direction": way.tolist(), "static": False}
    scene = short(**STILL, gravity=gravity, record=RECORD, time__duration=2e-3)
    result = simulate(scene, "jointed", dim=3)
    t = result["time"].values[:, None]
    for quantity, fallen in (("velocity", t), ("displacement", t**2 / 2)):
        expected = 9.81 * fallen * way
        found = result[quantity].values
        assert np.abs(found - expected).max() < 1e-11 * np.abs(expected).max()
    weight = 2400.0 * 9.81 * 2.0
    assert np.abs(result["stress"].values).max() < 1e-9 * weight
    assert np.abs(result["shear"].values).max() < 1e-9 * weight


def test_rock_of_consistent_mass_in_free_fall_carries_no_stress(short):
    """Simplices, implicit steps: the weight is that of the same mass matrix."""
    way = np.array([0.6, 0.8, 0.0])
    scene = short(
        **STILL,
        gravity={"direction": way.tolist(), "static": False},
        record=RECORD,
        numerics__continuum__cell="simplex",
        numerics__continuum__mass="consistent",
        numerics__continuum__scheme="implicit",
        time__duration=2e-3,
    )
    result = simulate(scene, "jointed", dim=2)
    expected = 9.81 * result["time"].values[:, None] * way
    assert np.abs(result["velocity"].values - expected).max() < 1e-9 * expected.max()
    weight = 2400.0 * 9.81 * 2.0
    assert np.abs(result["stress"].values).max() < 1e-9 * weight
    assert np.abs(result["shear"].values).max() < 1e-9 * weight


@pytest.mark.parametrize(
    ("dim", "cell", "places"),
    [
        (1, "hexahedron", [0.25, 0.3, 1.0]),
        (3, "hexahedron", [0.25, 0.3, 1.0]),
        (3, "simplex", [0.5, 1.0, 1.5]),
    ],
)
def test_standing_rock_carries_the_weight_above(dim, cell, places, short):
    """rho g y at y below the free top, by the balance of what is above: for hexahedra everywhere,
    for simplices on the joints."""
    scene = short(
        **STILL,
        gravity={"direction": [0.0, 1.0, 0.0]},
        ends__end="fixed",
        rock__intact_poisson=0.0,
        record={"stress": places, "velocity": [0.0]},
        numerics__continuum__cell=cell,
        time__duration=2e-4,
    )
    stress = simulate(scene, "jointed", dim=dim)["stress"].values
    expected = 2400.0 * 9.81 * np.array(places)
    assert np.abs(stress - expected[:, None]).max() < 1e-8 * expected.max()


@pytest.mark.parametrize(
    "law", [{"friction_angle": 30.0}, {"friction_angle": 30.0, "tension": False}]
)
def test_joints_of_friction_alone_stand_under_weight_on_a_slope(law, short):
    """Nothing presses them before the weight is on. At 10 degrees all of a single joint holds, and
    carries the weight above it: along the joint g sin, across it g cos."""
    scene = short(
        **STILL,
        pillar__length=1.0,
        gravity={"direction": [np.sin(np.pi / 18), np.cos(np.pi / 18), 0.0]},
        ends__end="fixed",
        joints=law,
        record={"stress": [0.5], "velocity": [0.0]},
        time__duration=2e-4,
    )
    result = simulate(scene, "jointed", dim=2)
    stress, shear = (result[name].values[0].ravel() for name in ("stress", "shear"))
    weight = 2400.0 * 9.81 * 0.5
    assert stress == pytest.approx(weight * np.cos(np.pi / 18), rel=1e-8)
    assert np.abs(shear).max() == pytest.approx(weight * np.sin(np.pi / 18), rel=1e-8)


def test_drag_on_rock_that_drifts_strains_nothing(short, ready):
    """v shrinks by (1 - a) / (1 + a), a = alpha dt / 2, at every step, and no section is loaded."""
    scene = short(**STILL, damping__mass_proportional=2000.0, record=RECORD)
    run = ready(scene, "jointed", 3, samples=51)
    drift, body = np.zeros(run.state.v.size), run.discrete.body
    for c, way in enumerate([0.3, 0.7, -0.5]):
        drift[body.freedom(np.arange(len(body.x)), c)] = way
    run.state.v[:] = run.state.v_before[:] = drift
    run.take(0, 51)
    a = 1000.0 * run.time.dt
    expected = drift * ((1 - a) / (1 + a)) ** 51
    assert np.abs(run.state.v - expected).max() < 1e-12
    assert expected.max() < 0.6 * drift.max()
    assert np.abs(run.samples.stress).max() < 1e-9 * 2400.0 * 2000.0
