"""Exact solutions of two cubes and of their bar, each value worked out by hand.

Cubes of 1 m and 1000 kg, E_eq = 2.5 MPa: k = 2.5e6 N/m between rigid blocks, c = 50 m/s and
Z = 5e4 Pa s/m in the bar. A step load of 1000 Pa."""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest

from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar import images
from jointwave.compare.exact.bar.bars import JOINTED
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.exact.blocks.pillar import system_of
from jointwave.compare.exact.blocks.row_of_blocks import contact_forces

PERIOD = 2 * pi / sqrt(5000.0)  # of the two blocks against each other, s
RECORD = {"stress": [0.0, 0.5, 1.0, 2.0], "velocity": [0.5, 1.5]}


def scene(duration=1.25 * PERIOD, samples=6, **tables):
    """Return the two cubes, with tables put in place of their own."""
    own = {
        "title": "by hand",
        "pillar": {"length": 2.0, "side": 1.0, "block": 1.0},
        "rock": {"density": 1000.0, "equivalent_modulus": 2.5e6, "equivalent_poisson": 0.25},
        "load": {"shape": "step", "amplitude": 1000.0},
        "time": {"duration": duration},
        "record": RECORD | {"interval": duration / (samples - 1)},
    }
    return Scene.model_validate(own | tables)


def holds(values, expected, rel=1e-10):
    """Hold an array to numbers, relative to the largest of them."""
    expected = np.array(expected, dtype=float)
    np.testing.assert_allclose(values, expected, rtol=0, atol=rel * np.abs(expected).max())


def along(variable):
    """Return the component along the pillar, [receiver, sample]."""
    return variable.sel(axis="y").values


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_two_blocks_under_a_step(sign):
    """F / 2 (1 - cos w t) in the joint, F t / 2m of both together, w^2 = 2 k / m = 5000 / s2; a
    load against the axis pulls."""
    step = {"shape": "step", "amplitude": 1000.0, "direction": [0.0, sign, 0.0]}
    found = sign * row_of_blocks.solve(scene(load=step))
    t = np.arange(6) * PERIOD / 4
    one = np.array([1 - cos(n * pi / 2) for n in range(6)])
    ends = [1000.0 if n else 500.0 for n in range(6)]
    holds(found.stress, [ends, (ends + 500 * one) / 2, 500 * one, 0 * t])
    apart = np.array([sin(n * pi / 2) for n in range(6)]) * 500 / sqrt(5000.0) / 1000
    holds(along(found.velocity), [t / 2 + apart, t / 2 - apart])
    shift = 500 * one / 2.5e6 / 2
    holds(along(found.displacement), [t**2 / 4 + shift, t**2 / 4 - shift])


def test_no_tension_in_a_chain():
    """Open: nothing. Closed but parted faster than its dashpot lets it: nothing either."""
    ratio = 0.5e-3 * sqrt(2500.0)
    one = system_of(scene(joints={"damping_ratio": ratio, "tension": False}))
    for gap, rate, force in ((1e-6, -1.0, 0.0), (-1e-4, 0.2, 0.0), (-1e-4, 0.05, 125.0)):
        state = np.zeros(len(one.load))
        state[1] = gap / one.displacement[1, 1]
        state[3] = rate / one.velocity[1, 3]
        assert contact_forces(one, state)[1] == pytest.approx(force, abs=1e-9)


@pytest.mark.parametrize("end", ["fixed", "matched"])
def test_far_end_of_the_jointed_bar(end):
    """The joint passes s (1 - e^-at), a = 2 K_n / z, which a wall doubles; the load acts late by
    Z / 4 K_n, 2.5 ms. Before the dashpot Z stands half of a joint:
    f' + b f = 2 a s (1 - e^-at) with b = a + 2 K_n / Z = a + 200."""
    rock = {"density": 1000.0, "equivalent_modulus": 2.5e6, "equivalent_poisson": 0.25}
    rock["intact_modulus"] = 5e6
    at = {"stress": [2.0], "velocity": [1.5], "interval": 0.01}
    found = JOINTED.run(scene(0.06, rock=rock, ends={"start": "quiet", "end": end}, record=at))
    t = np.maximum(np.array([0.03, 0.04, 0.05]) - 2 / (50 * sqrt(2)) - 0.0025, 0.0)
    a = 1e7 / (5e4 * sqrt(2))
    b, twice = a + 200, 2000 * sqrt(2) / (1 + sqrt(2))
    late, soon = np.exp(-a * t), np.exp(-b * t)
    expected = {"fixed": 1 - late, "matched": a * ((1 - soon) / b - (late - soon) / 200)}[end]
    holds(found.stress[0, :6], [0, 0, 0, *(twice * expected)], rel=2e-3)


def test_how_far_images_and_matrices_go():
    """A million times 4 m at 50 m/s are 8e4 s; and 2000 blocks."""
    assert images.applies(scene(7.99e4)) and not images.applies(scene(8.01e4))
    for blocks, held in ((2000, True), (2001, False)):
        pillar = {"length": float(blocks), "side": 1.0, "block": 1.0}
        assert bool(row_of_blocks.applies(scene(pillar=pillar))) is held
