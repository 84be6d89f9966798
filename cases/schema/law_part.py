"""An optional part of the joint law as all but its formula knows it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from jointwave.cases.schema.joint import JointLaw


class LawPart(NamedTuple):
    """An optional part of the joint law, all but its formula; `cases.schema.joint` lists them.

    name : of the effect. keys : which need one another; the first says whether a joint has the
    part. others : keys that need not be given.
    without : the parameters of `joints.law.Law` that it brings, at their values in a joint without
    it beside ones with it. made : how those follow from the keys that are no keys themselves.
    words : what a joint with it does. sample : keys at common values.
    along : whether it acts in shear only. instead_of : keys that contradict it.
    wrong : returns which key contradicts others and what is allowed, None where none does.
    """

    name: str
    keys: tuple[str, ...]
    without: Mapping[str, float | Callable[[Any], float]]
    words: str
    sample: dict[str, float]
    made: dict[str, Callable[[Any], float]]
    others: tuple[str, ...] = ()
    along: bool = True
    instead_of: tuple[str, ...] = ()
    wrong: Callable[[Any], tuple[str, str] | None] = lambda law: None

    def of(self, law: JointLaw) -> bool:
        """Return whether a law has this part."""
        return getattr(law, self.keys[0]) is not None

    def why(self, has: bool) -> str:
        """Return in words which key says whether joints have it."""
        return f"{self.keys[0]} is given" if has else f"no {self.keys[0]}"

    @property
    def all_keys(self) -> tuple[str, ...]:
        """Every key of it."""
        return (*self.keys, *self.others)

    def parameters(self, law: JointLaw) -> list[float]:
        """Return the parameters of a joint, in the order of `without`."""
        if not self.of(law):
            return [one(law) if callable(one) else one for one in self.without.values()]
        made = {key: getattr(law, key) for key in self.all_keys}
        made |= {name: value(law) for name, value in self.made.items()}
        return [made[name] for name in self.without]


def tangent(angle: float | None) -> float:
    """Return the tangent of an angle in degrees, 0 of none."""
    import numpy as np  # not where keys alone are completed

    return float(np.tan(np.radians(angle or 0.0)))
