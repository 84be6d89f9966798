"""The load of a scene: an end stress, or the motion of its base."""

from math import frexp

from pydantic import Field, model_validator

from cases.schema.pulse import Pulse
from cases.schema.values import Direction, Offset, Positive, contradiction, is_extreme


class Load(Pulse):
    """What acts on the loaded end: the end stress F/A, the prescribed motion of a fixed start, or
    the wave that comes up to a quiet start from the rock behind it.

    The force acts along `direction` on the start face, `at` (x, z) from its centre; with `arm` it
    is a pure couple A p arm about `direction` instead.
    """

    direction: Direction = Field(default=[0, 1, 0])  #: x, y, z
    at: Offset = Field(default=[0.0, 0.0])  #: m, x and z from the centre
    arm: Positive | None = None  #: m, of a couple

    @model_validator(mode="after")
    def _one_lever(self) -> "Load":
        if self.arm is not None and self.is_eccentric:
            raise contradiction("load.arm", self.arm, "makes a couple, which has no load.at")
        if self.is_motion:
            for key, value in (("at", self.at if self.is_eccentric else None), ("arm", self.arm)):
                if value is not None:
                    raise contradiction(
                        f"load.{key}", value, f"has no meaning for load.quantity '{self.quantity}'"
                    )
        return self

    @property
    def scale(self) -> float:
        """A power of two that an extreme load is divided by and its result multiplied; else 1.

        The motion of such a load would be below or above all numbers; scaled by a power of two it
        is that of a load near 1, digit by digit.
        """
        return 2.0 ** frexp(self.amplitude)[1] if is_extreme(self.amplitude) else 1.0

    @property
    def is_motion(self) -> bool:
        """Whether the load is the motion of a base rather than a stress."""
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
