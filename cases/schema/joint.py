"""Keys of the joint law: of all joints, and of single ones that differ."""

from typing import Annotated, Any, Literal

from pydantic import Field, ValidationInfo, model_validator

from jointwave.cases.schema.values import (
    Dip,
    DipDirection,
    NonNegative,
    Point,
    Positive,
    Table,
    Words,
    check_attitude,
    contradiction,
)

OF_ALL_JOINTS = ("contact_points", "point_rule")


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

    #: of rigid blocks, with midpoint or gauss: n per edge in the plane, n x n per face in space;
    #: absent: 2
    contact_points: Annotated[int, Field(ge=1, le=8)] | None = None
    #: vertices: corners and centroid, all of the face's bending stiffness, and where it opens its
    #: whole half width as lever; midpoint: cell centres, 1 - 1/n^2 of the stiffness and 1 - 1/n of
    #: the half width; gauss: all of the stiffness and 0.58, 0.77, 0.86, ... 0.96 of the half width
    #: for n = 2, 3, 4, ... 8
    point_rule: Literal["vertices", "midpoint", "gauss"] = "vertices"

    @model_validator(mode="after")
    def _vertices_are_as_many_as_they_are(self) -> "Joints":
        if self.point_rule == "vertices" and self.contact_points is not None:
            allowed = "needs point_rule = 'midpoint' or 'gauss': vertices have no other number"
            raise contradiction(".contact_points", self.contact_points, allowed)
        return self


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
                allowed = f"applies to all joints: set joints.{key}"
                raise contradiction(f".{key}", table[key], allowed)
        return table

    @model_validator(mode="after")
    def _one_stiffness(self) -> "SoftLayer":
        if self.spacing_stiffness is not None and self.normal_stiffness is not None:
            allowed = "give this or normal_stiffness, not both"
            raise contradiction(".spacing_stiffness", self.spacing_stiffness, allowed)
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


class JointSet(Joints):
    """A set of parallel joints, or one joint, and its law."""

    name: Words  #: used in `ends_at`, tables and figures
    #: degrees from the horizontal; in the plane counter-clockwise: joints run along (cos, sin)
    dip: Dip
    #: of the line of dip, degrees clockwise from north (y); in space, unless horizontal
    dip_direction: DipDirection | None = None
    spacing: Positive | None = None  #: m, across the joints; absent: one joint, `through` a point
    through: Point | None = None  #: m, a point of one of the joints; absent: the origin
    ends_at: list[str] = Field(default_factory=list)  #: names of sets at whose joints these end
    #: names of [[regions]] that it cuts, "rock" for rock in no region; absent: all
    regions: list[str] = Field(default_factory=list)
    #: offset along the `ends_at` joints from row to row, over the spacing; 0.5: brickwork
    offset: Annotated[float, Field(ge=0, lt=1)] = 0.0
    #: coefficient of variation of the spacing; uniformly distributed
    scatter: Annotated[float, Field(ge=0, le=0.5)] = 0.0
    seed: Annotated[int, Field(ge=0, lt=2**63)] | None = None  #: of the scatter

    @model_validator(mode="after")
    def _has_attitude(self, info: ValidationInfo) -> "JointSet":
        check_attitude(self, info)
        return self
