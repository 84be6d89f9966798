"""Rigid blocks of rock masses in space: momenta, energies, and scenes that are turned or that
repeat the plane."""

import numpy as np
import pytest

from jointwave.cases import load_tables
from jointwave.dem import simulate
from jointwave.dem.kernel.leapfrog import march
from jointwave.dem.kernel.model import samples_for, state_at_rest
from jointwave.dem.prepare import prepared
from jointwave.results.dataset import energy_residual
from tests.rocks import rock

DAMPED, SLIPS = {"damping_ratio": 0.1}, {"friction_angle": 20.0, "tension": False}
STIFF = {"normal_stiffness": 2e10, "shear_stiffness": 8e9}
#: Dip and dip direction of joints, none of which are parallel.
ATTITUDES = [(0.0, 0.0), (70.0, 80.0), (80.0, 350.0)]
PUSH = {"kind": "pressure", "side": "left", "shape": "ricker", "amplitude": 4e4, "period": 2e-3}


def oblique(law=(), **changes):
    """Return 4 m x 3 m x 2 m in blocks between three sets, loaded on its left; tables changed."""
    sets = [{"dip": dip, "dip_direction": way, "spacing": 0.9} for dip, way in ATTITUDES]
    tables = {
        "domain": {"size": [4.0, 3.0, 2.0], "slivers": "merge", "least_width": 0.03},
        "loads": [PUSH],
        "time": {"duration": 4e-3},
        "record": {"points": [[2.2, 1.4, 0.8]], "interval": 5e-5, "energy": True},
    }
    law = STIFF | {"through": [2.03, 1.51, 0.97]} | dict(law)
    return rock([4.0, 3.0, 2.0], sets, law, **tables | changes)


def moving(scene):
    """Return a system and a state with random velocities."""
    system = prepared(scene)
    state = state_at_rest(system.model)
    state.v[:] = np.random.default_rng(3).uniform(-0.1, 0.1, state.v.shape)
    return system, state


def momenta(system, state):
    """Return linear momentum [3] and angular momentum about the origin [3], and their sizes."""
    masses, v = system.blocks.masses, state.v[: system.blocks.cut.count]
    own = (masses @ v[:, :, None])[..., 0]
    turning = np.cross(system.blocks.cut.centroid, own[:, :3]) + own[:, 3:]
    sizes = [np.abs(one).sum() for one in (own[:, :3], turning)]
    return own[:, :3].sum(axis=0), turning.sum(axis=0), *sizes


@pytest.mark.parametrize("law", [DAMPED, SLIPS], ids=["dashpots", "slip"])
def test_momenta_are_conserved(law):
    """Of free blocks with products of inertia, whatever their joints do; the load does not act."""
    system, state = moving(oblique(law))
    assert system.model.form.oblique and system.model.form.points == (law is SLIPS)
    linear, angular, size, turned = momenta(system, state)
    march(system.model, state, samples_for(system.model, 0), 1000, (1, 401))
    after, spun, *_ = momenta(system, state)
    np.testing.assert_allclose(after, linear, rtol=0, atol=1e-12 * size)
    np.testing.assert_allclose(spun, angular, rtol=0, atol=1e-12 * turned)


def test_the_ledger_closes_where_joints_are_linear():
    """At any length of step, with quiet sides."""
    found = simulate(oblique(DAMPED, boundaries={"right": "quiet", "bottom": "roller"}))
    assert found.energy.sel(term="boundary")[-1] > 0 and energy_residual(found) < 1e-10


def test_a_scene_that_is_turned_about_z_moves_as_the_other():
    """By a right angle: x to y, and y to -x."""
    own, turned = oblique(SLIPS), oblique(SLIPS).model_dump(exclude_none=True, exclude_unset=True)
    for one in turned["joint_sets"]:
        x, y, z = one["through"]
        one["dip_direction"] = (one["dip_direction"] - 90.0) % 360.0
        one["through"] = [3.0 - y, x, z]
    turned["domain"]["size"] = [3.0, 4.0, 2.0]
    turned["loads"][0]["side"] = "front"
    turned["record"]["points"] = [[3.0 - 1.4, 2.2, 0.8]]
    one, other = simulate(own).velocity.values, simulate(load_tables(turned)).velocity.values
    expected = np.stack([-one[..., 1], one[..., 0], one[..., 2]], axis=-1)
    assert np.abs(one).min(axis=(0, 1)).max() < np.abs(one).max()
    np.testing.assert_allclose(other, expected, rtol=0, atol=1e-9 * np.abs(one).max())


def in_plane(space, spaced):
    """Return a scene of joints that are alone and slip, or of two linear sets in rock that is cut,
    in the plane, or in space 1 m deep between rollers: x is x, and y is z."""
    places = [(30.0, 3.1, 4.2), (30.0, 7.7, 5.1), (-55.0, 4.3, 6.2), (-55.0, 8.6, 3.9)]
    if spaced:
        places = places[::2]
    sets = [{"dip": dip, "through": [x, y]} for dip, x, y in places]
    sides, depth = {"left": "quiet", "bottom": "roller"}, [0.5] * space
    if space:
        sides |= {"front": "roller", "back": "roller"}
        for one, (dip, x, y) in zip(sets, places, strict=True):
            one |= {"dip_direction": 270.0 if dip > 0 else 90.0, "through": [x, 0.5, y]}
            one["dip"] = abs(dip)
    return rock(
        [12.0, *(2 * y for y in depth), 10.0],
        sets,
        STIFF | ({"spacing": 3.0} if spaced else SLIPS),
        boundaries=sides,
        loads=[PUSH | {"side": "right", "amplitude": 2e5, "period": 0.1}],
        time={"duration": 0.1},
        numerics={"dem": {"block": 1.5} if spaced else {}},
        record={
            "points": [[2.0, *depth, 2.0], [10.0, *depth, 8.0]],
            "joints": [[7.7, *depth, 5.1]],
            "interval": 2e-5,  # the step of both
            "energy": True,
        },
    )


@pytest.mark.parametrize("spaced", [False, True], ids=["slip", "rock"])
def test_a_plane_scene_between_rollers_equals_the_plane(spaced):
    """Slip, opening, the ledger and the rock's share of compliance included: no block tilts."""
    flat, deep = simulate(in_plane(False, spaced)), simulate(in_plane(True, spaced))
    scale = np.abs(flat.velocity).max().item()
    assert deep.attrs["blocks"] == flat.attrs["blocks"] > 6
    assert spaced or flat.energy.sel(term="friction")[-1] > 0
    assert deep.attrs["dt"] == flat.attrs["dt"]
    within = deep.velocity.sel(axis=["x", "z"])
    np.testing.assert_allclose(within, flat.velocity, rtol=0, atol=1e-9 * scale)
    assert np.abs(deep.velocity.sel(axis="y")).max() < 1e-12 * scale
