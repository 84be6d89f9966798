"""The end stress: its impulse is the integral of its value, and no momentum is lost on the way."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from jointwave import cases
from jointwave.cases.histories import (
    Gabor,
    Integrated,
    Recorded,
    Ricker,
    Sine,
    Step,
    periodic,
    triangle,
)
from jointwave.cases.loads import base_steps, load_history, step_means
from jointwave.cases.records import read_history

amplitudes = st.floats(-1e7, 1e7).filter(lambda a: abs(a) > 1.0)
periods = st.floats(1e-4, 1.0)


@st.composite
def histories(draw):
    """A recorded history of 2 to 8 samples at uneven times."""
    gaps = draw(st.lists(st.floats(1e-3, 1.0), min_size=1, max_size=7))
    time = draw(st.floats(-1.0, 1.0)) + np.concatenate([[0.0], np.cumsum(gaps)])
    stress = draw(st.lists(amplitudes, min_size=len(time), max_size=len(time)))
    return Recorded(time, np.array(stress))


loads = st.one_of(
    st.builds(Sine, amplitudes, periods, st.integers(1, 5)),
    st.builds(Sine, amplitudes, periods, st.just(0.5)),
    st.builds(Ricker, amplitudes, periods),
    st.builds(Gabor, amplitudes, periods, st.integers(1, 5)),
    st.builds(triangle, amplitudes, st.just(0.0) | periods, periods),
    st.builds(Step, amplitudes),
    histories(),
)


def span(load) -> tuple[float, float]:
    """Return an interval that holds all that happens in a load."""
    end = 1.25 * load.end or 1.0
    return load.breaks[0] - 0.1 * end, end + 0.1 * abs(end)


@given(load=loads, a=st.floats(0, 1), b=st.floats(0, 1))
def test_impulse_is_the_integral_of_value(load, a, b):
    first, last = span(load)
    a, b = sorted(first + (last - first) * np.array([a, b]))
    kinks = [a, *(t for t in load.breaks if a < t < b), b]
    scale = np.abs(load.value(np.linspace(first, last, 400))).max() * (last - first)
    accuracy = {"epsabs": 1e-9 * scale, "epsrel": 1e-9, "limit": 200}
    pieces = [quad(load.value, *ends, **accuracy)[0] for ends in pairwise(kinks)]
    assert load.impulse(b) - load.impulse(a) == pytest.approx(sum(pieces), abs=1e-7 * scale)


@given(load=loads, a=st.floats(0, 1), b=st.floats(0, 1))
def test_an_integrated_history_holds_the_integral_of_the_impulse(load, a, b):
    velocity = Integrated(load)
    first, last = span(load)
    a, b = sorted(first + (last - first) * np.array([a, b]))
    kinks = [a, *(t for t in load.breaks if a < t < b), b]
    scale = np.abs(load.value(np.linspace(first, last, 400))).max() * (last - first) ** 2
    accuracy = {"epsabs": 1e-9 * scale, "epsrel": 1e-9, "limit": 200}
    pieces = [quad(velocity.value, *ends, **accuracy)[0] for ends in pairwise(kinks)]
    assert velocity.impulse(b) - velocity.impulse(a) == pytest.approx(sum(pieces), abs=1e-7 * scale)


@pytest.mark.parametrize("load", [Sine(2.0, 0.3, 0.5), Ricker(2.0, 0.3), Gabor(2.0, 0.3, 4)])
def test_rate_is_the_slope_of_value(load):
    t, h = np.linspace(0.01, 0.14, 30), 1e-6
    slope = (load.value(t + h) - load.value(t - h)) / (2 * h)
    assert load.rate(t) == pytest.approx(slope, abs=1e-7 * np.abs(slope).max())


def test_a_half_sine_pushes_by_twice_its_amplitude_over_omega():
    load = periodic("half-sine", 3.0, 0.01, None)
    assert load.impulse(1.0) == pytest.approx(2 * 3.0 * 0.01 / (2 * np.pi), rel=1e-14)
    assert not load.value(np.array([-1e-9, 0.005 + 1e-9])).any()


def test_a_triangle_rises_and_decays_along_straight_lines():
    load = triangle(6.0, 0.001, 0.003)
    assert load.value(np.array([0.0005, 0.001, 0.002, 0.0035])) == pytest.approx([3, 6, 4, 1])
    assert load.impulse(np.array(1.0)) == pytest.approx(6.0 * 0.004 / 2, rel=1e-14)
    assert triangle(6.0, 0.0, 0.003).value(np.array([0.0, 0.0015])) == pytest.approx([6, 3])


@pytest.mark.parametrize("cycles", [1, 3, 40])
def test_a_gabor_pulse_peaks_in_the_middle_of_its_envelope(cycles):
    """Its whole impulse is p0 b sqrt(2 pi) exp(-(2 pi b / T)^2 / 2)."""
    load = Gabor(5.0, 0.02, cycles)
    whole = (
        5.0 * load.width * np.sqrt(2 * np.pi) * np.exp(-((2 * np.pi * load.width / 0.02) ** 2) / 2)
    )
    assert load.value(np.array(load.centre)) == 5.0
    assert np.abs(load.value(np.array([1e-12, load.end]))).max() < 2e-9 * 5.0
    assert load.impulse(np.array(1e3)) == pytest.approx(whole, abs=2e-8 * 5.0 * load.width)


@given(load=loads)
def test_nothing_before_the_first_break(load):
    before = load.breaks[0] - np.array([1e-9, 0.1, 10.0])
    assert not load.value(before).any()
    assert not load.impulse(before).any()


@given(load=loads, dt=st.floats(1e-4, 0.3), count=st.integers(1, 200))
def test_step_means_telescope_to_the_momentum(load, dt, count):
    """Also for a history whose samples are far closer together than the steps."""
    means = step_means(load, dt, count)
    momentum = load.impulse((count - 0.5) * dt) - load.impulse(-0.5 * dt)
    assert dt * means.sum() == pytest.approx(momentum, abs=1e-9 * dt * np.abs(means).sum() + 1e-9)


@given(amplitude=amplitudes, period=periods, cycles=st.integers(1, 5))
def test_whole_cycles_leave_no_momentum(amplitude, period, cycles):
    load = Sine(amplitude, period, cycles)
    assert load.impulse(load.end) == pytest.approx(0, abs=1e-12 * abs(amplitude) * period)


@pytest.mark.parametrize("period", [0.01, 3.0])
def test_ricker_peaks_at_one_and_a_half_periods(period):
    load = Ricker(2.0, period)
    assert load.value(np.array(1.5 * period)) == pytest.approx(2.0)
    spectrum = np.abs(np.fft.rfft(load.value(period * np.arange(0, 300, 0.1))))
    peak = np.argmax(spectrum) / 300
    assert peak == pytest.approx(1.0, abs=0.01)  # times 1 / period


def test_recorded_history_scaled_by_amplitude(tmp_path, paper_folder):
    (tmp_path / "blast.csv").write_text("time (s),stress (Pa)\n0,0\n0.001,2e6\n0.004,0\n")
    text = (paper_folder / "fig-03.toml").read_text()
    old = 'shape = "sine"\namplitude = 1.0e6  # Pa, ours: the paper\'s fig. 2 is lost\n'
    old += "period = 0.01      # s, ours\ncycles = 1\n"
    assert old in text
    new = 'shape = "table"\namplitude = 0.5\nfile = "blast.csv"\n'
    (tmp_path / "scene.toml").write_text(text.replace(old, new))
    load = load_history(cases.load(tmp_path / "scene.toml")[0])
    assert load.value(np.array([0.0005, 0.001, 0.0025])) == pytest.approx([5e5, 1e6, 5e5])
    assert load.impulse(1.0) == pytest.approx(0.5 * 2e6 * 0.004 / 2)
    coarse = step_means(load, 0.003, 100)  # nothing is lost although the rise lies in one step
    assert 0.003 * coarse.sum() == pytest.approx(2000.0)


@pytest.mark.parametrize("mark", ["", "\ufeff"], ids=["plain", "byte order mark"])
def test_first_row_of_a_history_is_not_taken_for_a_header(tmp_path, mark):
    path = tmp_path / "blast.csv"
    path.write_text(f"{mark}0,7\n1,8\n", encoding="utf-8")
    history, _ = read_history(tmp_path, "blast.csv", "stress")
    assert history.stress.tolist() == [7, 8]


def test_synthetic_blast_is_what_its_file_says(paper_folder):
    load = load_history(cases.load(paper_folder.parent / "beyond" / "blast-history.toml")[0])

    def hole(s):
        return np.where(s > 0, np.exp(-s / 6e-3) - np.exp(-s / 2e-3), 0.0)

    t = load.time[load.time < 0.04]
    assert load.value(t) == pytest.approx(2e6 * hole(t) + 1.2e6 * hole(t - 0.017), abs=50.1)


def test_a_scene_without_a_load_has_none(tmp_path, paper_folder):
    text = (paper_folder / "fig-03.toml").read_text()
    before, rest = text.split("[load]\n")
    (tmp_path / "scene.toml").write_text(before + "[ends]" + rest.split("[ends]", 1)[1])
    scene = cases.load(tmp_path / "scene.toml")[0]
    assert load_history(scene) == Step(0.0)
    assert not step_means(load_history(scene), 1e-5, 100).any()


@pytest.fixture
def shaken(scene_with):
    """A function of the quantity and changes of the load: the pillar on a shaken base."""

    def scene(quantity, **changes):
        load = {"load.quantity": quantity, "load.amplitude": 0.5, "ends.start": "fixed"}
        return scene_with(**load | changes)

    return scene


@pytest.mark.parametrize("dt", [1e-5, 3.7e-4])
def test_a_base_of_given_velocity_moves_by_its_integral(shaken, dt):
    """v0 sin(w t) moves the base by v0 (1 - cos(w t)) / w, and leaves it there after one cycle."""
    steps = base_steps(shaken("velocity").load, dt, 80)
    w, t = 200 * np.pi, dt * np.arange(1, 81)
    expected = 0.5 * (1 - np.cos(w * np.minimum(t, 0.01))) / w
    assert np.cumsum(steps) == pytest.approx(expected, abs=1e-15)


def test_a_base_of_given_acceleration_is_stepped_as_leapfrog_does(shaken):
    """The speed at each half step is the sum of the step means of the acceleration times dt."""
    dt, scene = 1e-4, shaken("acceleration")
    means = step_means(load_history(scene), dt, 150)
    assert base_steps(scene.load, dt, 150) == pytest.approx(dt**2 * np.cumsum(means), abs=1e-18)


def test_a_base_of_given_acceleration_converges_to_its_double_integral(shaken):
    """At order 2: the displacement is the midpoint rule on the exact velocity."""
    w, end = 200 * np.pi, 0.01 / 3
    exact = 0.5 * (end - np.sin(w * end) / w) / w
    errors = [
        base_steps(shaken("acceleration").load, end / n, n).sum() - exact for n in (10, 20, 40)
    ]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.02)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.005)
