"""`numerics.formula.formula`, by which the formulas of the law are declared."""

from numerics.formula import formula

__all__ = ["formula"]
