"""Snapshots of pillars: what its receivers record, on cells that joints keep apart."""

import numpy as np
import pytest

from jointwave.continuum.body.run import simulate
from jointwave.results.snapshots import snapshots_of

LENGTH, BLOCK, SIDE = 2.0, 0.5, 0.5
SHORT = {
    "pillar__length": LENGTH,
    "rock__intact_modulus": 8.64e10,
    "load": {"shape": "sine", "amplitude": 1e6, "period": 2e-3, "cycles": 1},
    "ends__end": "free",
    "time__duration": 4e-3,
    "record": {"velocity": [0.0, 0.25, 2.0], "interval": 2e-5, "fields": 4e-4},
}
KINDS = {1: "line", 2: "quad", 3: "hexahedron"}


@pytest.fixture(params=KINDS)
def dim(request):
    return request.param


@pytest.fixture
def short(pillar):
    """Return a function of the dimension that gives four blocks of rock, keys changed."""
    return lambda dim, **changes: pillar(**SHORT | {"numerics__continuum__dim": dim} | changes)


def test_a_run_with_snapshots_is_the_same_to_the_last_bit(short, dim):
    record = {key: value for key, value in SHORT["record"].items() if key != "fields"}
    filmed, bare = (simulate(s) for s in (short(dim), short(dim, record=record)))
    assert snapshots_of(bare) is None
    for name in bare.data_vars:
        np.testing.assert_array_equal(bare[name].values, filmed[name].values, str(name))


@pytest.mark.parametrize("quantity", ["displacement", "velocity"])
def test_snapshots_of_the_bar_are_what_receivers_record(short, quantity):
    """At nodes that are receivers: both ends, and the middle of the first block."""
    result = simulate(short(1))
    found, recorded = snapshots_of(result), result[quantity].values[:, ::20, 0]
    np.testing.assert_array_equal(found.time, result.time.values[::20])
    for y, waveform in zip(SHORT["record"]["velocity"], recorded, strict=True):
        node = int(np.argmin(np.abs(found.points[:, 1] - y)))
        assert found.points[node, 1] == pytest.approx(y, abs=1e-12)
        scale = np.abs(recorded).max()
        np.testing.assert_allclose(
            getattr(found, quantity)[:, node, 1], waveform, rtol=0, atol=1e-13 * scale
        )


def test_a_joint_without_tension_opens_between_its_own_nodes(short, dim):
    """Facing nodes lie at one place, and part once tension comes."""
    scene = short(dim, joints__tension=False)
    found = snapshots_of(simulate(scene))
    nodes = np.unique(found.cells[found.block == 2]), np.unique(found.cells[found.block == 3])
    facing = [n[np.isclose(found.points[n, 1], 1.5)] for n in nodes]
    left, right = (n[np.lexsort(found.points[n][:, [0, 2]].round(9).T)] for n in facing)
    np.testing.assert_allclose(found.points[left], found.points[right], atol=1e-12)
    gap = found.displacement[:, right, 1] - found.displacement[:, left, 1]
    assert gap.max() > 0.1 * np.abs(found.displacement).max()


def test_stress_of_a_slow_push_is_the_load(short, dim):
    """Two widths and more from a fixed end, which only there keeps the rock from widening."""
    load = {"shape": "step", "amplitude": 1e6}
    scene = short(dim, load=load, ends__end="fixed", joints__damping_ratio=0.5, time__duration=0.05)
    found = snapshots_of(simulate(scene))
    assert found.stress[-1, found.block < 2] == pytest.approx(1e6, rel=1e-5)
