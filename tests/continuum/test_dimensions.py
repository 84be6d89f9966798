"""One, two and three dimensions are one model: with Poisson's ratio 0 they move alike.

Rock that does not widen, under a load that is uniform over the face, has no motion across; one
hexahedron across then has the bar's nodes, masses and springs, each shared out over the corners of
its section. So the discrete systems are the same, and only round-off tells their runs apart.
Rock masses in space are the same ones in the plane, and turn about the vertical."""

import numpy as np
import pytest

from jointwave.continuum.plan import plan_of
from jointwave.continuum.run import simulate
from tests.continuum.bodies import STIFFNESS
from tests.rocks import rock

ROUND_OFF = 1e-11

ROCK = {"rock__intact_poisson": 0.0}
MASS = {"rock__equivalent_modulus": 4.4e9, "rock__equivalent_poisson": 0.0}
MASS |= {"rock__p_speed": None, "rock__s_speed": None}
EXPLICIT = {
    "numerics__continuum__scheme": "explicit",
    "numerics__continuum__step_fraction": 0.5,
    "time__duration": 3e-3,  # a wave in the rock passes the pillar nine times
}
STEEL = {"density": 7850.0, "intact_modulus": 2.1e11, "intact_poisson": 0.0, "block": 0.5}
#: The load ends in tension, so that joints let go.
SINE = {"shape": "sine", "amplitude": 1e5, "period": 1e-3}
#: Joints that soften or carry no tension, damped, beside a bar of steel, on a base that is shaken.
EVERYTHING = {
    "segments": [{"y": [1.0, 2.0], "joints": False, **STEEL}],
    "joints": {"tensile_strength": 3e4, "fracture_energy": 0.3, "damping_ratio": 0.05},
    "soft_layers": [{"y": 1.0, "spacing_stiffness": 4.4e8, "damping_ratio": 0.1, "tension": False}],
    "load": {"shape": "sine", "amplitude": -0.1, "period": 1e-3, "quantity": "velocity"},
    "ends": {"start": "fixed", "end": "matched"},
    "damping__mass_proportional": 50.0,
    "prestress": {"normal": 3e3},
}


@pytest.fixture
def moved(short):
    """Return a function of a model, dimensions and keys that gives the results in one dimension and
    in these, sampled at each step: half the least of the critical ones."""

    def results(model, *dims, **keys):
        probe = short(**EXPLICIT | keys)
        dt = 0.499 * min(plan_of(probe, model, dim=dim).critical for dim in dims)
        record = probe.record.model_copy(update={"interval": dt})
        scene = probe.model_copy(update={"record": record})
        found = [simulate(scene, model, dim=dim) for dim in (1, *dims)]
        assert {one.attrs["dt"] for one in found} == {dt}
        return found

    return results


def axial(result):
    """Return the waves along the axis, and the terms of the ledger that are no round-off."""
    waves = {name: result[name].sel(axis="y").values for name in ("velocity", "displacement")}
    peaks = np.abs(result["energy"]).max("time")
    terms = result["energy"].sel(term=peaks > ROUND_OFF * peaks.max())
    energy = {term: terms.sel(term=term).values for term in terms["term"].values}
    return {"stress": result["stress"].values, **waves, **energy}


def across(result):
    """Return everything that has moved across or been sheared, as numbers."""
    motion = [result[name].sel(axis=["x", "z"]) for name in ("velocity", "displacement")]
    every = [*motion, result["shear"], result["rotation"]]
    return np.concatenate([one.values.ravel() for one in every])


def compare(one, *others):
    """Compare results of all dimensions, relative to the largest of each kind."""
    for other in others:
        alike(axial(other), axial(one))
        assert np.abs(across(other)).max() < ROUND_OFF * np.abs(one["stress"]).max()


def alike(found, expected):
    """Assert that waves differ by round-off alone, relative to the largest of each kind."""
    assert found.keys() == expected.keys()
    for name, waves in expected.items():
        peak = np.abs(waves).max()
        assert peak > 0, name
        assert np.abs(found[name] - waves).max() < ROUND_OFF * peak, name


def test_jointed_rock_moves_alike_in_a_bar_and_in_space(moved):
    one, other = moved("jointed", 3, **ROCK, **EVERYTHING)
    compare(one, other)
    spent = one["energy"].isel(time=-1)
    assert min(spent.sel(term=x) for x in ("viscous", "fracture", "boundary")) > 0
    assert one["stress"].sel(stress_y=1.0).min() < 1e-9 * one["stress"].max()  # it opens


@pytest.mark.parametrize("order", [1, 3, 4])
def test_so_it_does_at_every_order(order, moved):
    compare(*moved("jointed", 2, 3, load=SINE, numerics__continuum__order=order, **ROCK))


def test_homogenised_rock_moves_alike_in_all_dimensions(moved):
    layer = [{"y": 1.0, "spacing_stiffness": 4.4e8}]
    compare(*moved("equivalent", 2, 3, load=SINE, soft_layers=layer, **MASS))


SLIDING = {"friction_angle": 30.0, "cohesion": 1e4, "damping_ratio": 0.02}


@pytest.mark.parametrize(
    ("dim", "way"),
    [pytest.param(2, [0.6, 0.8, 0.0], marks=pytest.mark.slow), (3, [0.48, 0.8, 0.36])],
)
def test_plane_sections_that_slide_move_as_the_bar_across(dim, way, moved):
    """Sections that move as one, motion.rotation = "none", are the bar with E along and G across,
    at any Poisson's ratio. Joints slide and open by the same law."""
    one, other = moved(
        "jointed",
        dim,
        load={**SINE, "direction": way},
        motion__rotation="none",
        joints={**SLIDING, "tension": False},
        ends__end="matched",
    )
    alike(axial(other), axial(one))
    names = ("shear", "velocity", "displacement")
    alike({name: other[name].values for name in names}, {name: one[name].values for name in names})
    spent = one["energy"].isel(time=-1)
    assert spent.sel(term="friction") > 0.01 * spent.sel(term="work")


SPRINGS = dict(zip(("normal_stiffness", "shear_stiffness"), STIFFNESS, strict=True))
QUIET = {"bottom": "quiet", "left": "quiet", "right": "roller"}
#: Components in the plane by those in space.
STRESSES = {"xx": "xx", "yy": "zz", "xy": "xz"}


def slice_of(size, at, across, way, sides, **continuum):
    """Return four blocks 2 m long in 4 m x 3 m, cut across a direction, shaken through a quiet
    bottom; at : of a place along that direction and its height."""
    sets = [{"dip": 0.0, "through": at(0.0, 1.5)}, {"dip": 90.0, "through": at(2.0, 0.0)} | across]
    shape = {"shape": "ricker", "amplitude": 0.1, "period": 2e-3, "quantity": "velocity"}
    return rock(
        *(size, sets, SPRINGS),
        loads=[{"kind": "base", "side": "bottom", "direction": way, **shape}],
        boundaries=sides,
        time={"duration": 5e-3},
        record={"points": [at(0.7, 0.6), at(3.3, 2.4)], "joints": [at(1.0, 1.5)]},
        numerics={"continuum": {"size": 1.0, **continuum}},
    )


def same(found, expected, tolerance):
    assert abs(found - expected).max() <= tolerance * abs(expected).max() > 0


@pytest.mark.parametrize("order", [2, 3])
def test_a_slice_between_smooth_faces_is_the_plane(order):
    """On hexahedra that are the quadrilaterals, extruded, with the same rule of quadrature, which
    those of order 1 have not. Stress is that of more places around a receiver, in space."""
    flat = slice_of([4.0, 3.0], lambda x, z: [x, z], {}, [0.6, 0.8], QUIET, order=order)
    smooth = QUIET | {"front": "roller", "back": "roller"}
    size, east = [4.0, 2.0, 3.0], {"dip_direction": 90.0}
    deep = slice_of(size, lambda x, z: [x, 0.7, z], east, [0.6, 0.0, 0.8], smooth, order=order)
    plane, space = simulate(flat), simulate(deep)
    assert plane.attrs["cell"] == "quadrilateral" and space.attrs["cell"] == "hexahedron"
    for name in ("velocity", "displacement"):
        same(space[name].sel(axis=["x", "z"]).values, plane[name].values, 1e-9)
        same(space[name].values, space[name].where(space.axis != "y", 0.0).values, 1e-9)
    found = space.stress.sel(stress_component=[*STRESSES.values()]).values
    same(found, plane.stress.sel(stress_component=[*STRESSES]).values, 1e-2)
    along = 0.2 * plane.stress.sel(stress_component=["xx", "yy"]).sum("stress_component")
    same(space.stress.sel(stress_component="yy").values, along.values, 1e-2)
    same(space.gap.values, plane.gap.values, 1e-9)
    same(abs(space.slip.sel(slip_axis="strike").values), abs(plane.slip.values), 1e-9)
    total = plane.energy.sum("term") * 2.0
    same(space.energy.sum("term").values, total.values, 1e-9)


def test_a_turned_scene_has_turned_results():
    """By 90 degrees about the vertical: east becomes north, and north west."""
    held = QUIET | {"front": "free", "back": "roller"}
    size, east = [4.0, 2.0, 3.0], {"dip_direction": 90.0}
    one = slice_of(size, lambda x, z: [x, 0.7, z], east, [0.48, 0.36, 0.8], held, order=1)
    sides = {"left": "front", "right": "back", "front": "right", "back": "left", "bottom": "bottom"}
    held = {sides[name]: kind for name, kind in held.items()}
    size, north = [2.0, 4.0, 3.0], {"dip_direction": 0.0}
    other = slice_of(size, lambda x, z: [1.3, x, z], north, [-0.36, 0.48, 0.8], held, order=1)
    found, expected = simulate(other), simulate(one).velocity.values
    x, y, z = np.moveaxis(expected, 2, 0)
    same(found.velocity.values, np.stack([-y, x, z], axis=2), 1e-9)
