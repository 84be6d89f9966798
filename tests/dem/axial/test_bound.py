"""The bound on the speed of a chain, worked out by hand for one cause after the other.

Two blocks of 4000 kg on one joint of 1e7 N/m, steps of 0.01 s, samples at every step: a run of two
steps is looked at for one more.
"""

import numpy as np
import pytest

from cases.schema.scene import Scene
from dem.axial.build import build
from dem.axial.stability import highest_speed

SCENE = {
    "title": "two blocks",
    "pillar": {"length": 2.0, "side": 2.0, "block": 1.0},
    "rock": {"density": 1000.0, "equivalent_modulus": 2.5e6, "equivalent_poisson": 0.25},
    "load": {"shape": "step", "amplitude": 0.0},
    "time": {"duration": 0.02},
    "record": {"stress": [1.0], "velocity": [0.5], "interval": 0.01},
    "numerics": {"dem": {"step_fraction": 0.6}},
}


def bound(change=None, **tables):
    """Return the bound for a scene, whose state at rest `change` changes, m/s."""
    model, state, time, _ = build(Scene.model_validate(SCENE | tables))
    assert time.dt == 0.01 and state.u.size == 2
    if change is not None:
        change(model, state)
    return highest_speed(model, state, time)


def test_nothing_acts():
    assert bound() == 0.0


def test_a_load_gives_its_impulse_to_one_block():
    """Means over the steps of 2000, 4000, 4000 N: 100 N s, or as long as the record lasts."""
    model, *_ = build(Scene.model_validate(SCENE | {"load": {"shape": "step", "amplitude": 1e3}}))
    assert model.load[:2].tolist() == [2000.0, 4000.0]
    expected = 0.01 * model.load.sum() / 4000
    assert bound(load={"shape": "step", "amplitude": -1e3}) == pytest.approx(expected, rel=1e-14)


def test_weight_acts_on_both_blocks_all_the_time():
    """g t sqrt(2): in the norm of the masses."""
    gravity = {"direction": [0, 1, 0], "acceleration": 9.0, "static": False}
    assert bound(gravity=gravity) == pytest.approx(np.sqrt(2) * 9.0 * 0.03, rel=1e-14)


def test_a_prestress_pushes_at_both_ends():
    """5e4 Pa on 4 m2 at each of two free ends, for 0.03 s, on 4000 kg."""
    assert bound(prestress={"normal": 5e4}) == pytest.approx(0.03 * 2 * 2e5 / 4000, rel=1e-14)


def test_a_spring_gives_back_what_it_holds():
    """A gap of 2 mm: v = sqrt(k / m) 2 mm of both blocks together; closures likewise."""

    def opened(model, state):
        state.u[:] = -1e-3, 1e-3

    assert bound(opened) == pytest.approx(np.sqrt(1e7 / 4000) * 2e-3, rel=1e-14)

    def closed(model, state):
        opened(model, state)
        state.start[0] = 3e-3

    # The half block in front of a fixed wall is twice as stiff.
    both = np.sqrt(1e7 * 4e-6 + 2e7 * 9e-6) / np.sqrt(4000)
    ends = {"start": "fixed", "end": "free"}
    assert bound(closed, ends=ends) == pytest.approx(both, rel=1e-14)


def test_a_base_moves_all_blocks_in_its_frame():
    """A velocity that comes to 0.2 m/s and goes on: the sum of its changes, times sqrt(2)."""
    load = {"shape": "step", "amplitude": 0.2, "quantity": "velocity"}
    ends = {"start": "fixed", "end": "free"}
    model, *_ = build(Scene.model_validate(SCENE | {"load": load, "ends": ends}))
    steps = np.concatenate([[0.0], model.base, [0.0]])
    changes = np.abs(np.diff(steps)).sum() / 0.01
    assert 0.2 <= changes <= 0.4 + 1e-12
    assert bound(load=load, ends=ends) == pytest.approx(np.sqrt(2) * changes, rel=1e-14)
