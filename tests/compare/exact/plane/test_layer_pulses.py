"""A pulse among joints at many places and at each of them."""

import numpy as np
import pytest

from jointwave.compare.exact.plane import layer_pulses, parallel_joints
from jointwave.compare.exact.plane.oblique_joint import Joint

JOINTS, OFFSETS = [Joint(4e9, 2e9), Joint(8e9, 2e9, 1e6, 3e6)], [0.0, 6.0]
NORMAL = np.array([-np.sin(0.3), np.cos(0.3)])
TIMES = np.linspace(0, 0.05, 501)


@pytest.mark.parametrize("kind, degrees", [("P", 40), ("P", -150), ("SV", 10), ("SV", -60)])
def test_many_places_have_the_motion_of_each_to_a_billionth(rock, ricker, directed, kind, degrees):
    """In front of, between and behind joints; the last is evanescent, interpolated in its depth."""
    points = np.random.default_rng(1).uniform(-15, 25, (200 if degrees == -60 else 9, 2))
    stack = parallel_joints.stack_of([rock] * 3, JOINTS, kind, directed(degrees), NORMAL, OFFSETS)
    every = layer_pulses.motion(ricker, stack, points, TIMES)
    some = layer_pulses.motion(ricker, stack, points[:9:2], TIMES)
    for one, other, unit in zip(every, some, (1.0, rock.p_impedance), strict=True):
        assert np.abs(one[:9:2] - other).max() < 2e-9 * unit
        assert np.abs(other).max() > 0.1 * unit


def test_later_times_and_coarser_ones_give_the_same_motion(rock, ricker, directed):
    points = np.random.default_rng(3).uniform(-15, 25, (5, 2))
    stack = parallel_joints.stack_of([rock] * 3, JOINTS, "P", directed(40), NORMAL, OFFSETS)
    whole = layer_pulses.motion(ricker, stack, points, TIMES)
    part = layer_pulses.motion(ricker, stack, points, TIMES[200:401:4])
    for one, other, unit in zip(whole, part, (1.0, rock.p_impedance), strict=True):
        assert np.abs(one[..., 200:401:4] - other).max() < 1e-9 * unit
