"""The bound on the speeds of a row in space, worked out by hand for one cause after the other.

Two blocks of 4000 kg, 2 m x 1 m x 2 m: I = 5000/3 kg m2 about x and z, 8000/3 kg m2 about y, one
joint of 1e7 N/m, steps of 0.01 s and samples at every step: a run of two steps is looked at for
one more. The bound is a velocity v of one block, and sqrt(m / I) v about an axis.
"""

import numpy as np
import pytest

from cases.schema.scene import Scene
from dem.spatial.build import state_at_rest
from dem.spatial.layout import STRIDE, packed
from dem.spatial.simulate import prepare
from dem.spatial.stability import highest_speeds

SCENE = {
    "title": "two blocks",
    "pillar": {"length": 2.0, "side": 2.0, "block": 1.0},
    "rock": {"density": 1000.0, "equivalent_modulus": 2.5e6, "equivalent_poisson": 0.25},
    "load": {"shape": "step", "amplitude": 0.0},
    "time": {"duration": 0.02},
    "record": {"stress": [1.0], "velocity": [0.5], "interval": 0.01},
    "numerics": {"dem": {"step_fraction": 0.6}},
}
ROLL, TWIST = np.sqrt(4000 * 3 / 5000), np.sqrt(4000 * 3 / 8000)
IMPULSE = 0.01 * (500.0 + 1000.0 + 1000.0)  # of a unit area by a step of 1000 Pa, N s / m2


def bounds(moved=None, **tables):
    """Return the bounds for a scene, and what `moved` [6, 2] of displacements changes of them."""
    scene = Scene.model_validate(SCENE | tables)
    p, model, time, _ = prepare(scene)
    assert time.dt == 0.01 and p.block_count == 2
    state = state_at_rest(model)
    if moved is not None:
        state.motion[:] = packed(np.concatenate([moved, np.zeros((6, 2))]), STRIDE)
    return highest_speeds(scene, p, model, state, time)


def holds(found, v):
    """Hold the bounds of six freedoms to those of a velocity v."""
    expected = [v, v, v, ROLL * v, TWIST * v, ROLL * v]
    np.testing.assert_allclose(found, expected, rtol=1e-13, atol=0)


def test_nothing_acts():
    assert not bounds().any()


LOADS = {
    "along": ({"direction": [0, 1, 0]}, 1 / 4000**2),
    # 1 N s across at the face turns the block by 1/2 m N s about its centroid.
    "across x": ({"direction": [1, 0, 0]}, (1 / 4000 + 0.25 * 3 / 5000) / 4000),
    "across z": ({"direction": [0, 0, -1]}, (1 / 4000 + 0.25 * 3 / 5000) / 4000),
    "off the axis": ({"direction": [0, 1, 0], "at": [0.5, 0]}, (1 / 4000 + 0.25 * 3 / 5000) / 4000),
    "twist": ({"direction": [0, 1, 0], "arm": 2.0}, 4 * 3 / 8000 / 4000),
}


@pytest.mark.parametrize("load, square", LOADS.values(), ids=LOADS)
def test_a_load_gives_its_impulse_to_one_block(load, square):
    """sqrt(|F|^2 / m + |M|^2 / I) over sqrt(m), with the moment about the centroid; pulling is as
    much as pushing, and the load of the step after the run counts."""
    scene = Scene.model_validate(SCENE | {"load": {"shape": "step", "amplitude": 1e3, **load}})
    stress = prepare(scene).model.load.stress
    assert stress[:3].tolist() == [500.0, 1000.0, 1000.0]
    v = 4 * 0.01 * stress.sum() * np.sqrt(square)
    holds(bounds(load={"shape": "step", "amplitude": -1e3, **load}), v)


def test_blocks_that_do_not_turn():
    """A load across them has no moment."""
    v = 4 * IMPULSE / 4000
    load = {"shape": "step", "amplitude": 1e3, "direction": [1, 0, 0]}
    np.testing.assert_allclose(bounds(load=load, motion={"rotation": "none"}), 3 * [v], rtol=1e-13)


def test_blocks_that_turn_by_any_angle():
    """Angular momenta: the largest angular velocity times the largest moment of inertia."""
    v = 4 * IMPULSE / 4000
    found = bounds(load={"shape": "step", "amplitude": 1e3}, motion={"rotation": "finite"})
    turns = 3 * [8000 / 3 * ROLL * v]
    np.testing.assert_allclose(found, [v, v, v, *turns], rtol=1e-13)


def test_weight_acts_on_both_blocks_all_the_time():
    """g t sqrt(2), in whatever direction: in the norm of the masses."""
    gravity = {"direction": [0.6, 0.0, 0.8], "acceleration": 9.0, "static": False}
    holds(bounds(gravity=gravity), np.sqrt(2) * 9.0 * 0.03)


def test_weight_has_moved_the_blocks():
    """At m g = 36 kN along (0, 1, 0) by 3 mm in all, whatever they did across it: 2 * 108 J."""
    moved = np.zeros((6, 2))
    moved[:, 0], moved[:, 1] = [0.3, 1e-3, 0, 0, 0.1, 0], [0.2, 2e-3, 0, 0, 0, 0]
    gravity = {"direction": [0, 1, 0], "acceleration": 9.0, "static": False}
    v = np.sqrt(2) * 9.0 * 0.03 + np.sqrt(2 * 36e3 * 3e-3 / 4000)
    holds(bounds(moved, gravity=gravity), v)


def test_a_prestress_presses_on_both_ends_and_is_stored():
    """2e5 N at each end for 0.03 s; 2e5 N closed a joint of 1e7 N/m, and the halves at both ends
    together as much: twice sigma^2 A / K."""
    v = 0.03 * 2 * 2e5 / 4000 + 2e5 * np.sqrt(2 / 1e7 / 4000)
    for normal in (5e4, -5e4):
        holds(bounds(prestress={"normal": normal}), v)


def test_a_base_moves_all_blocks_in_its_frame():
    """A velocity that comes to 0.2 m/s and goes on, and stops at last: sqrt(2) 0.4 m/s."""
    load = {"shape": "step", "amplitude": 0.2, "quantity": "velocity"}
    holds(bounds(load=load, ends={"start": "fixed", "end": "free"}), np.sqrt(2) * 0.4)
