"""Pillars by dolfinx bodies, against closed forms."""

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.loads import load_history, step_means
from jointwave.continuum.loads.forces import force_and_moment, pushes
from jointwave.continuum.run import simulate
from jointwave.continuum.scene import bodies_kept, body_of
from tests.continuum.bodies import BLOW, blow, oblique

STILL = {"load": {"shape": "step", "amplitude": 0.0}}
IMPLICIT = {"scheme": "implicit", "spectral_radius": 1.0}
SIMPLEX = {"cell": "simplex"}


@pytest.mark.parametrize("cell", ["hexahedron", "simplex"])
@pytest.mark.parametrize(
    "load",
    [
        {"arm": 0.2, "direction": [0.0, 1.0, 0.0]},
        {"arm": 0.1, "direction": [0.6, 0.0, -0.8]},
        {"at": [0.1, -0.05], "direction": [0.48, 0.6, -0.64]},
    ],
    ids=["torsion", "bending", "eccentric"],
)
def test_loads_have_their_force_and_moment(short, load, cell):
    """For elements of order 1 and 2, on two elements across; of 1 Pa."""
    for order in (1, 2):
        numerics = {"order": order, "cell": cell, "dim": 3, "elements_across": 2}
        scene = short(load=BLOW | load, numerics=numerics)
        body, area = body_of(scene).body, scene.pillar.area
        share = pushes(scene, body, "jointed")[0].share.reshape(-1, 3)
        force, moment = force_and_moment(scene.load)
        assert share.sum(axis=0) == pytest.approx(area * force, abs=1e-12)
        around = np.cross(body.x, share).sum(axis=0)
        assert around == pytest.approx(area * moment, abs=1e-12)


def test_runs_share_a_body_only_of_equal_rock_and_elements(short):
    """Elements follow dashpots, and the duration where pulses have no period; results do not tell
    whose body it is."""
    elements = {"numerics": {"elements_per_block": None}, "time__duration": 0.01}
    loss = {"joints__tension": False, "ends__end": "quiet"}
    scene, other = short(**STILL | elements), short(**STILL | elements | loss)
    moved = short(numerics={"scheme": "explicit"}, **loss)
    with bodies_kept():
        body = body_of(scene).body
        assert body_of(other).body is body
        for key in ("time__duration", 0.02), ("joints__damping_ratio", 0.1), ("rock__density", 2e3):
            assert body_of(short(**STILL | elements | dict([key]))).body is not body
        simulate(short(numerics={"scheme": "implicit"}))
        shared = simulate(moved)
    assert body_of(scene).body is not body
    assert simulate(moved).equals(shared) and float(abs(shared.stress).max()) > 0


@pytest.mark.parametrize(("dim", "rock"), [(2, "4.13"), (3, "1.33")])
def test_linear_elements_that_bend_are_warned_of(short, caplog, dim, rock):
    """Joints have nodes at their edges, of 3 times their second moment; so has rock in the plane,
    with 3 (h / a)^2 G / C more in shear. In space it has 1 + G / C. G / C is 3 / 8 and 1 / 3. A
    pillar sags less than half as far. Order 2 says nothing."""
    weight = {"acceleration": 0.1, "direction": [1, 0, 0], "static": True}
    sag = []
    for order in (2, 1):
        caplog.clear()
        scene = short(**STILL, gravity=weight, ends__end="fixed", numerics={"order": order})
        sag.append(float(np.abs(simulate(scene, dim=dim).displacement[..., 0]).max()))
        found = [line for line in caplog.messages if "times as stiff" in line]
        assert [f"joints 3 and rock {rock} times" in line for line in found] == [True] * (order < 2)
    assert sag[1] < sag[0] / 2


@pytest.mark.parametrize("dim", [2, 3])
def test_the_start_carries_the_load(short, dim):
    """Of each step its mean, along the pillar and across it: sections have no own error."""
    scene = short(load=blow(dim), record__stress=[0.0, 2.0])
    result = simulate(scene, dim=dim)
    stride = round(scene.interval / result.attrs["dt"])
    count = result.sizes["time"]
    load = step_means(load_history(scene), result.attrs["dt"], stride * np.arange(count))
    x, y, z = oblique(dim)
    expected = 1e5 * 1e-9
    found = result.isel(stress_y=0)
    np.testing.assert_allclose(found["stress"], y * load, rtol=0, atol=expected)
    np.testing.assert_allclose(found["shear"], np.outer(load, [x, z]), rtol=0, atol=expected)
    assert np.abs(result["stress"][1]).max() < expected


@pytest.mark.parametrize("keys", [{}, SIMPLEX | IMPLICIT], ids=["explicit", "implicit"])
def test_rock_in_free_fall_carries_no_stress(short, keys):
    """From rest at t = 0: v = g t and u = g t^2 / 2."""
    way = np.array(oblique(3))
    gravity = {"direction": way.tolist(), "static": False}
    scene = short(**STILL, gravity=gravity, numerics=keys, time__duration=1e-3)
    result = simulate(scene, dim=3)
    t = result["time"].values[:, None]
    for quantity, fallen in (("velocity", t), ("displacement", t**2 / 2)):
        expected = 9.81 * fallen * way
        error = np.abs(result[quantity].values - expected).max()
        assert error < 1e-9 * np.abs(expected).max()
    weight = 2400.0 * 9.81 * 2.0
    assert np.abs(result["stress"]).max() < 1e-9 * weight
    assert np.abs(result["shear"]).max() < 1e-9 * weight


@pytest.mark.parametrize(
    ("dim", "keys", "places"),
    [
        *((dim, keys, [0.25, 0.3, 1.0]) for dim, keys in ((1, {}), (1, IMPLICIT), (3, {}))),
        (3, SIMPLEX, [0.5, 1.0, 1.5]),
    ],
)
def test_standing_rock_carries_the_weight_above(short, dim, keys, places):
    """rho g y at y below the free top, in the rock and on joints; among simplices on joints."""
    scene = short(
        keys,
        **STILL,
        gravity={"direction": [0.0, 1.0, 0.0]},
        ends__end="fixed",
        rock__intact_poisson=0.0,
        record__stress=places,
        time__duration=2e-4,
    )
    expected = 2400.0 * 9.81 * np.array(places)
    stress = simulate(scene, dim=dim)["stress"].values
    assert np.abs(stress - expected[:, None]).max() < 1e-8 * expected.max()


@pytest.mark.parametrize("g", [0.0, 1e-10])
def test_a_prestress_in_balance_stays(short, g, plain):
    """Joints without tension that bear it stand still, also under a weight of its last digits."""
    ends = {"start": "quiet", "end": "fixed" if g else "quiet"}
    gravity = {"direction": [0.0, 1.0, 0.0], "acceleration": g} if g else None
    stress = {"normal": 2e5}
    scene = short(**STILL, prestress=stress, joints__tension=False, ends=ends, gravity=gravity)
    result = simulate(scene, dim=2)
    np.testing.assert_allclose(result["stress"], 2e5, rtol=1e-11)
    assert np.abs(result["velocity"]).max() < 1e-15


def test_rock_too_stiff_for_the_digits_of_its_sway_is_refused_as_that(short, plain):
    """Its joints hold: a column that leans by 0.002 of its weight, 0.08 of its width off centre."""
    scene = short(
        **STILL,
        pillar={"length": 40.0, "side": 0.5, "block": 0.5},
        rock=dict.fromkeys(("p_speed", "s_speed")) | {"density": 2400.0, "intact_modulus": 2e14},
        joints={"normal_stiffness": 1e10, "tension": False},
        gravity={"direction": [0.002, (1 - 4e-6) ** 0.5, 0.0]},
        ends={"start": "free", "end": "fixed"},
    )
    with pytest.raises(SceneError, match="round-off of displacements leaves an out-of-balance"):
        simulate(scene, dim=2)
