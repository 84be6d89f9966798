"""When and where a run is recorded."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwave.cases import SceneError
from jointwave.cases.sampling import clock, interpolation, sample_times

fractions = st.floats(0.01, 1.0)
steps = st.floats(1e-7, 1e-3)


def test_samples_run_from_zero_to_the_duration(scene_with):
    times = sample_times(scene_with(**{"time.duration": 0.12, "record.interval": 5e-5}))
    assert len(times) == 2401
    assert times[[0, -1]] == pytest.approx([0.0, 0.12])


def test_default_interval_is_a_200th_of_the_period(scene_with):
    assert scene_with(**{"load.period": 0.02}).interval == pytest.approx(1e-4)


@given(fraction=fractions, critical=steps)
def test_step_divides_the_interval_and_is_as_long_as_it_may_be(scene_with, fraction, critical):
    scene = scene_with()
    time = clock(scene, critical, fraction, False, "dem")
    wanted = fraction * critical
    assert time.dt * time.stride == pytest.approx(scene.interval)
    assert time.dt <= wanted * (1 + 1e-9)
    assert time.stride == 1 or scene.interval / (time.stride - 1) > wanted * (1 - 1e-9)
    np.testing.assert_allclose(time.times, sample_times(scene), rtol=1e-12)
    assert time.steps == time.stride * (len(time.times) - 1)


def test_step_above_the_critical_one_is_refused_with_both_numbers(scene_with):
    with pytest.raises(SceneError, match=r"step_fraction = 1\.5: gives a step of 3e-05 s .* 2e-05"):
        clock(scene_with(), 2e-5, 1.5, False, "dem")
    assert clock(scene_with(), 2e-5, 1.25, True, "dem").dt == pytest.approx(2.5e-5)


def test_endless_run_is_refused(scene_with):
    with pytest.raises(
        SceneError, match=r"step_fraction = 1e-12: gives 6e\+15 steps .* at most 1e\+12"
    ):
        clock(scene_with(), 2e-5, 1e-12, False, "dem")


@given(
    gaps=st.lists(st.floats(0.1, 2.0), min_size=1, max_size=20),
    where=st.lists(st.floats(0, 1), min_size=1, max_size=8),
)
def test_interpolation_is_that_of_numpy(gaps, where):
    nodes = np.concatenate([[0.0], np.cumsum(gaps)])
    values = np.sin(nodes)
    places = nodes[-1] * np.array(where)
    left, right, weight = interpolation(nodes, places.tolist())
    found = (1 - weight) * values[left] + weight * values[right]
    assert found == pytest.approx(np.interp(places, nodes, values), abs=1e-7)


def test_interpolation_on_a_node_takes_that_node_alone():
    nodes = 0.1 * np.arange(11)
    left, right, weight = interpolation(nodes, [0.3, 0.7, 1.0])
    taken = np.where(weight == 1, right, left)
    assert set(weight) <= {0.0, 1.0}
    assert taken.tolist() == [3, 7, 10]


def test_interpolation_beyond_the_outermost_nodes_holds_their_value():
    left, right, weight = interpolation(np.array([0.25, 0.75]), [0.0, 1.0])
    values = np.array([3.0, 5.0])
    assert ((1 - weight) * values[left] + weight * values[right]).tolist() == [3.0, 5.0]
