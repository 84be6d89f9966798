"""A pulse among joints at many places against the inversion at each of them."""

import numpy as np
import pytest

from jointwave.compare.exact.plane import layer_pulses, parallel_joints
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.plane.pulse import pulse_fields

JOINTS, OFFSETS, DIP = [Joint(4e9, 2e9), Joint(8e9, 2e9, 1e6, 3e6)], [0.0, 6.0], 0.3
TIMES = np.linspace(0, 0.05, 501)


def both(rock, kind, direction, pulse, points, some=slice(None)):
    """Return the motion at all points and, at some of them, the fields and their bounds."""
    stack = parallel_joints.stack_of([rock] * 3, JOINTS, kind, direction, DIP, OFFSETS)
    found = layer_pulses.motion(pulse, stack, points, TIMES)
    return found, pulse_fields(pulse, stack, points[some], TIMES)


def half_sine(t):
    return np.where((t > 0) & (t < 0.01), np.sin(np.pi * 100 * t), 0.0)


@pytest.mark.parametrize("kind, degrees", [("P", 40), ("P", -150), ("SV", 10), ("SV", -60)])
def test_smooth_pulses_to_a_billionth(rock, ricker, directed, kind, degrees):
    """In front of, between and behind joints; the last is evanescent, interpolated in its depth."""
    count = 200 if degrees == -60 else 9
    points = np.random.default_rng(1).uniform(-15, 25, (count, 2))
    some = slice(0, 9, 2)
    found, exact = both(rock, kind, directed(degrees), ricker, points, some)
    for one, other, unit in zip(found, exact, (1.0, rock.p_impedance), strict=False):
        assert np.abs(one[some] - other).max() < 2e-9 * unit


@pytest.mark.parametrize("kind, degrees", [("P", 40), ("SV", -60)])
def test_kinks_within_the_bound(rock, directed, kind, degrees):
    """Half a sine, whose slope jumps: as far off as the inversion itself, rms."""
    points = np.random.default_rng(2).uniform(-15, 25, (6, 2))
    found, exact = both(rock, kind, directed(degrees), half_sine, points)
    for one, other, bound in zip(found, exact[:2], exact[2:], strict=True):
        assert (np.sqrt(np.mean((one - other) ** 2, axis=-1)) <= 2 * bound).all()


def test_later_times_and_coarser_ones_give_the_same_motion(rock, ricker, directed):
    points = np.random.default_rng(3).uniform(-15, 25, (5, 2))
    stack = parallel_joints.stack_of([rock] * 3, JOINTS, "P", directed(40), DIP, OFFSETS)
    whole = layer_pulses.motion(ricker, stack, points, TIMES)
    part = layer_pulses.motion(ricker, stack, points, TIMES[200:401:4])
    for one, other, unit in zip(whole, part, (1.0, rock.p_impedance), strict=True):
        assert np.abs(one[..., 200:401:4] - other).max() < 1e-9 * unit
