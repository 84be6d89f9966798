"""The strength and the closure of every joint, from its own keys or those of [joints]."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import reduce

import numpy as np

from jointwave.cases.schema.joint import JointLaw
from jointwave.cases.schema.law_parts import PARTS, UNLIMITED, tangent

#: The keys of slip: without them no joint has that effect.
SLIP = ("friction_angle", "cohesion", "residual_cohesion")
#: The parameters that do not act only along a joint: axial motion ignores the others.
ACROSS = tuple(name for part in PARTS if not part.along for name in part.without)
#: All parameters, as `joints.law.Law` names them.
NAMES = ("friction", "cohesion", "residual_cohesion", *(n for part in PARTS for n in part.without))


@dataclass(frozen=True)
class Strength:
    """The parameters of the joints' strength and closure, as `joints.law.Law` names them.

    Each is an attribute: a float array [N - 1], None where no joint has it.
    """

    given: dict[str, np.ndarray] = field(default_factory=dict)

    def __getattr__(self, name: str) -> np.ndarray | None:
        if name in NAMES:
            return self.given.get(name)
        raise AttributeError(name)

    def strengths(
        self, shears: bool = True, joint: np.ndarray | slice = np.s_[:]
    ) -> dict[str, np.ndarray | None]:
        """Return the parameters by name at some joints; shears : those along the joints, too."""
        names = NAMES if shears else ACROSS
        return {name: self.given[name][joint] for name in names if name in self.given}

    def across(self) -> np.ndarray | bool:
        """Return which joints have a part of the law that does not act only along them [N - 1]."""
        without = {name: one for part in PARTS for name, one in part.without.items()}
        has = (self.given[name] != without[name] for name in ACROSS if name in self.given)
        return reduce(np.logical_or, has, False)


def strength_of(laws: Sequence[JointLaw], which: np.ndarray) -> Strength:
    """Return the strength of joints, of which each has the law `which` (int array [n]) of `laws`.

    Beside joints that slip, one without friction and cohesion of its own has a cohesion without
    limit; what a joint without another part has beside ones with it, `PARTS` says.
    """
    found = _of_slip(laws)
    for part in PARTS:
        if any(map(part.of, laws)):
            values = zip(*map(part.parameters, laws), strict=True)
            found |= dict(zip(part.without, values, strict=True))
    return Strength({name: np.array(values, dtype=float)[which] for name, values in found.items()})


def _of_slip(laws: Sequence[JointLaw]) -> dict[str, Sequence[float]]:
    """Return the friction and cohesions of laws, those that any of them gives."""
    angles, given, residual = ([getattr(law, key) for law in laws] for key in SLIP)
    never = [angle is None and own is None for angle, own in zip(angles, given, strict=True)]
    if all(never):
        return {}
    whole = [UNLIMITED if n else own or 0.0 for n, own in zip(never, given, strict=True)]
    left = [w if own is None else own for w, own in zip(whole, residual, strict=True)]
    found = {
        "friction": ([tangent(one) for one in angles], any(a is not None for a in angles)),
        "cohesion": (whole, any(never) or any(own is not None for own in given)),
        "residual_cohesion": (left, any(own is not None for own in residual)),
    }
    return {name: values for name, (values, has) in found.items() if has}
