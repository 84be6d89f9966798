"""Pillars by dolfinx bodies, against closed forms."""

import numpy as np
import pytest

from jointwave.cases.errors import InterruptedRun, SceneError
from jointwave.cases.loads import load_history, step_means
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.continuum.loads.ends import force_and_moment
from jointwave.continuum.loads.forces import pushes
from jointwave.continuum.run import simulate
from jointwave.continuum.scene import body_of
from tests.continuum.bodies import BLOW, blow, oblique

STILL = {"load": {"shape": "step", "amplitude": 0.0}}
IMPLICIT = {"numerics__continuum__scheme": "implicit", "numerics__continuum__spectral_radius": 1.0}


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
        share = pushes(scene, body)[0].share.reshape(-1, 3)
        force, moment = force_and_moment(scene.load)
        assert share.sum(axis=0) == pytest.approx(area * force, abs=1e-12)
        around = np.cross(body.x, share).sum(axis=0)
        assert around == pytest.approx(area * moment, abs=1e-12)


@pytest.mark.parametrize("dim", [2, 3])
def test_the_start_carries_the_load(short, dim):
    """Of each step its mean, along the pillar and across it: sections have no own error."""
    scene = short(load=blow(dim), record__stress=[0.0, 2.0])
    result = simulate(scene, dim=dim)
    stride = round(scene.interval / result.attrs["dt"])
    count = result.sizes["time"]
    load = step_means(load_history(scene), result.attrs["dt"], count * stride)[::stride]
    x, y, z = oblique(dim)
    expected = 1e5 * 1e-9
    found = result.isel(stress_y=0)
    np.testing.assert_allclose(found["stress"], y * load, rtol=0, atol=expected)
    np.testing.assert_allclose(found["shear"], np.outer(load, [x, z]), rtol=0, atol=expected)
    assert np.abs(result["stress"][1]).max() < expected


@pytest.mark.parametrize(
    "keys", [{}, {"cell": "simplex", "scheme": "implicit"}], ids=["explicit", "implicit"]
)
def test_rock_in_free_fall_carries_no_stress(short, keys):
    """From rest at t = 0: v = g t and u = g t^2 / 2, by explicit and by implicit steps."""
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


@pytest.mark.parametrize("dim", [2, 3])
def test_sections_that_cannot_rotate_move_as_a_bar(short, dim):
    """Whatever the dimension of the mesh."""
    scene = short(load={**blow(2), "at": [0.0, 0.0]}, motion__rotation="none", ends__end="matched")
    bar, column = simulate(scene, dim=1), simulate(scene, dim=dim)
    for name in ("velocity", "stress", "shear"):
        scale = float(np.abs(bar[name]).max())
        np.testing.assert_allclose(column[name], bar[name], rtol=0, atol=1e-9 * scale)


def test_explicit_and_implicit_runs_agree_and_go_on(short, keeper_at):
    """With half joints in front of dashpots, whose closure an interrupted run has."""
    keys = {"ends__end": "matched", "joints__damping_ratio": 0.02}
    fine = {**IMPLICIT, "numerics__continuum__steps_per_period": 1000}
    one, other = simulate(short(**keys)), simulate(short(**keys, **fine))
    assert relative_l2(other["stress"].values, one["stress"].values) < 1e-3
    for known, more in ((one, {}), (other, fine)):
        keeper = keeper_at(60)
        with pytest.raises(InterruptedRun):
            simulate(short(**keys, **more), keeper=keeper)
        found = simulate(short(**keys, **more), keeper=keeper)
        np.testing.assert_array_equal(found["velocity"], known["velocity"])


@pytest.mark.parametrize(
    ("dim", "keys", "places"),
    [
        (1, {}, [0.25, 0.3, 1.0]),
        (1, IMPLICIT, [0.25, 0.3, 1.0]),
        (3, {}, [0.25, 0.3, 1.0]),
        (3, {"numerics__continuum__cell": "simplex"}, [0.5, 1.0, 1.5]),
    ],
)
def test_standing_rock_carries_the_weight_above(short, dim, keys, places):
    """rho g y at y below the free top, in the rock and on joints; among simplices on joints."""
    scene = short(
        **STILL,
        **keys,
        gravity={"direction": [0.0, 1.0, 0.0]},
        ends__end="fixed",
        rock__intact_poisson=0.0,
        record__stress=places,
        time__duration=2e-4,
    )
    expected = 2400.0 * 9.81 * np.array(places)
    stress = simulate(scene, dim=dim)["stress"].values
    assert np.abs(stress - expected[:, None]).max() < 1e-8 * expected.max()


def test_a_prestress_in_balance_stays(short):
    """Joints without tension that bear it stand still."""
    ends = {"start": "quiet", "end": "quiet"}
    scene = short(**STILL, prestress={"normal": 2e5}, joints__tension=False, ends=ends)
    result = simulate(scene)
    np.testing.assert_allclose(result["stress"], 2e5, rtol=1e-12)
    assert np.abs(result["velocity"]).max() < 1e-15


def test_mistakes_are_told_in_one_line(short):
    with pytest.raises(SceneError, match=r"model = 'rigid': must be one of jointed, equivalent"):
        simulate(short(), "rigid")
    with pytest.raises(SceneError, match=r"dim = 4: must be 1, 2 or 3"):
        simulate(short(), dim=4)
    with pytest.raises(SceneError, match=r"a bar does not bend or twist"):
        simulate(short(load__direction=[1.0, 0.0, 0.0]), dim=1)
