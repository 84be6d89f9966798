"""What a guard finds, and what it lets pass."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from jointwave.numerics.divergence import (
    CREATED,
    ENERGY,
    EVERY,
    RUNAWAY,
    SPEED,
    audit,
    gains_energy,
    guard,
    look,
    out_of_bounds,
)
from jointwave.numerics.jit import jitted

KINETIC, ELASTIC, VISCOUS, WORK = range(4)


@jitted
def beyond(v, limit):
    """Return what `out_of_bounds` does, for Python."""
    return out_of_bounds(v, limit)


NUMBERS = st.floats(allow_nan=False)


@given(arrays(float, st.integers(0, 70), elements=NUMBERS), st.floats(min_value=0, max_value=1e308))
def test_magnitudes_are_compared(v, limit):
    """Infinity included."""
    assert beyond(v, limit) == (np.abs(v) > limit).any()


@given(arrays(float, st.integers(1, 70), elements=NUMBERS), st.data())
def test_the_largest_magnitude_is_not_beyond_itself(v, data):
    """And the next smaller number is below it, wherever it stands."""
    v = np.array(data.draw(st.permutations(v)))
    largest = np.abs(v).max()
    assert not beyond(v, largest)
    if largest > 0:
        assert beyond(v, np.nextafter(largest, 0))


@pytest.mark.parametrize("place", [0, 1, 40, 69])
@pytest.mark.parametrize("sign", [1, -1])
def test_what_is_no_number_is_above_every_number(sign, place):
    v = np.zeros(70)
    v[place] = np.copysign(np.nan, sign)
    assert beyond(v, np.inf)


def test_a_look_finds_what_is_beyond_the_limit_and_keeps_the_first():
    """A speed is let pass up to RUNAWAY times what forces can cause."""
    held = guard(2.0)
    look(held, 2.0 * RUNAWAY, 640)
    assert held.found[0] == -1
    look(held, np.nextafter(2.0 * RUNAWAY, np.inf), 704)
    look(held, np.nan, 768)
    assert held.found.tolist() == [704, SPEED, 704 - EVERY - 1]


def test_what_is_found_at_the_first_step_stays():
    held = guard(2.0)
    look(held, np.inf, 0)
    look(held, np.inf, 96)
    assert held.found.tolist() == [0, SPEED, -EVERY - 1]


def test_energy_is_found_in_its_sample():
    """Sample 2 holds 5 J of which 1 J was put in."""
    peak, energy = np.zeros(1), np.array([[0.0, 0.0, 5.0], [0.0, 0.0, 1.0]])
    assert not gains_energy(peak, energy, 1)
    assert gains_energy(peak, energy, 2)


@given(arrays(float, (4, 9), elements=st.floats(-9, 9) | st.sampled_from([np.inf, np.nan])))
def test_all_samples_at_once_are_judged_as_one_by_one(energy):
    """In two stretches, the largest change of the first held over to the second."""
    held, peak = guard(1.0), np.zeros(1)
    with np.errstate(invalid="ignore"):
        found = next((5 * s for s in range(9) if gains_energy(peak, energy, s)), None)
    audit(held, energy, 0, 4, 5)
    audit(held, energy, 4, 9, 5)
    expected = [-1, SPEED, -1] if found is None else [found, ENERGY, found - EVERY - 1]
    assert held.found.tolist() == expected


@pytest.mark.parametrize("speed", [np.nan, np.inf])
def test_a_look_finds_what_is_no_number(speed):
    """Even where no bound is known."""
    held = guard(np.inf)
    look(held, speed, 64)
    assert held.found[0] == 64


def ledger(created, samples=10):
    """Return the energies of a pillar that is struck in the first sample and loses half, with so
    much of the work more in its last sample than was put in."""
    energy = np.zeros((4, samples))
    energy[WORK, 1:], energy[KINETIC, 1:], energy[VISCOUS, 1:] = 1.0, 0.5, 0.5
    energy[ELASTIC, -1] = created
    return energy


@pytest.mark.parametrize(("share", "found"), [(0.99, -1), (1.01, 9 * 20)])
def test_energy_from_nowhere_is_found_in_the_sample_that_has_it(share, found):
    held = guard(1.0)
    audit(held, ledger(share * CREATED), 0, 10, 20)
    assert held.found[0] == found
    if found > 0:
        assert held.found[1:].tolist() == [ENERGY, found - EVERY - 1]


def test_energy_that_is_lost_is_no_fault():
    """Implicit schemes may take energy out of what they do not resolve."""
    held = guard(1.0)
    audit(held, ledger(-0.5), 0, 10, 20)
    assert held.found[0] == -1


def test_digits_of_energies_at_rest_are_no_energy():
    """A pillar at rest under gravity: terms of 1e6 J that change in their last digits alone."""
    energy = 1e6 + 1e-9 * np.random.default_rng(3).standard_normal((4, 50))
    held = guard(1.0)
    audit(held, energy, 0, 50, 1)
    assert held.found[0] == -1
