"""Every row of the suite holds, or says why it does not apply."""

from math import isfinite

import numpy as np
import pytest

from compare.experiments.robustness.case import SCHEMES
from compare.experiments.robustness.extreme_cases import EXTREME
from compare.experiments.robustness.linear_cases import LINEAR
from compare.experiments.robustness.run import CASES, HELD, NONE, places, row_at

JOINTED, EQUIVALENT, IMPLICIT = "continuum-jointed", "continuum-equivalent", " implicit"
#: Rows that take many seconds each, by what the names of their solvers hold; the case's other rows,
#: or the same judgement of a case nearby, are quick.
LONG = {
    "implicit steps far above the critical": JOINTED,
    "load at the lattice cut-off, deformable rock": IMPLICIT,
    "load twice the lattice cut-off, deformable rock": (JOINTED, IMPLICIT),
    "prestress that cancels the wave": JOINTED,
    "stick-slip at the exact threshold": "",
    "every second joint 1e-8 as stiff": JOINTED,
    "damping ratio 0": JOINTED,
    "damping ratio 1": JOINTED,
    "damping ratio 10": JOINTED,
    "softening just short of a snap-back": JOINTED,
    "soft layer of 1e-12 of a joint's stiffness": (JOINTED, IMPLICIT),
    "joints that open, close, slip and break": JOINTED,
    "joints that open and close by 1e-40 m": IMPLICIT,
    "a million blocks": "fourth-order",
    "one set 1e8 as stiff as the other": IMPLICIT,
    "joints that open, close, slip and break; a joint stiffens as it closes": "",
    "joints that open, close, slip and break; slip weakens a joint": "",
    "the ledger of blocks a thousandth as thin as their neighbours": JOINTED,
    "the ledger of blocks that end in a point of one degree": JOINTED,
}
#: Laws whose kernels take long to compile, and whose ledgers close at round-off in every run in
#: tests/dem/blocks/test_conservation.py: "slip that weakens and lifts".
LONG |= dict.fromkeys(
    (
        "T-junctions of brickwork that slide; a joint stiffens as it closes",
        "T-junctions of brickwork that slide; slip weakens a joint",
        "T-junctions of brickwork that slide; a joint dilates as it slips",
        "the ledger of T-junctions of brickwork that slide, lifted by slip",
    ),
    "",
)
#: Of linear rock in both models and by both schemes, two rows stand for four.
CROSSED = (f"{JOINTED} implicit", f"{EQUIVALENT} explicit")


def is_long(case, stepper):
    """Return whether a row is left to `make test-all`."""
    dear = LONG.get(case.name)
    if case.slow or dear is not None:
        return case.slow or any(part in stepper.name for part in np.atleast_1d(dear))
    same = [one for one in SCHEMES if one.engine is stepper.engine]
    both = not any(case.why_spared(one) for one in same)
    return stepper.name in CROSSED and both and case in [*LINEAR, *EXTREME]


def rows():
    for i, j in places():
        case, stepper = CASES[i], SCHEMES[j]
        marks = [pytest.mark.slow] if is_long(case, stepper) else []
        yield pytest.param((i, j), id=f"{case.name}, {stepper.name}", marks=marks)


@pytest.mark.parametrize("place", list(rows()))
def test_row_holds_or_says_why_not(place):
    """The value is within the theoretical bound; a row that does not apply has a reason."""
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
