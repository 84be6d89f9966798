"""Rock masses in space against the same ones in the plane, and turned about the vertical."""

import numpy as np
import pytest

from jointwave.cases.read import load_tables
from jointwave.continuum import simulate

STIFFNESS = {"normal_stiffness": 2e10, "shear_stiffness": 8e9}
QUIET = {"bottom": "quiet", "left": "quiet", "right": "roller"}
#: Components in the plane by those in space.
STRESSES = {"xx": "xx", "yy": "zz", "xy": "xz"}


def scene(size, at, across, way, sides, **continuum):
    """Return four blocks 2 m long in 4 m x 3 m, cut across a direction, shaken through a quiet
    bottom; at : of a place along that direction and its height."""
    bed = {"name": "bed", "dip": 0.0, "through": at(0.0, 1.5), **STIFFNESS}
    head = {"name": "head", "dip": 90.0, "through": at(2.0, 0.0), **across, **STIFFNESS}
    shape = {"shape": "ricker", "amplitude": 0.1, "period": 2e-3, "quantity": "velocity"}
    table = {
        "title": "a slice",
        "domain": {"size": size},
        "rock": {"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.2},
        "joint_sets": [bed, head],
        "loads": [{"kind": "base", "side": "bottom", "direction": way, **shape}],
        "boundaries": sides,
        "time": {"duration": 5e-3},
        "record": {"points": [at(0.7, 0.6), at(3.3, 2.4)], "joints": [at(1.0, 1.5)]},
        "numerics": {"continuum": {"size": 1.0, **continuum}},
    }
    return load_tables(table)


def same(found, expected, tolerance):
    assert abs(found - expected).max() <= tolerance * abs(expected).max() > 0


@pytest.mark.parametrize("order", [2, 3])
def test_a_slice_between_smooth_faces_is_the_plane(order):
    """On hexahedra that are the quadrilaterals, extruded, with the same rule of quadrature, which
    those of order 1 have not. Stress is that of more places around a receiver, in space."""
    flat = scene([4.0, 3.0], lambda x, z: [x, z], {}, [0.6, 0.8], QUIET, order=order)
    smooth = QUIET | {"front": "roller", "back": "roller"}
    size, east = [4.0, 2.0, 3.0], {"dip_direction": 90.0}
    deep = scene(size, lambda x, z: [x, 0.7, z], east, [0.6, 0.0, 0.8], smooth, order=order)
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
    one = scene(size, lambda x, z: [x, 0.7, z], east, [0.48, 0.36, 0.8], held, order=1)
    sides = {"left": "front", "right": "back", "front": "right", "back": "left", "bottom": "bottom"}
    held = {sides[name]: kind for name, kind in held.items()}
    size, north = [2.0, 4.0, 3.0], {"dip_direction": 0.0}
    other = scene(size, lambda x, z: [1.3, x, z], north, [-0.36, 0.48, 0.8], held, order=1)
    found, expected = simulate(other), simulate(one).velocity.values
    x, y, z = np.moveaxis(expected, 2, 0)
    same(found.velocity.values, np.stack([-y, x, z], axis=2), 1e-9)
