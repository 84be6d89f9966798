"""The end stress: its impulse is the integral of its value, and no momentum is lost on the way."""

import tomllib
from itertools import pairwise
from math import exp, pi, sqrt

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
from jointwave.compare.scenes import SHIPPED

#: 0, 6, 2 Pa at 1, 2, 4 s: 3 Pa s in the first piece, 8 in the second, nothing beyond.
RECORDED = Recorded(np.array([1.0, 2.0, 4.0]), np.array([0.0, 6.0, 2.0]))

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


def test_sine():
    """3 sin(2 pi t / 0.4), two cycles; half a cycle holds 3 * 0.4 / pi."""
    load = Sine(3.0, 0.4, 2)
    t = np.array([-0.1, 0.0, 0.4 / 12, 0.1, 0.3, 0.5, 0.7, 0.8, 0.9])
    assert load.value(t) == pytest.approx([0, 0, 1.5, 3, -3, 3, -3, 0, 0], abs=1e-14)
    t = np.array([-0.1, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 0.9])
    half = 1.2 / pi
    expected = [0, half / 2, half, half / 2, 0, half, 0, 0]
    assert load.impulse(t) == pytest.approx(expected, abs=1e-15)
    assert load.value(np.array(load.end)) == 0  # to the last bit
    assert load.end == 0.8 and load.breaks == [0.0, 0.8]


def test_half_sine():
    load = periodic("half-sine", 3.0, 0.01, None)
    assert load.impulse(1.0) == pytest.approx(2 * 3.0 * 0.01 / (2 * pi), rel=1e-14)
    assert not load.value(np.array([-1e-9, 0.005 + 1e-9])).any()


def test_ricker():
    """Zero where a = 1/2, trough -4 e^-1.5 where a = 3/2; impulse 2 s e^-a from the middle."""
    load = Ricker(2.0, 0.1)
    zero, trough = 0.1 / (pi * sqrt(2)), 0.1 * sqrt(1.5) / pi
    t = 0.15 + np.array([-trough, -zero, 0, zero, trough])
    dip = -4 * exp(-1.5)
    assert load.value(t) == pytest.approx([dip, 0, 2, 0, dip], abs=1e-13)
    before = 0.3 * exp(-((1.5 * pi) ** 2))  # of the part that is cut off before t = 0
    peak = 2 * zero * exp(-0.5)
    expected = np.array([-peak, 0, peak]) + before
    assert load.impulse(0.15 + np.array([-zero, 0, zero])) == pytest.approx(expected, rel=1e-12)
    assert not load.value(np.zeros(1)).any() and load.breaks == [0.0]


@pytest.mark.parametrize("cycles", [1, 3, 40])
def test_gabor(cycles):
    """Its peak is that of its envelope, its impulse p0 b sqrt(2 pi) exp(-(2 pi b / T)^2 / 2)."""
    load = Gabor(5.0, 0.02, cycles)
    whole = 5.0 * load.width * sqrt(2 * pi) * exp(-((2 * pi * load.width / 0.02) ** 2) / 2)
    assert load.value(np.array(load.centre)) == 5.0
    assert np.abs(load.value(np.array([1e-12, load.end]))).max() < 2e-9 * 5.0
    assert load.impulse(np.array(1e3)) == pytest.approx(whole, abs=2e-8 * 5.0 * load.width)


def test_triangle():
    load = triangle(6.0, 0.001, 0.003)
    assert load.value(np.array([0.0005, 0.001, 0.002, 0.0035])) == pytest.approx([3, 6, 4, 1])
    assert load.impulse(np.array(1.0)) == pytest.approx(6.0 * 0.004 / 2, rel=1e-14)
    assert triangle(6.0, 0.0, 0.003).value(np.array([0.0, 0.0015])) == pytest.approx([6, 3])


def test_step():
    load = Step(3.0)
    assert load.value(np.array([-1.0, 0.0, 1e-9, 7.0])).tolist() == [0, 1.5, 3, 3]
    assert load.impulse(np.array([-1.0, 0.0, 2.0])).tolist() == [0, 0, 6]
    assert load.breaks == [0.0]


def test_recorded():
    t = np.array([0.9, 1.0, 1.5, 2.0, 3.0, 4.0, 4.1])
    assert RECORDED.value(t).tolist() == [0, 0, 3, 6, 4, 2, 0]
    t = np.array([0.0, 1.0, 1.5, 2.0, 3.0, 4.0, 9.0])
    assert RECORDED.impulse(t).tolist() == [0, 0, 0.75, 3, 8, 11, 11]
    assert RECORDED.breaks == [1.0, 2.0, 4.0]


def span(load) -> tuple[float, float]:
    """Return an interval that holds all that happens in a load."""
    end = 1.25 * load.end or 1.0
    return load.breaks[0] - 0.1 * end, end + 0.1 * abs(end)


@pytest.mark.parametrize("form", [lambda load: load, Integrated], ids=["value", "integrated"])
@given(load=loads, a=st.floats(0, 1), b=st.floats(0, 1))
def test_impulse_is_the_integral_of_value(form, load, a, b):
    """Of a load, and of a velocity that is the impulse of an acceleration."""
    own, (first, last) = form(load), span(load)
    a, b = sorted(first + (last - first) * np.array([a, b]))
    kinks = [a, *(t for t in load.breaks if a < t < b), b]
    scale = np.abs(load.value(np.linspace(first, last, 400))).max()
    scale *= (last - first) ** (1 + (own is not load))
    accuracy = {"epsabs": 1e-9 * scale, "epsrel": 1e-9, "limit": 200}
    pieces = [quad(own.value, *ends, **accuracy)[0] for ends in pairwise(kinks)]
    assert own.impulse(b) - own.impulse(a) == pytest.approx(sum(pieces), abs=1e-7 * scale)


RECORD = Recorded(np.array([0.0, 0.06, 0.2]), np.array([0.0, 2.0, 0.0]))


@pytest.mark.parametrize(
    "load", [Sine(2.0, 0.3, 0.5), Sine(2.0, 0.05, 2), Ricker(2.0, 0.3), Gabor(2.0, 0.3, 4), RECORD]
)
def test_rate_is_the_slope_of_value(load):
    """Before and after it, a load stands still."""
    assert np.abs(load.rate(np.array([-1.0, 9.0]))).max() < 1e-99
    t, h = np.linspace(0.01, 0.14, 30), 1e-6
    slope = (load.value(t + h) - load.value(t - h)) / (2 * h)
    assert load.rate(t) == pytest.approx(slope, abs=1e-7 * np.abs(slope).max())


@given(load=loads)
def test_nothing_before_the_first_break(load):
    before = load.breaks[0] - np.array([1e-9, 0.1, 10.0])
    assert not load.value(before).any() and not load.impulse(before).any()


def test_step_means():
    """Half of a step's first mean lies before it; 0.75, 5.75, 9.75, 11 Pa s at 1.5 s ..."""
    assert step_means(Step(3.0), 0.1, np.arange(4)) == pytest.approx([1.5, 3, 3, 3], rel=1e-14)
    found = step_means(RECORDED, 1.0, np.arange(6))
    assert found == pytest.approx([0, 0.75, 5, 4, 1.25, 0], rel=1e-14)


@given(load=loads, dt=st.floats(1e-4, 0.3), count=st.integers(1, 200))
def test_step_means_telescope_to_the_momentum(load, dt, count):
    """Also for a history whose samples are far closer together than the steps."""
    means = step_means(load, dt, np.arange(count))
    momentum = load.impulse((count - 0.5) * dt) - load.impulse(-0.5 * dt)
    assert dt * means.sum() == pytest.approx(momentum, abs=1e-9 * dt * np.abs(means).sum() + 1e-9)


def test_load_of_a_scene(pillar):
    sine = {"shape": "sine", "amplitude": 2.0, "period": 0.1}
    assert load_history(pillar(load={"shape": "step", "amplitude": 3.0})) == Step(3.0)
    assert load_history(pillar(load=sine)) == Sine(2.0, 0.1, 1)
    assert load_history(pillar(load=sine | {"cycles": 3})) == Sine(2.0, 0.1, 3)
    assert load_history(pillar(load=sine | {"shape": "ricker"})) == Ricker(2.0, 0.1)
    tables = tomllib.loads((SHIPPED / "guo-li-2002" / "fig-03.toml").read_text())
    del tables["load"], tables["variants"]
    assert load_history(cases.load_tables(tables)) == Step(0.0)


def test_recorded_history_scaled_by_amplitude(tmp_path, pillar):
    """Beneath a header, or with a byte order mark before the first number."""
    blast = tmp_path / "blast.csv"
    for text in ("# a blast\ntime (s),stress (Pa)\n0,0\n1e-3,2e6\n4e-3,0\n", "\ufeff0,7\n1,8\n"):
        blast.write_text(text, encoding="utf-8")
        history = read_history(tmp_path / "blast.csv", "stress")
        assert history.stress.tolist() == ([7, 8] if "7" in text else [0, 2e6, 0])
    blast.write_text("0,0\n0.001,2e6\n0.004,0\n")
    load = load_history(pillar(load={"shape": "table", "amplitude": 0.5, "file": str(blast)}))
    assert load.value(np.array([0.0005, 0.001, 0.0025])) == pytest.approx([5e5, 1e6, 5e5])
    coarse = step_means(load, 0.003, np.arange(100))  # the rise lies in one step
    assert 0.003 * coarse.sum() == pytest.approx(0.5 * 2e6 * 0.004 / 2)


def test_synthetic_blast_is_what_its_file_says():
    load = load_history(cases.load(SHIPPED / "beyond" / "blast-history.toml")[0])

    def hole(s):
        return np.where(s > 0, np.exp(-s / 6e-3) - np.exp(-s / 2e-3), 0.0)

    t = load.time[load.time < 0.04]
    assert load.value(t) == pytest.approx(2e6 * hole(t) + 1.2e6 * hole(t - 0.017), abs=50.1)


@pytest.fixture
def shaken(pillar):
    """A function of a quantity and a load: those of the base of the pillar."""

    def load(quantity, **keys):
        own = {"shape": "sine", "period": 0.01, "amplitude": 0.5, "quantity": quantity} | keys
        return pillar(load=own, **{"ends.start": "fixed"}).load

    return load


@pytest.mark.parametrize("dt", [1e-5, 3.7e-4])
def test_a_base_of_given_velocity_moves_by_its_integral(shaken, dt):
    """v0 sin(w t) moves the base by v0 (1 - cos(w t)) / w, and leaves it there after one cycle."""
    steps = base_steps(shaken("velocity"), dt, 80)
    w, t = 200 * np.pi, dt * np.arange(1, 81)
    expected = 0.5 * (1 - np.cos(w * np.minimum(t, 0.01))) / w
    assert np.cumsum(steps) == pytest.approx(expected, abs=1e-15)


def test_a_base_of_given_acceleration_is_stepped_as_leapfrog_does(shaken):
    """a = 3 m/s2: 3 t at the half steps, times 0.1 s; at order 2 the double integral of a sine."""
    constant = shaken("acceleration", shape="step", period=None, amplitude=3.0)
    assert base_steps(constant, 0.1, 3) == pytest.approx([0.015, 0.045, 0.075], rel=1e-14)
    w, end = 200 * np.pi, 0.01 / 3
    exact = 0.5 * (end - np.sin(w * end) / w) / w
    errors = [base_steps(shaken("acceleration"), end / n, n).sum() - exact for n in (10, 20, 40)]
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.02)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.005)
