"""Rock of a script: stress, quiet sides and sections by its forms, and what is refused."""

import numpy as np
import pytest
import ufl

from jointwave import continuum
from jointwave.cases.errors import SceneError
from jointwave.continuum.problem import problem_of
from jointwave.continuum.run import simulate
from jointwave.continuum.scene import body_of
from tests.continuum.bodies import LAME, PUSH, SHEAR

QUIET = {"bottom": "fixed", "left": "quiet", "right": "quiet"}
RAYLEIGH = {"rayleigh": {"ratios": [0.02, 0.02], "frequencies": [300.0, 3000.0]}}


def same(scene, space):
    """Return the rock of `rock_mass`."""
    damping = scene.damping.rayleigh
    eta = {} if damping is None else {"time_constant": damping.coefficients[1]}
    return continuum.isotropic(space, 2600.0, LAME, SHEAR, **eta)


def undamped(scene, space):
    return continuum.isotropic(space, 2600.0, LAME, SHEAR)


def layered(scene, space):
    """Return stiffer rock below y = 2 m: the same stress by a step in the modulus."""
    y = ufl.SpatialCoordinate(space.mesh)[1]
    shear = ufl.conditional(ufl.lt(y, 2.0), 2e10, 1e10)
    return continuum.isotropic(space, 2600.0, 0.0 * shear, shear)


def alike(found, known, tolerance=1e-8):
    """Hold values to others of the same rock."""
    scale = np.abs(known).max()
    np.testing.assert_allclose(found, known, rtol=0, atol=tolerance * scale)


@pytest.mark.parametrize(
    ("dim", "cell", "damping"),
    [(2, "quadrilateral", {}), (2, "triangle", RAYLEIGH), (3, None, {})],
)
def test_rock_like_the_scenes_own_gives_the_same_result(rock_mass, dim, cell, damping):
    """Stress at points, snapshots, dashpots and quiet sides are those of the scene's rock."""
    numerics = {} if cell is None else {"cell": cell}
    tables = {"loads": [PUSH], "boundaries": QUIET, "continuum": numerics}
    record = {"points": [[2.0, 3.0, 1.0][:dim]], "fields": 5e-4}
    scene = rock_mass(dim=dim, record=record, damping=damping, **tables)
    known, found = simulate(scene), simulate(scene, rock=same)
    for name in ("velocity", "stress", "field_stress"):
        alike(found[name].values, known[name].values)


def test_stress_of_layers_is_that_of_the_cell(rock_mass):
    """Under one stress the layers have the strains of their own moduli; no stress is lost at their
    interface, at which stress is not smoothed."""
    record = {"points": [[3.0, 0.7], [3.0, 1.9], [3.0, 2.1], [3.0, 3.3]]}
    scene = rock_mass(loads=[PUSH], record=record, continuum={"size": 0.5, "order": 2})
    found = body_of(scene, rock=layered)
    assert [one.stiffness[1, 1] for one in found.materials] == pytest.approx([2e10, 4e10])
    x, y = found.body.x.T
    sunk = -1e6 * np.where(y < 2.0, y / 4e10, 2.0 / 4e10 + (y - 2.0) / 2e10)
    readings = problem_of(scene, found).readings
    stress = (readings.stress @ np.column_stack([0 * x, sunk]).ravel()).reshape(-1, 3)
    np.testing.assert_allclose(stress, np.tile([0.0, 1e6, 0.0], (4, 1)), atol=1e-2)


@pytest.mark.parametrize(("dim", "cell"), [(1, "hexahedron"), (2, "hexahedron"), (2, "simplex")])
def test_sections_of_pillars_are_of_the_scripts_rock(column, dim, cell):
    """The same rock gives the same force in every section; of rock twice as dense the force in the
    loaded end is still the load, which its momentum decides."""
    scene = column(
        numerics__continuum={"cell": cell, "elements_per_block": 2, "scheme": "explicit"},
        joints__damping_ratio=None, record__stress=[0.0, 0.3], time__duration=2e-3,
    )  # fmt: skip
    rock = scene.rock
    modulus, nu = rock.intact_modulus, rock.intact_poisson

    def own(rho):
        def of(_, space):
            if dim == 1:
                return continuum.elastic(space, rho, lambda slope: modulus * slope, None)
            lame = modulus * nu / (1 - nu**2)
            return continuum.isotropic(space, rho, lame, modulus / (2 + 2 * nu))

        return of

    known, found, heavy = (
        simulate(scene, rock=one, dim=dim)["stress"].values
        for one in (None, own(rock.density), own(2 * rock.density))
    )
    alike(found, known)
    assert np.abs(heavy[1] - known[1]).max() > 0.05 * np.abs(known).max()
    if cell == "hexahedron":
        np.testing.assert_allclose(heavy[0], known[0], rtol=0, atol=2e-4 * np.abs(known).max())


def bedded_in_springs(scene, space):
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    own = same(scene, space)
    return own._replace(stiffness=own.stiffness + 1e9 * ufl.inner(u, v) * ufl.dx)


def damped_apart(scene, space):
    own = same(scene, space)
    return own._replace(damping=1e-4 * continuum.isotropic(space, 1.0, LAME, 0.0).stiffness)


PULSE = {"direction": [0.0, 1.0], "period": 1e-3, "amplitude": 0.1}
BASE = {"kind": "base", "side": "bottom", "quantity": "velocity", "shape": "sine"}
FROM_BELOW = {"boundaries": {"bottom": "quiet"}}
REFUSED = [
    (same, FROM_BELOW | {"waves": [PULSE | {"kind": "P", "shape": "ricker"}]}, "waves enter from"),
    (same, FROM_BELOW | {"loads": [PULSE | BASE]}, "a compliant base"),
    (undamped, {"loads": [PUSH], "damping": RAYLEIGH}, r"damping.*Forms\.damping"),
    (bedded_in_springs, {"loads": [PUSH]}, "strains, not of displacements"),
    (damped_apart, {"loads": [PUSH]}, "a time constant times the stiffness"),
]


@pytest.mark.parametrize(("rock", "tables", "words"), REFUSED)
def test_what_is_of_the_scenes_rock_or_is_no_rock_is_refused(rock_mass, rock, tables, words):
    with pytest.raises(SceneError, match=words):
        simulate(rock_mass(**tables), rock=rock)


def test_absorbing_ends_of_pillars_are_refused(column):
    with pytest.raises(SceneError, match="absorbing ends"):
        simulate(
            column(ends__end="quiet"),
            rock=lambda _, space: continuum.elastic(space, 2e3, lambda e: 1e9 * e, 0.1),
        )
