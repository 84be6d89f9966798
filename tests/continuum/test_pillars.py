"""Pillars by dolfinx bodies, against exact solutions and by hand."""

from typing import Any

import numpy as np
import pytest

from jointwave.cases.errors import InterruptedRun, SceneError
from jointwave.cases.loads import load_history, step_means
from jointwave.compare.exact.bar import images
from jointwave.compare.exact.bar.bars import JOINTED
from jointwave.continuum.loads.ends import force_and_moment
from jointwave.continuum.loads.forces import pushes
from jointwave.continuum.run import simulate
from jointwave.continuum.scene import body_of
from jointwave.results.dataset import energy_residual
from tests.continuum.drawing import drawn

SHORT: dict[str, Any] = {
    "pillar__length": 2.0,
    "load__amplitude": 1e5,
    "time__duration": 4e-3,
    "record__stress": [0.2, 1.0, 1.6],
    "record__velocity": [0.0, 0.3, 1.0],
    "record__interval": 5e-5,
    "numerics__continuum__elements_per_block": 1,
}
WAVE = {"shape": "sine", "amplitude": 1e5, "period": 1e-3}
STILL = {"load": {"shape": "step", "amplitude": 0.0}}
IMPLICIT = {"numerics__continuum__scheme": "implicit", "numerics__continuum__spectral_radius": 1.0}


@pytest.fixture
def short(pillar):
    """Return a function that gives four blocks of 0.5 m, one element long, keys changed."""

    def scene(numerics=None, **changes):
        own = {f"numerics__continuum__{key}": value for key, value in (numerics or {}).items()}
        return pillar(**SHORT | own | changes)

    return scene


def oblique(dim: int) -> list[float]:
    """Return a direction, in the plane or in space; along the bar."""
    return {1: [0.0, 1.0, 0.0], 2: [0.6, 0.8, 0.0], 3: [0.48, 0.6, -0.64]}[dim]


def blow(dim: int) -> dict[str, Any]:
    """Return an oblique eccentric load; that of a bar is axial."""
    at = {1: [0.0, 0.0], 2: [0.1, 0.0], 3: [0.1, -0.05]}[dim]
    return {**WAVE, "direction": oblique(dim), "at": at}


def misfit(result, exact, variable="stress"):
    """Return the relative L2 distance of two results."""
    difference = result[variable].values - exact[variable].values
    return float(np.linalg.norm(difference) / np.linalg.norm(exact[variable].values))


@pytest.mark.parametrize(
    ("model", "exact", "ends"),
    [
        ("equivalent", images.solve, "quiet"),
        ("jointed", JOINTED.run, "free"),
        ("jointed", JOINTED.run, "matched"),
    ],
)
def test_bars_meet_their_exact_solutions(pillar, model, exact, ends):
    """Joints pass and reflect, and ends absorb, as the solutions of bars have it."""
    places = {"record__stress": [5.0, 10.0, 10.2], "record__velocity": [9.75, 10.25]}
    scene = pillar(**places, pillar__length=15.0, time__duration=0.02, ends__end=ends)
    result, known = simulate(scene, model), exact(scene)
    assert misfit(result, known) < 5e-3
    assert misfit(result, known, "velocity") < 5e-3


@pytest.mark.parametrize("dim", [1, 3])
def test_energy_is_conserved(short, dim):
    """By leapfrog exactly: with dashpots, damped motion, ends and gravity from t = 0."""
    scene = short(
        joints__damping_ratio=0.05,
        damping__mass_proportional=50.0,
        gravity={"direction": oblique(dim), "static": False},
        load=blow(dim),
        ends={"start": "matched", "end": "matched"},
    )
    assert energy_residual(simulate(scene, dim=dim)) < 1e-11


def test_energy_is_conserved_where_joints_slide(short):
    joints = {"friction_angle": 20.0, "cohesion": 1e4}
    result = simulate(short(load=blow(3), joints=joints, prestress={"normal": 1e5}))
    assert energy_residual(result) < 1e-11
    energy = result["energy"]
    assert energy.sel(term="friction")[-1] > 1e-3 * energy.sel(term="work").max()
    assert "gravity" not in energy["term"]


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
        scene = short(load=WAVE | load, numerics=numerics)
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
    "keys", [{}, {"cell": "simplex", "mass": "consistent"}], ids=["lumped", "consistent"]
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
    assert misfit(other, one) < 1e-3
    for known, more in ((one, {}), (other, fine)):
        keeper = keeper_at(60)
        with pytest.raises(InterruptedRun):
            simulate(short(**keys, **more), keeper=keeper)
        found = simulate(short(**keys, **more), keeper=keeper)
        np.testing.assert_array_equal(found["velocity"], known["velocity"])


def test_a_mesh_of_the_user_runs_as_that_of_the_scene(column, tmp_path):
    """Two elements in each direction of a block, in the plane."""
    path = drawn(tmp_path / "pillar.msh", "quadrilateral")
    keys = {"load": blow(2), "time__duration": 1e-3, "record__stress": [0.0, 0.2, 0.5]}
    same = {f"numerics__continuum__elements_{way}": 2 for way in ("per_block", "across")}
    found = simulate(column(path, **keys))
    known = simulate(column(**keys, **same))
    for name in ("velocity", "stress", "shear", "rotation"):
        scale = float(np.abs(known[name]).max())
        np.testing.assert_allclose(found[name], known[name], rtol=0, atol=1e-8 * scale)


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
