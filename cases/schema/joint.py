"""Keys of the joint law: of all joints, and of single ones that differ."""

from collections.abc import Callable
from math import atan, degrees
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from jointwave.cases.schema.law_part import LawPart, tangent
from jointwave.cases.schema.values import NonNegative, Positive, Table, contradiction

OF_ALL_JOINTS = ("contact_points", "point_rule")
#: Strength (Pa) and opening (m) of a joint that never fails beside joints that do, and closure (m)
#: of one that does not stiffen; its square is still a number.
UNLIMITED = 1e100


def _needs_friction(key: str) -> Callable[[Any], tuple[str, str] | None]:
    """Return the check that an angle is at most that of friction."""

    def wrong(law: "JointLaw") -> tuple[str, str] | None:
        angle, static = getattr(law, key), law.friction_angle
        if static is None:
            return key, "needs a friction_angle"
        return (key, f"must be at most friction_angle = {static:g}") if angle > static else None

    return wrong


def _lifts_too_far(law: "JointLaw") -> tuple[str, str] | None:
    """What lifts the faces must not take more work than friction gives: both tangents are linear in
    the path, so that the ends of the weakening decide."""
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
        sample={"maximum_closure": 1e-3},
        made={},
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
        sample={"dynamic_friction_angle": 20.0, "weakening_distance": 1e-3},
        made={"dynamic_friction": lambda law: tangent(law.dynamic_friction_angle)},
        wrong=_needs_friction("dynamic_friction_angle"),
    ),
    LawPart(
        "dilation",
        ("dilation_angle", "dilation_distance"),
        without={"dilation": 0.0, "dilation_distance": 1.0},
        words="a joint dilates as it slips",
        sample={"dilation_angle": 5.0, "dilation_distance": 1e-2},
        made={"dilation": lambda law: tangent(law.dilation_angle)},
        wrong=_lifts_too_far,
    ),
    LawPart(
        "rate and state",
        ("direct_effect", "evolution_effect", "critical_slip_distance", "reference_rate"),
        without={"direct_effect": 0.0, "evolution_effect": 0.0}
        | {"critical_slip_distance": 1.0, "reference_rate": 1.0, "initial_state": 1.0},
        words="friction depends on the rate of slip",
        sample={"direct_effect": 0.01, "evolution_effect": 0.015}
        | {"critical_slip_distance": 1e-4, "reference_rate": 1e-6},
        others=("initial_state",),
        made={
            "initial_state": lambda law: (
                law.initial_state or law.critical_slip_distance / law.reference_rate
            )
        },
        # Friction is as small as slip is slow: nothing could lift the faces.
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
        sample={"tensile_strength": 1e5, "fracture_energy": 100.0},
        made={"critical_opening": lambda law: 2 * law.fracture_energy / law.tensile_strength},
        along=False,
        instead_of=("tension",),
    ),
)
#: The keys of the parts that do not act only along a joint.
ACROSS = tuple(part.keys[0] for part in PARTS if not part.along)


class JointLaw(Table):
    """The law of one joint. Effects whose keys are absent are not computed."""

    normal_stiffness: Positive | None = None  #: Pa/m, the joint's own K_n; absent: from (4)
    maximum_closure: Positive | None = None  #: m, d_m of hyperbolic closure, K_n initially
    shear_stiffness: Positive | None = None  #: Pa/m, the joint's own K_s; absent: from (7)
    #: False: the joint carries no tension (10); True, absent: any, also with friction
    tension: bool | None = None
    damping_ratio: NonNegative | None = None  #: zeta; dashpot c_n = 2 zeta sqrt(m k_n)
    friction_angle: Annotated[float, Field(ge=0, lt=90)] | None = None  #: degrees (3)
    #: degrees, friction after slip of weakening_distance; its tangent falls linearly
    dynamic_friction_angle: Annotated[float, Field(ge=0, lt=90)] | None = None
    weakening_distance: Positive | None = None  #: m
    #: degrees, initial dilation angle of closed faces; falls to 0 over dilation_distance
    dilation_angle: Annotated[float, Field(ge=0, lt=90)] | None = None
    dilation_distance: Positive | None = None  #: m
    #: a of rate-and-state friction; friction_angle then gives mu_0
    direct_effect: Positive | None = None
    evolution_effect: NonNegative | None = None  #: b
    critical_slip_distance: Positive | None = None  #: m, D_c
    reference_rate: Positive | None = None  #: m/s, V_0, of mu_0
    initial_state: Positive | None = None  #: s, initial theta; absent: D_c / V_0
    cohesion: NonNegative | None = None  #: Pa (3)
    residual_cohesion: NonNegative | None = None  #: Pa, cohesion after the first slip
    tensile_strength: Positive | None = None  #: Pa
    fracture_energy: Positive | None = None  #: J/m2


class Joints(JointLaw):
    """The law of every joint, and the contact points of its face."""

    #: of rigid blocks: n x n per face of a pillar, n per edge of a rock mass
    contact_points: Annotated[int, Field(ge=1, le=8)] = 2
    #: midpoint: cell centres, 1 - 1/n^2 of the face's bending stiffness, and where it opens a lever
    #: of 1 - 1/n of its half width; gauss: all of the stiffness, and 0.58, 0.77, 0.86, ... 0.96
    #: of the half width for n = 2, 3, 4, ... 8
    point_rule: Literal["midpoint", "gauss"] = "midpoint"


class SoftLayer(JointLaw):
    """One joint with a law of its own; absent keys are taken from [joints]."""

    y: Positive  #: m, on a joint
    spacing_stiffness: Positive | None = None  #: Pa, S K_n; absent: as stiff as the other joints
    thickness: Positive | None = None  #: m

    @model_validator(mode="before")
    @classmethod
    def _points_are_alike(cls, table: Any) -> Any:
        for key in OF_ALL_JOINTS:
            if isinstance(table, dict) and key in table:
                raise contradiction(
                    f"soft_layers.{key}", table[key], f"applies to all joints: set joints.{key}"
                )
        return table

    @model_validator(mode="after")
    def _one_stiffness(self) -> "SoftLayer":
        if self.spacing_stiffness is not None and self.normal_stiffness is not None:
            raise contradiction(
                "soft_layers.spacing_stiffness",
                self.spacing_stiffness,
                "give this or normal_stiffness, not both",
            )
        return self

    def own_stiffness(self, spacing: float) -> float | None:
        """K_n given by the layer itself, Pa/m; None if it is as stiff as the other joints."""
        if self.spacing_stiffness is not None:
            return self.spacing_stiffness / spacing
        return self.normal_stiffness

    def under(self, joints: JointLaw) -> "SoftLayer":
        """Return the layer with missing keys taken from [joints], except its K_n."""
        absent = [key for key in JointLaw.model_fields if getattr(self, key) is None]
        absent = [key for key in absent if key != "normal_stiffness"]
        return self.model_copy(update={key: getattr(joints, key) for key in absent})
