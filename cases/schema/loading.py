"""The load of a scene: an end stress, or the motion of its base."""

from math import frexp
from typing import Annotated, Literal

from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from cases.schema.history import History
from cases.schema.values import (
    Amplitude,
    Direction,
    Offset,
    Positive,
    Table,
    contradiction,
    is_extreme,
)


class Load(Table):
    """What acts on the loaded end: the end stress F/A, or the prescribed motion of a fixed start.

    The force acts along `direction` on the start face, `at` (x, z) from its centre; with `arm` it
    is a pure couple A p arm about `direction` instead.
    """

    #: ricker: its peak at 1.5 periods; table: straight lines between the samples of a file
    shape: Literal["sine", "ricker", "step", "table"]
    amplitude: Amplitude  #: Pa, m/s or m/s2 by `quantity`; a factor on the history for "table"
    #: velocity, acceleration: of the base that a fixed start stands on
    quantity: Literal["stress", "velocity", "acceleration"] = "stress"
    period: Positive | None = None  #: s; for sine and ricker
    cycles: Annotated[int, Field(ge=1, le=1_000_000)] | None = None  #: of the sine, default 1
    file: str | None = None  #: two-column CSV, s and Pa (or m/s, m/s2); for "table"
    direction: Direction = Field(default=[0, 1, 0])  #: x, y, z
    at: Offset = Field(default=[0.0, 0.0])  #: m, x and z from the centre
    arm: Positive | None = None  #: m, of a couple

    _history: History | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _keys_of_shape(self) -> "Load":
        needs = {"sine": {"period"}, "ricker": {"period"}, "step": set(), "table": {"file"}}
        takes = {"sine": {"cycles"}}
        needed = needs[self.shape]
        for key in ("period", "cycles", "file"):
            given = getattr(self, key) is not None
            if key in needed and not given:
                raise contradiction(
                    f"load.{key}", None, f"is needed for load.shape = '{self.shape}'"
                )
            if given and key not in needed | takes.get(self.shape, set()):
                raise contradiction(
                    f"load.{key}", getattr(self, key), f"has no meaning for shape '{self.shape}'"
                )
        return self

    @model_validator(mode="after")
    def _one_lever(self) -> "Load":
        if self.arm is not None and self.is_eccentric:
            raise contradiction("load.arm", self.arm, "makes a couple, which has no load.at")
        if self.shakes_base:
            for key, value in (("at", self.at if self.is_eccentric else None), ("arm", self.arm)):
                if value is not None:
                    raise contradiction(
                        f"load.{key}", value, f"has no meaning for load.quantity '{self.quantity}'"
                    )
        return self

    @model_validator(mode="after")
    def _read_history(self, info: ValidationInfo) -> "Load":
        if self.file is not None:
            context = info.context or {}
            anywhere = "load.file" in context.get("asked", ())
            try:
                self._history = History.from_csv(context.get("folder", "."), self.file, anywhere)
            except ValueError as error:
                raise contradiction("load.file", self.file, str(error)) from None
        return self

    @property
    def scale(self) -> float:
        """A power of two that an extreme load is divided by and its result multiplied; else 1.

        The motion of such a load would be below or above all numbers; scaled by a power of two it
        is that of a load near 1, digit by digit.
        """
        return 2.0 ** frexp(self.amplitude)[1] if is_extreme(self.amplitude) else 1.0

    @property
    def history(self) -> History | None:
        """The recorded load history of shape "table", else None."""
        return self._history

    @property
    def shakes_base(self) -> bool:
        """Whether the load is the motion of the start rather than a stress on it."""
        return self.quantity != "stress"

    @property
    def is_eccentric(self) -> bool:
        """Whether the force acts off the centre of the face."""
        return any(self.at)

    @property
    def is_across(self) -> bool:
        """Whether the load has a component across the axis."""
        return bool(self.direction[0] or self.direction[2])


#: What acts where a scene has no [load].
NO_LOAD = Load(shape="step", amplitude=0.0)
