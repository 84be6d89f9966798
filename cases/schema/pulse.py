"""The pulse of a load or a wave: its shape in time, or a recorded history."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from cases.schema.values import Amplitude, NonNegative, Positive, Table, contradiction_here

if TYPE_CHECKING:
    from cases.schema.history import History

#: The keys that a shape needs, and those that it may have.
NEEDS: dict[str, set[str]] = {
    "sine": {"period"},
    "half-sine": {"period"},
    "ricker": {"period"},
    "gabor": {"period", "cycles"},
    "triangle": {"rise", "decay"},
    "step": set(),
    "table": {"file"},
}
TAKES = {"sine": {"cycles"}}


class Pulse(Table):
    """A shape in time, and its size."""

    #: half-sine: half a period; ricker: its peak at 1.5 periods; gabor: a cosine in a Gaussian, its
    #: peak at 1.6 `cycles`; triangle: a blast; table: straight lines between the samples of a file
    shape: Literal["sine", "half-sine", "ricker", "gabor", "triangle", "step", "table"]
    amplitude: Amplitude  #: Pa, m/s or m/s2 by `quantity`; a factor on the history for "table"
    #: velocity, acceleration: of the base that a fixed start stands on; where it is quiet, of the
    #: wave that enters there, by the stress 2 rho c times its velocity
    quantity: Literal["stress", "velocity", "acceleration"] = "stress"
    period: Positive | None = None  #: s; for sine, half-sine, ricker and gabor
    #: of the sine, default 1; of gabor those within two standard deviations of its envelope
    cycles: Annotated[int, Field(ge=1, le=1_000_000)] | None = None
    rise: NonNegative | None = None  #: s, from zero to the peak of a triangle
    decay: Positive | None = None  #: s, from there to zero
    #: for "table": two-column CSV, s and Pa (or m/s, m/s2); or one trace, .sac or .mseed
    file: str | None = None

    file_key: ClassVar[str] = "load.file"
    _history: "History | None" = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _keys_of_shape(self) -> "Pulse":
        needed = NEEDS[self.shape]
        for key in ("period", "cycles", "rise", "decay", "file"):
            value = getattr(self, key)
            if key in needed and value is None:
                allowed = f"is needed for {{table}}.shape = '{self.shape}'"
                raise contradiction_here(key, None, allowed)
            if value is not None and key not in needed | TAKES.get(self.shape, set()):
                raise contradiction_here(key, value, f"has no meaning for shape '{self.shape}'")
        return self

    @model_validator(mode="after")
    def _read_history(self, info: ValidationInfo) -> "Pulse":
        if self.file is not None:
            from cases.schema.history import History  # with numpy

            context = info.context or {}
            anywhere = self.file_key in context.get("asked", ())
            try:
                self._history = History.read(context.get("folder", "."), self.file, anywhere)
            except ValueError as error:
                raise contradiction_here("file", self.file, str(error)) from None
        return self

    @property
    def history(self) -> "History | None":
        """The recorded history of shape "table", else None."""
        return self._history

    @property
    def time_scale(self) -> float | None:
        """The period, or that of the half sine that lasts as long as a triangle, s; None of a step
        or a record."""
        if self.rise is not None and self.decay is not None:
            return 2 * (self.rise + self.decay)
        return self.period


def shortest_period(pulses: Iterable[Pulse]) -> float | None:
    """Return the shortest time scale of pulses, s; None where none has one."""
    return min((one.time_scale for one in pulses if one.time_scale), default=None)
