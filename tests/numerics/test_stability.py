"""The critical step of one mode, and the monitor that finds runs which gain energy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from jointwave.numerics.critical_step import critical_step
from jointwave.numerics.divergence import CREATED, ENERGY, EVERY, LAST_DIGITS, SPEED, audit, guard

KINETIC, ELASTIC, VISCOUS, WORK = range(4)


def growth(omega, eta, dt):
    """Return the largest root of z (z-1)^2 + h^2 z^2 + b (3z - 1)(z - 1) / 2, h = omega dt."""
    h2, b = (omega * dt) ** 2, eta * omega**2 * dt
    return np.abs(np.roots([1, h2 + 1.5 * b - 2, 1 - 2 * b, 0.5 * b])).max()


@given(st.floats(1, 1e5), st.floats(0, 100))
def test_one_mode_is_stable_exactly_below_the_critical_step(omega, ratio):
    """Inside the unit circle just below, outside just above, for damping ratios 0 to 100."""
    eta = 2 * ratio / omega
    dt = critical_step(lambda a, b: (a + b * eta) * omega**2, eta > 0)
    formula = np.sqrt(4 * eta**2 + 4 / omega**2) - 2 * eta
    # The formula itself cancels: its relative round-off grows with the square of the ratio.
    assert dt == pytest.approx(formula, rel=1e-9 * (1 + ratio**2))
    assert growth(omega, eta, 0.999 * dt) <= 1 + 1e-9
    assert growth(omega, eta, 1.001 * dt) > 1


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


def struck(created):
    """Return the energies of a pillar that is struck in the first sample and loses half, with so
    much of the work more in its last sample than was put in."""
    energy = np.zeros((4, 10))
    energy[WORK, 1:], energy[KINETIC, 1:], energy[VISCOUS, 1:] = 1.0, 0.5, 0.5
    energy[ELASTIC, -1] = created
    return energy


@pytest.mark.parametrize(
    ("energy", "found"),
    [
        (struck(0.99 * CREATED), -1),
        (struck(1.01 * CREATED), 9 * 20),
        (struck(-0.5), -1),  # implicit schemes may lose the energy of what they do not resolve
        # At rest under gravity: terms of 1e6 J that change in their last digits alone.
        (1e6 + 1e-9 * np.random.default_rng(3).standard_normal((4, 50)), -1),
    ],
    ids=["within the bound", "beyond the bound", "energy is lost", "last digits at rest"],
)
def test_energy_from_nowhere_is_found_in_the_sample_that_has_it(energy, found):
    held = guard(1.0)
    audit(held, energy, 0, energy.shape[1], 20)
    expected = [found, ENERGY, found - EVERY - 1] if found > 0 else [-1, SPEED, -1]
    assert held.found.tolist() == expected
