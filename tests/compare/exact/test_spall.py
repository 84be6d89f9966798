"""Spalling of a bar against closed forms and images, and of the chain against its own stress."""

import numpy as np
import pytest
from scipy.optimize import fsolve

from closed_forms.spall import lattice_spall, spall
from jointwave.cases.histories import Recorded, Ricker, Sine, Step
from jointwave.compare.exact.bar import images
from jointwave.compare.exact.blocks import row_of_blocks

L, C = 50.0, 1350.0


@pytest.mark.parametrize("share", [0.01, 0.3, 0.99])
def test_a_saw_tooth_spalls_at_half_its_length_times_the_share(share):
    """x = lam sigma_t / 2 p0, as the front, which lost sigma_t on its way back, is there."""
    lam, p0 = 7.0, 2e6
    tooth = Recorded(np.array([0.0, lam / C]), np.array([p0, 0.0]))
    found = spall(tooth, share * p0, L, C, 0.1)
    assert found == pytest.approx((lam * share / 2, (L + lam * share / 2) / C), rel=1e-12)


def test_a_pulse_weaker_than_the_rock_breaks_nothing():
    tooth = Recorded(np.array([0.0, 5e-3]), np.array([1e6, 0.0]))
    assert spall(tooth, 1.0001e6, L, C, 0.1) is None
    assert spall(Step(1e6), 1e5, L, C, 0.03) is None


def test_a_pulse_that_pulls_breaks_the_start_as_it_enters():
    found = spall(Sine(-1e6, 0.01), 2e5, L, C, 0.03)
    assert found == pytest.approx((L, np.arcsin(0.2) * 0.01 / (2 * np.pi)), rel=1e-9)


def test_a_triangle_spalls_where_its_tail_is_met_by_its_crest():
    """Rise r, fall f: the most tension p0 2x/(c f) is at the reflected crest, so x = c f share/2,
    at the time r later than a saw tooth, while 2x/c is within the fall."""
    rise, fall, share = 1e-3, 4e-3, 0.6
    load = Recorded(np.array([0.0, rise, rise + fall]), np.array([0.0, 1e6, 0.0]))
    x = C * fall * share / 2
    assert spall(load, share * 1e6, L, C, 0.1) == pytest.approx((x, rise + (L + x) / C), rel=1e-12)


def test_a_smooth_pulse_spalls_where_both_slopes_cancel():
    """f(a) - f(b) = sigma_t is least in a + b where f'(a) + f'(b) = 0. The time is of second order
    in the last polygon's pieces, 1e-12; the place, flat there, known to its root."""
    load, strength = Ricker(1e6, 0.01), 8e5
    found = spall(load, strength, L, C, 0.03)
    slope = lambda t: (load.value(t + 1e-7) - load.value(t - 1e-7)) / 2e-7  # noqa: E731
    guess = found.time - (L + found.distance) / C, found.time - (L - found.distance) / C
    a, b = fsolve(
        lambda x: [
            (load.value(x[0]) - load.value(x[1])) / strength - 1,
            (slope(x[0]) + slope(x[1])) / 1e9,
        ],
        guess,
        xtol=1e-13,
    )
    assert found.time == pytest.approx((a + b) / 2 + L / C, rel=1e-9)
    assert found.distance == pytest.approx(C * (b - a) / 2, rel=1e-4)


def test_nowhere_did_the_images_reach_the_strength_before():
    """On a grid of places and times; at the time found the tension there is the strength."""
    rng = np.random.default_rng(7)
    time, stress = np.linspace(0, 0.012, 9), 1e6 * rng.uniform(0, 1, 9)
    load, places = Recorded(time, stress), np.linspace(0.0, L, 801)
    x, t = spall(load, 5e5, L, C, 0.1)
    times = np.linspace(0.0, t, 2001)
    there, back = images.images(load.value, places, times[:-1], L, C)
    assert (there + back).min() > -5e5
    there, back = images.images(load.value, [L - x], [t], L, C)
    assert there[0, 0] + back[0, 0] == pytest.approx(-5e5, rel=1e-9)


def test_the_chain_breaks_where_its_tension_is_the_strength(scene):
    """The stress that the lattice records there, on samples about that time, crosses sigma_t."""
    joints = {"tensile_strength": 4e5, "fracture_energy": 1e3}
    load = {"shape": "ricker", "period": 0.02}
    found = lattice_spall(scene(joints=joints, load=load, time={"duration": 0.1}))
    y = [0.5 * j for j in range(1, 100)]
    at = scene(load=load, time={"duration": 0.1}, record={"stress": y, "velocity": []})
    result = row_of_blocks.solve(at)
    excess = -result.stress.values.T - 4e5
    first = int(np.argmax((excess > 0).any(axis=1)))
    assert result.time.values[first - 1] < found.time <= result.time.values[first]
    joint = y.index(L - found.distance)
    before, after = excess[first - 1 : first + 1, joint]
    assert before < 0 and after > -1e-3 * 4e5
    crossing = np.interp(0.0, [before, after], result.time.values[first - 1 : first + 1])
    assert found.time == pytest.approx(crossing, abs=1e-2 * at.interval)


@pytest.mark.parametrize("block", [0.5, 0.25])
def test_the_chain_breaks_as_late_as_the_bar_but_for_its_dispersion(scene, block):
    """A harmonic of the wavelet's peak frequency runs (omega d/c)^2/24 slower, over L + x."""
    joints = {"tensile_strength": 8e5, "fracture_energy": 1e4}
    load = {"shape": "ricker", "period": 0.02}
    at = scene(pillar={"block": block}, joints=joints, load=load, time={"duration": 0.1})
    speed = np.sqrt(2 * 800.0**2 * (1 + 0.423809523809524))
    chain, bar = lattice_spall(at), spall(Ricker(1e6, 0.02), 8e5, L, speed, 0.06)
    lag = (2 * np.pi / 0.02 * block / speed) ** 2 / 24 * (L + bar.distance) / speed
    assert abs(chain.time - bar.time) < 4 * lag + block / speed
    assert abs(chain.distance - bar.distance) < speed * 0.02 / 20


def test_a_chain_without_tensile_strength_is_refused(scene):
    with pytest.raises(ValueError, match="no joint has a tensile strength"):
        lattice_spall(scene())
