"""All hard cases, in the order of the report."""

from compare.stability.case import Case
from compare.stability.extreme_cases import EXTREME
from compare.stability.failing_cases import FAILING
from compare.stability.linear_cases import LINEAR

CASES: list[Case] = [*LINEAR, *EXTREME, *FAILING]
