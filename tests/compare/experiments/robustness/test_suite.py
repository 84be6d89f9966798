"""Every row of the suite holds, or says why it does not apply."""

from math import isfinite

import pytest

from compare.experiments.robustness.case import SCHEMES
from compare.experiments.robustness.run import CASES, HELD, NONE, places, row_at


def rows():
    for i, j in places():
        case, stepper = CASES[i], SCHEMES[j]
        marks = [pytest.mark.slow] if case.slow else []
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
