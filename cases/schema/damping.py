"""Damping of the rock and of its motion, besides the damping ratio of the joints."""

from collections.abc import Iterable
from math import pi
from typing import Annotated

from pydantic import Field, model_validator

from jointwave.cases.schema.pulse import Pulse
from jointwave.cases.schema.values import (
    Increasing,
    NonNegative,
    Positive,
    Table,
    Two,
    contradiction,
)

WIDEST = 1e4  # largest ratio of the ends of a band
#: Why rigid blocks refuse a scene with a quality factor.
NOT_OF_BLOCKS = (
    "is not supported by rigid blocks, whose rock does not deform; the continuum and, of a pillar, "
    "the exact bars support it"
)


class Attenuating(Table):
    """Quality factor of the rock between joints, constant in a band of frequencies."""

    #: Q of the rock between joints; damping_ratio then damps the joints only; absent: the rock is
    #: damped like the joints
    quality_factor: Annotated[float, Field(ge=5, le=1e5)] | None = None
    #: Hz, at which the moduli give the wave speeds; absent: 1 / shortest period
    reference_frequency: Positive | None = None
    #: Hz, band of constant Q, within 4 %; absent: from 0.1 to 10 times reference_frequency and 1 /
    #: period of every load and wave
    quality_band: Annotated[list[Positive], Two] | None = None

    @model_validator(mode="after")
    def _is_a_band(self) -> "Attenuating":
        for key in ("reference_frequency", "quality_band"):
            if self.quality_factor is None and (value := getattr(self, key)) is not None:
                raise contradiction(f"rock.{key}", value, "has no meaning without quality_factor")
        low, high = self.quality_band or (1.0, 10.0)
        if not 2 * low <= high <= WIDEST * low:
            allowed = f"must be two frequencies, the second 2 to {WIDEST:,.0f} times the first"
            raise contradiction("rock.quality_band", self.quality_band, allowed)
        return self

    def quality_frequencies(self, pulses: Iterable[Pulse]) -> tuple[float, float, float]:
        """Return the reference frequency and the ends of the band for these pulses, Hz. Raises a
        contradiction if no pulse has a period, or the band excludes the reference."""
        own = [1 / one.time_scale for one in pulses if one.time_scale]
        at = self.reference_frequency or max(own, default=None)
        if at is None:
            allowed = "is required with rock.quality_factor: no load or wave has a period"
            raise contradiction("rock.reference_frequency", None, allowed)
        low, high = self.quality_band or (min([at, *own]) / 10, 10 * max([at, *own]))
        if not low <= at <= high:
            allowed = f"must include the reference frequency, {at:.6g} Hz"
            raise contradiction("rock.quality_band", self.quality_band, allowed)
        if high > 100 * WIDEST * low:
            allowed = f"must be given: {low:.4g} to {high:.4g} Hz is too wide"
            raise contradiction("rock.quality_band", None, allowed)
        return at, low, high


class Rayleigh(Table):
    """Damping ratios at two frequencies, with zeta = alpha / (2 omega) + beta omega / 2."""

    frequencies: Annotated[list[Positive], Two, Increasing]  #: Hz
    ratios: Annotated[list[NonNegative], Two]  #: zeta at these frequencies

    @model_validator(mode="after")
    def _both_damp(self) -> "Rayleigh":
        alpha, beta = self.coefficients
        if alpha < 0 or beta < 0:
            gives = f"alpha = {alpha:.4g} 1/s and beta = {beta:.4g} s"
            raise contradiction(
                ".ratios", self.ratios, f"would give {gives}; neither may be negative"
            )
        return self

    @property
    def coefficients(self) -> tuple[float, float]:
        """Coefficients alpha (1/s) and beta (s) of the damping matrix alpha M + beta K."""
        (w1, w2), (z1, z2) = (2 * pi * f for f in self.frequencies), self.ratios
        scale = 2 / (w2**2 - w1**2)
        return scale * w1 * w2 * _less(z1 * w2, z2 * w1), scale * _less(z2 * w2, z1 * w1)


class Damping(Table):
    """Damping in addition to the dashpots of the joints."""

    mass_proportional: NonNegative | None = None  #: 1/s, alpha: a force -alpha m v on every block
    rayleigh: Rayleigh | None = None  #: alpha as above, beta the time constant of rock and joints
    local: Annotated[float, Field(ge=0, lt=1)] | None = None  #: Cundall's factor, for static states

    @model_validator(mode="after")
    def _one_alpha(self) -> "Damping":
        if self.rayleigh is not None and self.mass_proportional is not None:
            allowed = "damping.rayleigh already sets it: give one of them"
            raise contradiction(".mass_proportional", self.mass_proportional, allowed)
        return self

    @property
    def alpha(self) -> float | None:
        """Mass-proportional damping, 1/s; None if there is none."""
        given = self.rayleigh.coefficients[0] if self.rayleigh else self.mass_proportional
        return given or None


def _less(a: float, b: float) -> float:
    """Return a - b, exactly 0 for numbers that are equal up to round-off."""
    return 0.0 if abs(a - b) <= 1e-12 * a else a - b
