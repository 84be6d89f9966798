"""All hard cases, in the order of the report."""

from compare.stability.case import Case
from compare.stability.extreme import EXTREME
from compare.stability.failing import FAILING
from compare.stability.linear import LINEAR

CASES: list[Case] = [*LINEAR, *EXTREME, *FAILING]
