"""The claims of Guo & Li (2002), figure by figure, measured on every engine.

A claim holds or it does not, by the numbers in its sentence; one that fails is shown like any
other. The distances of the engines from exact solutions are in the tables of misfits.
"""

from jointwave.compare.misfit.pairs import Comparison
from jointwave.compare.report.claims import joints, pillar, travel  # noqa: F401 (add theirs)
from jointwave.compare.report.claims.claim import CLAIMS, Claim


def claims_of(figure: int | None, comparisons: list[Comparison]) -> list[Claim]:
    """Return the claims of a figure of the paper; none for any other scene."""
    return [measure(comparisons) for measure in CLAIMS.get(figure or 0, [])]
