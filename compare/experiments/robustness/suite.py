"""All hard cases, in the order of the report."""

from compare.experiments.robustness.case import Case
from compare.experiments.robustness.extreme_cases import EXTREME
from compare.experiments.robustness.failing_cases import FAILING
from compare.experiments.robustness.linear_cases import LINEAR

CASES: list[Case] = [*LINEAR, *EXTREME, *FAILING]
