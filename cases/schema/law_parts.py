"""The optional parts of the joint law, except their formulas."""

from collections.abc import Callable, Mapping
from math import atan, degrees
from types import MappingProxyType
from typing import Any, NamedTuple

from jointwave.cases.schema.joint import JointLaw, SoftLayer

#: Strength (Pa) and critical opening (m) of a joint that never fails among joints that do, and
#: maximum closure (m) of one that does not stiffen; its square does not overflow.
UNLIMITED = 1e100
#: Keys of dashpots that follow the stiffness of a joint, and change with it.
AGAINST_VISCOSITY = ("damping_ratio", "maximum_closure")


class LawPart(NamedTuple):
    """An optional part of the joint law, except its formula.

    name : of the effect. keys : required together; the first says whether a joint has the part.
    others : optional keys. without : the parameters of `joints.law.Law` that the part adds, with
    the values of a joint without it among joints with it. made : formulas of parameters that are
    not keys. words : what a joint with it does. along : whether it acts in shear only. instead_of :
    keys that contradict it. wrong : returns a key that contradicts others and what is allowed, or
    None.
    """

    name: str
    keys: tuple[str, ...]
    without: Mapping[str, float | Callable[[Any], float]]
    words: str
    made: Mapping[str, Callable[[Any], float]] = MappingProxyType({})
    others: tuple[str, ...] = ()
    along: bool = True
    instead_of: tuple[str, ...] = ()
    wrong: Callable[[Any], tuple[str, str] | None] = lambda law: None

    def of(self, law: JointLaw) -> bool:
        """Return whether a law has this part."""
        return getattr(law, self.keys[0]) is not None

    def why(self, has: bool) -> str:
        """Return which key says whether joints have it, as text."""
        return f"{self.keys[0]} is given" if has else f"no {self.keys[0]}"

    @property
    def all_keys(self) -> tuple[str, ...]:
        """All its keys."""
        return (*self.keys, *self.others)

    def parameters(self, law: JointLaw) -> list[float]:
        """Return the parameters of a joint, in the order of `without`."""
        if not self.of(law):
            return [one(law) if callable(one) else one for one in self.without.values()]
        made = {key: getattr(law, key) for key in self.all_keys}
        made |= {name: value(law) for name, value in self.made.items()}
        return [made[name] for name in self.without]


def tangent(angle: float | None) -> float:
    """Return the tangent of an angle in degrees; 0 for None."""
    import numpy as np  # not needed for completing keys

    return float(np.tan(np.radians(angle or 0.0)))


def _needs_friction(key: str) -> Callable[[Any], tuple[str, str] | None]:
    """Return the check that an angle does not exceed the friction angle."""

    def wrong(law: JointLaw) -> tuple[str, str] | None:
        angle, static = getattr(law, key), law.friction_angle
        if static is None:
            return key, "needs a friction_angle"
        return (key, f"must be at most friction_angle = {static:g}") if angle > static else None

    return wrong


def _dilates_too_far(law: JointLaw) -> tuple[str, str] | None:
    """Check that dilation takes no more work than friction dissipates: both tangents are linear in
    the slip path, so the ends of the weakening decide."""
    if (found := _needs_friction("dilation_angle")(law)) is not None:
        return found
    dynamic, distance = law.dynamic_friction_angle, law.weakening_distance
    if dynamic is None or distance is None or law.dilation_distance is None:
        return None
    share = max(1 - distance / law.dilation_distance, 0.0)
    if share * tangent(law.dilation_angle) <= tangent(dynamic):
        return None
    most = degrees(atan(tangent(dynamic) / share))
    return "dilation_angle", (
        f"must be at most {most:.4g}, so that dilation stays below friction at "
        f"dynamic_friction_angle = {dynamic:g}"
    )


PARTS = (
    LawPart(
        "closure",
        ("maximum_closure",),
        without={"maximum_closure": UNLIMITED},
        words="a joint stiffens as it closes",
        along=False,
    ),
    LawPart(
        "weakening",
        ("weakening_distance", "dynamic_friction_angle"),
        without={
            "weakening_distance": 1.0,
            "dynamic_friction": lambda law: tangent(law.friction_angle),
        },
        words="slip weakens a joint",
        made={"dynamic_friction": lambda law: tangent(law.dynamic_friction_angle)},
        wrong=_needs_friction("dynamic_friction_angle"),
    ),
    LawPart(
        "dilation",
        ("dilation_angle", "dilation_distance"),
        without={"dilation": 0.0, "dilation_distance": 1.0},
        words="a joint dilates as it slips",
        made={"dilation": lambda law: tangent(law.dilation_angle)},
        wrong=_dilates_too_far,
    ),
    LawPart(
        "rate and state",
        ("direct_effect", "evolution_effect", "critical_slip_distance", "reference_rate"),
        without={"direct_effect": 0.0, "evolution_effect": 0.0}
        | {"critical_slip_distance": 1.0, "reference_rate": 1.0, "initial_state": 1.0},
        words="friction depends on the rate of slip",
        others=("initial_state",),
        made={
            "initial_state": lambda law: (
                law.initial_state or law.critical_slip_distance / law.reference_rate
            )
        },
        # Friction vanishes in slow slip: it could not do the work of dilation.
        instead_of=("dynamic_friction_angle", "dilation_angle"),
        wrong=lambda law: (
            None if law.friction_angle else ("direct_effect", "needs a friction_angle")
        ),
    ),
    LawPart(
        "softening",
        ("tensile_strength", "fracture_energy"),
        without={"tensile_strength": UNLIMITED, "critical_opening": UNLIMITED},
        words="a joint has a tensile strength",
        made={"critical_opening": lambda law: 2 * law.fracture_energy / law.tensile_strength},
        along=False,
        instead_of=("tension",),
    ),
)


def under(layer: SoftLayer, joints: JointLaw) -> SoftLayer:
    """Return a layer with absent keys from [joints], except K_n and what contradicts its own."""
    own = {key for key in JointLaw.model_fields if getattr(layer, key) is not None}
    left = own | {"normal_stiffness"}
    left |= {*AGAINST_VISCOSITY} if "viscosity" in own else set()
    left |= {"viscosity"} if own & {*AGAINST_VISCOSITY} else set()
    for part in PARTS:
        against = set(part.instead_of)
        against.update(*(one.all_keys for one in PARTS if against & {*one.keys}))
        left |= against if own & {*part.all_keys} else set()
        left |= {*part.all_keys} if own & against else set()
    taken = [key for key in JointLaw.model_fields if key not in left]
    return layer.model_copy(update={key: getattr(joints, key) for key in taken})
