"""Rock of a script: stress, quiet sides and sections by its forms, and what is refused."""

import logging

import numpy as np
import pytest
import ufl
from ufl import inner

from jointwave import continuum
from jointwave.cases.errors import SceneError
from jointwave.cases.material.constant_q import mechanisms_of
from jointwave.continuum.plan import plan_of
from jointwave.continuum.problem import problem_of
from jointwave.continuum.run import simulate
from jointwave.continuum.scene import body_of
from jointwave.continuum.space.compat import cell_constants, cell_corners
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
    ("dim", "cell", "damping", "dips"),
    [(2, "quadrilateral", {}, []), (2, "triangle", RAYLEIGH, [30.0]), (3, None, {}, [])],
)
def test_rock_like_the_scenes_own_gives_the_same_result(rock_mass, dim, cell, damping, dips):
    """Stress at points, snapshots, dashpots and quiet sides, of jointed rock too, are those of the
    scene's rock."""
    numerics = {} if cell is None else {"cell": cell}
    tables = {"loads": [PUSH], "boundaries": QUIET, "continuum": numerics}
    record = {"points": [[2.0, 3.0, 1.0][:dim]], "fields": 5e-4}
    joints = [{"dip": dip, "spacing": 2.0} for dip in dips]
    scene = rock_mass(*joints, dim=dim, record=record, damping=damping, **tables)
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


def changed(name, of):
    """Return rock with another form, an integrand of trial and test function, strains and rock."""

    def rock(scene, space):
        u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
        own = same(scene, space)
        form = of(u, v, ufl.sym(ufl.grad(u)), ufl.sym(ufl.grad(v)))
        return own._replace(**{name: form * ufl.dx})

    return rock


def springs(u, v, a, b):
    return 2 * SHEAR * inner(a, b) + 1e9 * inner(u, v)


def one_way(u, v, a, b):
    return 2 * SHEAR * inner(a, b) + SHEAR * a[0, 0] * b[1, 1]


def carried_along(u, v, a, b):
    return 2 * SHEAR * inner(a, b) + 1e9 * inner(ufl.grad(u) * ufl.as_vector([1.0, 0.0]), v)


#: Forms that are of no rock, and the words of their refusal.
NO_ROCK = [
    ("stiffness", springs, "strains, not of displacements or rotations"),
    ("stiffness", carried_along, "strains, not of displacements or rotations"),
    ("stiffness", lambda u, v, a, b: SHEAR * inner(ufl.grad(u), ufl.grad(v)), "or rotations"),
    ("stiffness", one_way, "symmetric in trial and test function"),
    ("stiffness", lambda u, v, a, b: inner(u, u) * inner(a, b), "linear in the displacement"),
    ("stiffness", lambda u, v, a, b: inner(a, a) + 0 * v[0], "a form of a trial and a test"),
    ("stiffness", lambda u, v, a, b: -SHEAR * inner(a, b), r"a modulus of -2.08e\+10 Pa"),
    ("mass", lambda u, v, a, b: -2600.0 * inner(u, v), "density above 0"),
    ("mass", lambda u, v, a, b: 2600.0 * (inner(u, v) + u[0] * v[0]), "one for all directions"),
    ("mass", lambda u, v, a, b: 2600.0 * (inner(u, v) + u[0] * v[1] + u[1] * v[0]), "one for all"),
    ("mass", lambda u, v, a, b: 2600.0 * (inner(u, v) + inner(a, b)), r"times u \. v"),
    ("damping", lambda u, v, a, b: 2e6 * inner(a, b), "a time constant, not below 0, times"),
    ("damping", lambda u, v, a, b: 1e3 * inner(u, v), "a time constant, not below 0, times"),
]


PULSE = {"direction": [0.0, 1.0], "period": 1e-3, "amplitude": 0.1}
BASE = {"kind": "base", "side": "bottom", "quantity": "velocity", "shape": "sine"}
FROM_BELOW = {"boundaries": {"bottom": "quiet"}}
REFUSED = [
    (same, FROM_BELOW | {"waves": [PULSE | {"kind": "P", "shape": "ricker"}]}, "waves enter from"),
    (same, FROM_BELOW | {"loads": [PULSE | BASE]}, "a compliant base"),
    (undamped, {"loads": [PUSH], "damping": RAYLEIGH}, r"damping.*Forms\.damping"),
    (lambda *_: None, {"loads": [PUSH]}, r"must return Forms\(mass, stiffness, damping\)"),
    (lambda _, space: continuum.isotropic(space, 2600.0, LAME, SHEAR, -1e-6), {}, "not below 0"),
    *((changed(name, of), {"loads": [PUSH]}, words) for name, of, words in NO_ROCK),
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


COLUMN = {
    "domain": {"size": [1.0, 8.0]},
    "loads": [PUSH | {"shape": "ricker"}],
    "boundaries": {"left": "periodic", "right": "periodic", "bottom": "quiet"},
    "time": {"duration": 3e-3},
    "record": {"points": [[0.5, 2.0]]},
}


@pytest.mark.parametrize("name", ["modulus", "density"])
@pytest.mark.parametrize("order", [1, 2, 4])
def test_a_jump_at_nodes_of_faces_is_that_of_cells(name, order, rock_mass):
    """By a condition on coordinates as by a function that is constant in each cell."""

    def rock(jump):
        def of(scene, space):
            modulus, rho = (jump(space) if name == one else 1.0 for one in ("modulus", "density"))
            return continuum.isotropic(space, 2600.0 * rho, LAME * modulus, SHEAR * modulus)

        return of

    def by_place(space):
        return ufl.conditional(ufl.lt(ufl.SpatialCoordinate(space.mesh)[1], 4.0), 3.0, 1.0)

    def by_cell(space):
        middle = cell_corners(space.mesh).mean(axis=1)[:, 1]
        return cell_constants(space.mesh, np.where(middle < 4.0, 3.0, 1.0)[:, None])[0]

    scene = rock_mass(**COLUMN, continuum={"size": 0.5, "order": order})
    found, known = (simulate(scene, rock=rock(jump)) for jump in (by_place, by_cell))
    alike(found["velocity"].values, known["velocity"].values)


def test_quiet_sides_absorb_at_the_reference_frequency(rock_mass):
    """The same rock with a quality factor, by unrelaxed moduli."""
    rock = {"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.2, "quality_factor": 10}
    scene = rock_mass(**COLUMN, rock=rock)
    more = mechanisms_of(scene, "jointed").unrelaxed

    def unrelaxed(_, space):
        return continuum.isotropic(space, 2600.0, LAME * more, SHEAR * more)

    found, known = simulate(scene, rock=unrelaxed), simulate(scene)
    alike(found["velocity"].values, known["velocity"].values)


def test_cells_too_large_for_a_scripts_rock_are_warned_of(rock_mass, caplog):
    """Elements fit the scene's rock: that of the script is a hundred times softer."""
    scene = rock_mass(**COLUMN, continuum={"size": None, "order": 2})
    with caplog.at_level(logging.WARNING):
        plan_of(scene, rock=same)
        assert not caplog.records
        plan_of(scene, rock=lambda _, space: continuum.isotropic(space, 2600.0, 0.0, SHEAR / 100))
    assert "rock of a script: elements at [" in caplog.text
    assert "nodes per wavelength" in caplog.text and "numerics.continuum.size = " in caplog.text
