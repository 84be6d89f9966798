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
    LAST_DIGITS,
    SPEED,
    audit,
    guard,
)

KINETIC, ELASTIC, VISCOUS, WORK = range(4)


def gains_energy(energy, s):
    """Whether sample s of a ledger has more energy than was put in, by its definition."""
    gained = energy[:, s] - energy[:, 0]
    peak = max((abs(x) for x in (energy[:, : s + 1] - energy[:, :1]).ravel() if x == x), default=0)
    most = max((abs(x) for x in energy[:, s] if x == x), default=0)
    return sum(gained[:-1]) - gained[-1] > CREATED * peak + LAST_DIGITS * most


@given(arrays(float, (4, 9), elements=st.floats(-9, 9) | st.sampled_from([np.inf, np.nan])))
def test_all_samples_at_once_are_judged_as_one_by_one(energy):
    """In two stretches, the largest change of the first held over to the second."""
    held = guard(1.0)
    with np.errstate(invalid="ignore"):
        found = next((5 * s for s in range(9) if gains_energy(energy, s)), None)
    audit(held, energy, 0, 4, 5)
    audit(held, energy, 4, 9, 5)
    expected = [-1, SPEED, -1] if found is None else [found, ENERGY, found - EVERY - 1]
    assert held.found.tolist() == expected


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
