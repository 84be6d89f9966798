"""Every row of the suite holds, or says why it does not apply."""

from math import isfinite

import pytest

from compare.experiments.robustness.case import SCHEMES
from compare.experiments.robustness.run import CASES, HELD, NONE, places, row_at

#: Rows of deformable rock that take many seconds each; other rows of these cases are quick.
LONG = {
    "implicit steps far above the critical",
    "load twice the lattice cut-off, deformable rock",
    "prestress that cancels the wave",
    "stick-slip at the exact threshold",
    "every second joint 1e-8 as stiff",
    "damping ratio 0",
    "damping ratio 10",
    "softening just short of a snap-back",
    "soft layer of 1e-12 of a joint's stiffness",
}


def rows():
    for i, j in places():
        case, stepper = CASES[i], SCHEMES[j]
        long = case.name in LONG and stepper.name.startswith("continuum-jointed")
        marks = [pytest.mark.slow] if case.slow or long else []
        yield pytest.param((i, j), id=f"{case.name}, {stepper.name}", marks=marks)


@pytest.mark.parametrize("place", list(rows()))
def test_row_holds_or_says_why_not(place):
    """The value is within the bound that theory gives; what does not apply has a reason."""
    row = row_at(place)
    about = f"{row.criterion}: {row.value:.3g}, bound {row.bound:.3g}; {row.message}"
    assert row.state in (HELD, NONE), about
    if row.state == HELD:
        assert isfinite(row.value) and isfinite(row.bound) and row.margin >= 1
    else:
        assert len(row.message) > 10


def test_no_row_is_skipped():
    """Every case has a row on every solver, and is held by at least one of them."""
    assert places() == [(i, j) for i in range(len(CASES)) for j in range(len(SCHEMES))]
    assert all(any(case.why_spared(s) is None for s in SCHEMES) for case in CASES)


def test_cases_have_names_of_their_own():
    """A row is found again by its case, engine and scheme."""
    assert len({case.name for case in CASES}) == len(CASES)
