"""Damping of the motion itself, beside the damping ratio of the joints."""

from math import pi
from typing import Annotated

from pydantic import Field, model_validator

from cases.schema.values import NonNegative, Positive, Table, contradiction


class Rayleigh(Table):
    """Damping ratios at two frequencies, with zeta = alpha / (2 omega) + beta omega / 2."""

    frequencies: Annotated[list[Positive], Field(min_length=2, max_length=2)]  #: Hz
    ratios: Annotated[list[NonNegative], Field(min_length=2, max_length=2)]  #: zeta at them

    @model_validator(mode="after")
    def _both_damp(self) -> "Rayleigh":
        low, high = self.frequencies
        if not low < high:
            raise contradiction(
                "damping.rayleigh.frequencies", self.frequencies, "must be two increasing numbers"
            )
        alpha, beta = self.coefficients
        if alpha < 0 or beta < 0:
            raise contradiction(
                "damping.rayleigh.ratios",
                self.ratios,
                f"would give alpha = {alpha:.4g} 1/s and beta = {beta:.4g} s; "
                "neither may be negative",
            )
        return self

    @property
    def coefficients(self) -> tuple[float, float]:
        """Alpha (1/s) and beta (s) of the damping matrix alpha M + beta K."""
        (w1, w2), (z1, z2) = (2 * pi * f for f in self.frequencies), self.ratios
        scale = 2 / (w2**2 - w1**2)
        return scale * w1 * w2 * _less(z1 * w2, z2 * w1), scale * _less(z2 * w2, z1 * w1)


class Damping(Table):
    """Damping of the motion itself, beside the dashpots of the joints."""

    mass_proportional: NonNegative | None = None  #: alpha, 1/s: a force -alpha m v on every block
    rayleigh: Rayleigh | None = None  #: alpha as above, beta the time constant of rock and joints
    local: Annotated[float, Field(ge=0, lt=1)] | None = None  #: Cundall's, for static states

    @model_validator(mode="after")
    def _one_alpha(self) -> "Damping":
        if self.rayleigh is not None and self.mass_proportional is not None:
            raise contradiction(
                "damping.mass_proportional",
                self.mass_proportional,
                "damping.rayleigh defines it already: give one of them",
            )
        return self

    @property
    def alpha(self) -> float | None:
        """Mass-proportional damping, 1/s; None where there is none."""
        given = self.rayleigh.coefficients[0] if self.rayleigh else self.mass_proportional
        return given or None


def _less(a: float, b: float) -> float:
    """Return a - b without the round-off of two numbers that are equal."""
    return 0.0 if abs(a - b) <= 1e-12 * a else a - b
