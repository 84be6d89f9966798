"""When and where a run is recorded."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jointwave.cases import SceneError
from jointwave.cases.sampling import clock, interpolation, sample_times


def sampled(duration, interval):
    """Return what `sample_times` reads of a scene."""
    return SimpleNamespace(time=SimpleNamespace(duration=duration), interval=interval)


@pytest.fixture
def scene(pillar):
    """The pillar over 10 ms, sampled every millisecond."""
    return pillar(**{"time.duration": 0.01, "record.interval": 1e-3})


@pytest.mark.parametrize("duration, count", [(0.3, 4), (0.7, 8), (0.35, 4), (0.29, 3), (0.1, 2)])
def test_the_last_sample_is_there(duration, count):
    """0.3 / 0.1 and 0.7 / 0.1 are below 3 and 7 in the last digit."""
    times = sample_times(sampled(duration, 0.1))
    assert times == pytest.approx(0.1 * np.arange(count), rel=1e-15)


@pytest.mark.parametrize("interval", [0.1, 1e-3, 5e-5, 3e-4, 1.0 / 3.0])
def test_whole_multiples_of_the_interval_end_on_a_sample(interval):
    for n in range(1, 400):
        times = sample_times(sampled(n * interval, interval))
        assert len(times) == n + 1 and times[-1] == pytest.approx(n * interval, rel=1e-14)


def test_default_interval_is_a_200th_of_the_period_or_a_2000th_of_the_duration(pillar):
    own = {"record.interval": None, "time.duration": 0.01}
    assert pillar(**own, **{"load.period": 0.02}).interval == 1e-4
    step = {"shape": "step", "amplitude": 1.0}
    assert pillar(**own, load=step).interval == 5e-6


def test_clock(scene):
    """Half of 4e-4 s divides 1e-3 s by five; 0.3 ms does not, and a quarter is taken."""
    time = clock(scene, 4e-4, 0.5, False, "dem")
    assert (time.stride, time.samples, time.steps) == (5, 11, 50)
    assert time.dt == pytest.approx(2e-4, rel=1e-14)
    assert time.times == pytest.approx(1e-3 * np.arange(11), rel=1e-14)
    assert clock(scene, 6e-4, 0.5, False, "dem")[:2] == (pytest.approx(2.5e-4, rel=1e-14), 4)
    assert clock(scene, 1.0, 1.0, False, "dem")[:2] == (1e-3, 1)


@pytest.mark.parametrize("parts", [3, 7, 49, 111])
def test_a_step_that_fits_but_for_round_off_is_taken(scene, parts):
    for critical in (1e-3 / parts, np.nextafter(1e-3 / parts, 0)):
        assert clock(scene, critical, 1.0, False, "dem").stride == parts


@given(fraction=st.floats(0.01, 1.0), critical=st.floats(1e-7, 1e-3))
def test_step_divides_the_interval_and_is_as_long_as_it_may_be(pillar, fraction, critical):
    scene = pillar()
    time = clock(scene, critical, fraction, False, "dem")
    wanted = fraction * critical
    assert time.dt * time.stride == pytest.approx(scene.interval)
    assert time.dt <= wanted * (1 + 1e-9)
    assert time.stride == 1 or scene.interval / (time.stride - 1) > wanted * (1 - 1e-9)


def test_step_above_the_critical_one(scene):
    """1.5 * 4e-4 s lies nearer to a half of 1e-3 s; 1.9 * 4e-4 s to the whole of it."""
    assert clock(scene, 4e-4, 1.5, True, "dem")[:2] == (5e-4, 2)
    assert clock(scene, 4e-4, 1.9, True, "dem")[:2] == (1e-3, 1)


@pytest.mark.parametrize(
    ("critical", "fraction", "unstable", "words"),
    [
        (2e-5, 1.5, False, r"step_fraction = 1\.5: gives a step of 3e-05 s .* 2e-05"),
        (8e-4, 1.5, True, r"record\.interval.*0\.0012 s"),
        (2e-5, 1e-12, False, r"step_fraction = 1e-12: gives 5e\+14 steps .* at most 1e\+12"),
    ],
)
def test_steps_that_are_refused_with_their_numbers(scene, critical, fraction, unstable, words):
    with pytest.raises(SceneError, match=words):
        clock(scene, critical, fraction, unstable, "dem")


def test_interpolation():
    """On a node that node alone; beyond the outermost ones their value; one holds everywhere."""
    nodes = np.array([0.0, 1.0, 3.0])
    left, right, weight = interpolation(nodes, [-1.0, 0.25, 1.0, 1.5, 2.0, 3.0, 5.0])
    found = (1 - weight) * nodes[left] + weight * nodes[right]
    assert found.tolist() == [0.0, 0.25, 1.0, 1.5, 2.0, 3.0, 3.0]
    assert left.tolist() == [0, 0, 0, 1, 1, 1, 1]
    assert weight.tolist() == [0.0, 0.25, 1.0, 0.25, 0.5, 1.0, 1.0]
    left, right, weight = interpolation(0.1 * np.arange(11), [0.3, 0.7, 1.0])
    assert set(weight) <= {0.0, 1.0} and np.where(weight == 1, right, left).tolist() == [3, 7, 10]
    left, right, weight = interpolation(np.array([2.0]), [0.0, 2.0, 3.0])
    assert left.tolist() == right.tolist() == [0, 0, 0] and np.isfinite(weight).all()
