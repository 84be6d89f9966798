"""Scenes of forces at points: arrivals, sums of forces."""

import numpy as np
import pytest

from jointwave.compare.engines import applies, solve

IN_SPACE = "is for a rock mass in the plane, not for one in space"
IN_PLANE = "is for a rock mass in space, not for one in the plane"
A, B = np.sqrt(2.4e7), np.sqrt(8e6)
FORCE = {"kind": "force", "quantity": "force", "at": [20.0, 15.0], "direction": [0.0, 1.0]}
FORCE |= {"shape": "ricker", "amplitude": 1e6, "period": 0.002}


@pytest.fixture
def forced(rock_mass):
    """Return rock with a force of 1 MN/m upwards in the middle and tables changed."""
    tables = {"joint_sets": [], "waves": [], "loads": [FORCE], "time": {"duration": 0.008}}
    record = {"points": [[20.0, 20.0], [26.0, 15.0]], "joints": [], "interval": 2e-5}
    return lambda **changes: rock_mass(**tables | {"record": record} | changes)


def test_waves_arrive_in_time_and_sides_do_so_later(forced):
    """5 m above P comes at 5/a, 6 m beside S at 6/b and not before 6/a anything. The top is 15 m
    away: its image is 45 - 20 = 25 m from the upper point."""
    found = solve("line-force", forced())
    assert found.attrs["known_until"] == pytest.approx(25 / A, rel=1e-12)
    t, v = found.time.values, np.abs(found.velocity.values)
    above, beside = v[0, :, 1], v[1, :, 1]
    assert above[t < 5 / A].max() == 0 < above[t < 5 / A + 2e-3].max()
    assert beside[t < 6 / A].max() == 0
    before, after = beside[t < 6 / B].max(), beside[t < 6 / B + 4e-3].max()
    assert 0 < before < 0.2 * after
    assert v[0, :, 0].max() < 1e-12 * v.max() and v[1, :, 0].max() < 1e-12 * v.max()


def test_forces_superpose_and_displacement_is_the_integral(forced):
    other = FORCE | {"at": [15.0, 10.0], "direction": [0.6, 0.8], "shape": "sine", "cycles": 1}
    parts = [solve("line-force", forced(loads=[one])) for one in (FORCE, other)]
    both = solve("line-force", forced(loads=[FORCE, other], prestress={"xx": 1e6, "yy": 2e6}))
    for name, still in (("velocity", 0), ("displacement", 0), ("stress", [1e6, 2e6, 0])):
        expected = parts[0][name] + parts[1][name] + np.array(still)
        assert np.abs(both[name] - expected).max() <= 1e-12 * np.abs(expected).max()
    u, v = parts[0].displacement.values, parts[0].velocity.values
    pairs = 2e-5 / 3 * (v[:, :-2:2] + 4 * v[:, 1:-1:2] + v[:, 2::2])
    assert np.abs(np.cumsum(pairs, axis=1) - u[:, 2::2]).max() < 1e-5 * np.abs(u).max()
    assert both.attrs["known_until"] == min(one.attrs["known_until"] for one in parts)


def test_a_force_in_space_reaches_receivers_and_then_sides(forced):
    """6 m beside a force to the north, S comes at 6/b and little before; nothing before 6/a. The
    top is 4 m above the force: its image is 10 m from that receiver. In the plane it is none."""
    force = FORCE | {"at": [20.0, 15.0, 16.0], "direction": [0.0, 1.0, 0.0]}
    record = {"points": [[26.0, 15.0, 16.0], [20.0, 20.0, 16.0]], "joints": [], "interval": 2e-5}
    scene = forced(domain={"size": [40.0, 30.0, 20.0]}, loads=[force], record=record)
    found = solve("point-force", scene)
    assert found.attrs["known_until"] == pytest.approx(np.sqrt(5**2 + 8**2) / A, rel=1e-12)
    t, beside, along = found.time.values, *np.abs(found.velocity.values)
    assert beside[t < 6 / A].max() == 0
    assert beside[:, [0, 2]].max() < 1e-12 * beside.max()
    assert 0 < beside[t < 6 / B].max() < 0.2 * beside.max()
    assert along[t < 5 / A].max() == 0 < along[t < 5 / B, 1].max()
    assert applies("line-force", scene).reason == IN_SPACE
    assert applies("point-force", forced()).reason == IN_PLANE
