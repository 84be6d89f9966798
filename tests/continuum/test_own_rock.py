"""Rock of a script: stress, quiet sides and sections by its forms, and what is refused."""

import numpy as np
import pytest
import ufl

from jointwave import continuum
from jointwave.cases.errors import SceneError
from jointwave.continuum.problem import problem_of
from jointwave.continuum.run import simulate
from jointwave.continuum.scene import body_of
from tests.continuum.bodies import LAME, SHEAR

JOINT = {"dip": 30.0, "through": [3.0, 2.0]}
LOAD = {"kind": "pressure", "side": "top", "shape": "sine", "period": 1e-3, "amplitude": 1e6}
QUIET = {"bottom": "fixed", "left": "quiet", "right": "quiet"}


def same(scene, space):
    """Return the rock of `rock_mass`."""
    return continuum.isotropic(space, 2600.0, LAME, SHEAR)


def layered(scene, space):
    """Return stiffer rock below y = 2 m: the same stress by a step in the modulus."""
    y = ufl.SpatialCoordinate(space.mesh)[1]
    shear = ufl.conditional(ufl.lt(y, 2.0), 2e10, 1e10)
    return continuum.isotropic(space, 2600.0, 0.0 * shear, shear)


@pytest.mark.parametrize(("dim", "cell"), [(2, "quadrilateral"), (2, "triangle"), (3, None)])
def test_rock_like_the_scenes_own_gives_the_same_result(rock_mass, dim, cell):
    """Stress at points, snapshots and quiet sides are those of the scene's rock."""
    record = {"points": [[2.0, 3.0, 1.0][:dim]], "fields": 5e-4}
    numerics = {} if cell is None else {"cell": cell}
    scene = rock_mass(dim=dim, loads=[LOAD], boundaries=QUIET, record=record, continuum=numerics)
    known, found = simulate(scene), simulate(scene, rock=same)
    for name in ("velocity", "stress", "field_stress"):
        scale = np.abs(known[name]).max().item()
        np.testing.assert_allclose(found[name], known[name], rtol=0, atol=1e-8 * scale)


def test_stress_of_layers_is_that_of_the_cell(rock_mass):
    """Under one stress the layers have the strains of their own moduli; no stress is lost at their
    interface, at which stress is not smoothed."""
    record = {"points": [[3.0, 0.7], [3.0, 1.9], [3.0, 2.1], [3.0, 3.3]]}
    scene = rock_mass(loads=[LOAD], record=record, continuum={"size": 0.5, "order": 2})
    found = body_of(scene, rock=layered)
    assert [one.stiffness[1, 1] for one in found.materials] == pytest.approx([2e10, 4e10])
    x, y = found.body.x.T
    sunk = -1e6 * np.where(y < 2.0, y / 4e10, 2.0 / 4e10 + (y - 2.0) / 2e10)
    readings = problem_of(scene, found).readings
    stress = (readings.stress @ np.column_stack([0 * x, sunk]).ravel()).reshape(-1, 3)
    np.testing.assert_allclose(stress, np.tile([0.0, 1e6, 0.0], (4, 1)), atol=1e-2)


def test_own_dashpots_read_as_those_of_the_scene(rock_mass):
    damping = {"rayleigh": {"ratios": [0.02, 0.02], "frequencies": [300.0, 3000.0]}}
    scene = rock_mass(loads=[LOAD], boundaries=QUIET, damping=damping)
    eta = scene.damping.rayleigh.coefficients[1]
    found = simulate(
        scene, rock=lambda _, space: continuum.isotropic(space, 2600.0, LAME, SHEAR, eta)
    )
    known = simulate(scene)
    for name in ("velocity", "stress"):
        scale = np.abs(known[name]).max().item()
        np.testing.assert_allclose(found[name], known[name], rtol=0, atol=1e-8 * scale)
    with pytest.raises(SceneError, match=r"damping.*Forms\.damping"):
        simulate(scene, rock=same)


@pytest.mark.parametrize(("dim", "cell"), [(1, "hexahedron"), (2, "hexahedron"), (2, "simplex")])
def test_sections_of_pillars_are_of_the_scripts_rock(column, dim, cell):
    """The same rock gives the same force in every section; of rock twice as dense the force in the
    loaded end is still the load, which its momentum decides."""
    numerics = {"cell": cell, "elements_per_block": 2, "scheme": "explicit"}
    scene = column(
        **{f"numerics__continuum__{key}": value for key, value in numerics.items()},
        joints__damping_ratio=None,
        record__stress=[0.0, 0.3],
        time__duration=2e-3,
    )
    density, modulus = scene.rock.density, scene.rock.intact_modulus
    nu = scene.rock.intact_poisson

    def own(rho):
        def rock(_, space):
            if dim == 1:
                return continuum.elastic(space, rho, lambda slope: modulus * slope, None)
            lame = modulus * nu / (1 - nu**2)
            return continuum.isotropic(space, rho, lame, modulus / (2 + 2 * nu))

        return rock

    known, same, heavy = (
        simulate(scene, rock=rock, dim=dim)["stress"].values
        for rock in (None, own(density), own(2 * density))
    )
    scale = np.abs(known).max()
    np.testing.assert_allclose(same, known, rtol=0, atol=1e-8 * scale)
    assert np.abs(heavy[1] - known[1]).max() > 0.05 * scale
    if cell == "hexahedron":
        np.testing.assert_allclose(heavy[0], known[0], rtol=0, atol=2e-4 * scale)  # other steps


def test_what_is_of_the_scenes_rock_is_refused(rock_mass):
    wave = {
        "kind": "P",
        "direction": [0.0, 1.0],
        "shape": "ricker",
        "period": 1e-3,
        "amplitude": 0.1,
    }
    base = {"kind": "base", "side": "bottom", "direction": [0.0, 1.0], "quantity": "velocity"}
    base |= {"shape": "sine"}
    quiet = {"boundaries": {"bottom": "quiet"}}
    with pytest.raises(SceneError, match="waves enter from the scene's rock"):
        simulate(rock_mass(waves=[wave], **quiet), rock=same)
    with pytest.raises(SceneError, match="a compliant base"):
        simulate(rock_mass(loads=[base | {"period": 1e-3, "amplitude": 0.1}], **quiet), rock=same)


def test_absorbing_ends_of_pillars_are_refused(column):
    scene = column(ends__end="quiet")
    with pytest.raises(SceneError, match="absorbing ends"):
        simulate(scene, rock=lambda _, space: continuum.elastic(space, 2e3, lambda e: 1e9 * e, 0.1))


def test_forms_that_are_no_rock_are_refused(rock_mass):
    def bedded_in_springs(scene, space):
        u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
        own = same(scene, space)
        return own._replace(stiffness=own.stiffness + 1e9 * ufl.inner(u, v) * ufl.dx)

    def damped(scene, space):
        own = same(scene, space)
        return own._replace(damping=1e-4 * continuum.isotropic(space, 1.0, LAME, 0.0).stiffness)

    scene = rock_mass(loads=[LOAD])
    with pytest.raises(SceneError, match="strains, not of displacements"):
        simulate(scene, rock=bedded_in_springs)
    with pytest.raises(SceneError, match="a time constant times the stiffness"):
        simulate(scene, rock=damped)
