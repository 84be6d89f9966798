"""The pulse of a load or a wave: its shape in time, or a recorded history."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from cases.schema.values import Amplitude, Positive, Table, contradiction_here

if TYPE_CHECKING:
    from cases.schema.history import History


class Pulse(Table):
    """A shape in time, and its size."""

    #: ricker: its peak at 1.5 periods; table: straight lines between the samples of a file
    shape: Literal["sine", "ricker", "step", "table"]
    amplitude: Amplitude  #: Pa, m/s or m/s2 by `quantity`; a factor on the history for "table"
    #: velocity, acceleration: of the base that a fixed start stands on
    quantity: Literal["stress", "velocity", "acceleration"] = "stress"
    period: Positive | None = None  #: s; for sine and ricker
    cycles: Annotated[int, Field(ge=1, le=1_000_000)] | None = None  #: of the sine, default 1
    file: str | None = None  #: two-column CSV, s and Pa (or m/s, m/s2); for "table"

    file_key: ClassVar[str] = "load.file"
    _history: "History | None" = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _keys_of_shape(self) -> "Pulse":
        needs = {"sine": {"period"}, "ricker": {"period"}, "step": set(), "table": {"file"}}
        takes = {"sine": {"cycles"}}
        needed = needs[self.shape]
        for key in ("period", "cycles", "file"):
            value = getattr(self, key)
            if key in needed and value is None:
                allowed = f"is needed for {{table}}.shape = '{self.shape}'"
                raise contradiction_here(key, None, allowed)
            if value is not None and key not in needed | takes.get(self.shape, set()):
                raise contradiction_here(key, value, f"has no meaning for shape '{self.shape}'")
        return self

    @model_validator(mode="after")
    def _read_history(self, info: ValidationInfo) -> "Pulse":
        if self.file is not None:
            from cases.schema.history import History  # with numpy

            context = info.context or {}
            anywhere = self.file_key in context.get("asked", ())
            try:
                self._history = History.from_csv(context.get("folder", "."), self.file, anywhere)
            except ValueError as error:
                raise contradiction_here("file", self.file, str(error)) from None
        return self

    @property
    def history(self) -> "History | None":
        """The recorded history of shape "table", else None."""
        return self._history


def shortest_period(pulses: Iterable[Pulse]) -> float | None:
    """Return the shortest period of pulses, s; None where none has one."""
    return min((one.period for one in pulses if one.period), default=None)
