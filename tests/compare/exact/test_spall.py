"""Spalling of a bar against a closed form, and of the chain against its own stress."""

import numpy as np
import pytest

from cases.histories import Recorded, Ricker, Step
from closed_forms.spall import lattice_spall, spall
from compare.exact.blocks import lattice

L, C = 50.0, 1350.0


@pytest.mark.parametrize("share", [0.01, 0.3, 0.99])
def test_a_saw_tooth_spalls_at_half_its_length_times_the_share(share):
    """x = lam sigma_t / 2 p0, as the front, which lost sigma_t on its way back, is there; to twice
    the spacing of places and times."""
    lam, p0 = 7.0, 2e6
    tooth = Recorded(np.array([0.0, lam / C]), np.array([p0, 0.0]))
    found = spall(tooth, share * p0, L, C, 0.1)
    assert found.distance == pytest.approx(lam * share / 2, abs=0.05)
    assert found.time == pytest.approx((L + lam * share / 2) / C, abs=4e-5)


def test_a_pulse_weaker_than_the_rock_breaks_nothing():
    tooth = Recorded(np.array([0.0, 5e-3]), np.array([1e6, 0.0]))
    assert spall(tooth, 1.0001e6, L, C, 0.1) is None
    assert spall(Step(1e6), 1e5, L, C, 0.03) is None


def test_the_chain_breaks_where_its_tension_is_the_strength(scene):
    """The stress that the lattice records there, on samples about that time, crosses sigma_t."""
    joints = {"tensile_strength": 4e5, "fracture_energy": 1e3}
    load = {"shape": "ricker", "period": 0.02}
    found = lattice_spall(scene(joints=joints, load=load, time={"duration": 0.1}))
    y = [0.5 * j for j in range(1, 100)]
    at = scene(load=load, time={"duration": 0.1}, record={"stress": y, "velocity": []})
    result = lattice.solve(at)
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
    chain, bar = lattice_spall(at), spall(Ricker(1e6, 0.02), 8e5, L, speed, 0.1)
    lag = (2 * np.pi / 0.02 * block / speed) ** 2 / 24 * (L + bar.distance) / speed
    assert abs(chain.time - bar.time) < 4 * lag + block / speed
    assert abs(chain.distance - bar.distance) < speed * 0.02 / 20
