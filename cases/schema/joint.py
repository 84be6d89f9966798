"""Keys of the joint law: of all joints, and of single ones that differ."""

from math import cos, radians, sin
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, PrivateAttr, ValidationInfo, model_validator

from jointwave.cases.schema.values import (
    Dip,
    DipDirection,
    NonNegative,
    Point,
    Positive,
    Table,
    Words,
    check_dimension,
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
    #: Pa s/m, c_n of a joint itself, whatever the rock beside it; in shear c_n K_s / K_n
    viscosity: NonNegative | None = None
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

    @property
    def is_damped(self) -> bool:
        """Whether the joint has a dashpot of its own."""
        return bool(self.damping_ratio or self.viscosity)


class Joints(JointLaw):
    """The law of every joint, and the contact points of its face."""

    #: of rigid blocks, with midpoint or gauss: n per edge in the plane, n x n per face in space;
    #: absent: 2
    contact_points: Annotated[int, Field(ge=1, le=8)] | None = None
    #: vertices: corners and centroid, with all of the face's bending stiffness, and its whole half
    #: width as lever where it opens; midpoint: cell centres, 1 - 1/n^2 of the stiffness and 1 - 1/n
    #: of the half width; gauss: all of the stiffness and 0.58, 0.77, 0.86, ... 0.96 of the half
    #: width for n = 2, 3, 4, ... 8
    point_rule: Literal["vertices", "midpoint", "gauss"] = "vertices"

    @model_validator(mode="after")
    def _no_number_of_vertices(self) -> "Joints":
        if self.point_rule == "vertices" and self.contact_points is not None:
            allowed = "needs point_rule = 'midpoint' or 'gauss': vertices have no other number"
            raise contradiction(".contact_points", self.contact_points, allowed)
        return self


class SoftLayer(JointLaw):
    """One joint with its own law; absent keys are taken from [joints], except those that contradict
    its own."""

    y: Positive  #: m, on a joint
    spacing_stiffness: Positive | None = None  #: Pa, S K_n; absent: as stiff as the other joints
    thickness: Positive | None = None  #: m

    @model_validator(mode="before")
    @classmethod
    def _no_contact_points(cls, table: Any) -> Any:
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
        """Return the layer's given K_n, Pa/m; None if it is as stiff as the other joints."""
        if self.spacing_stiffness is not None:
            return self.spacing_stiffness / spacing
        return self.normal_stiffness


#: Exact cosine and sine of some dips, degrees.
EXACT = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0)}


def direction_of(dip: float) -> np.ndarray:
    """Return the unit vector [2] along joints of this dip, degrees from the horizontal."""
    exact = EXACT.get(abs(dip), (cos(radians(dip)), sin(radians(abs(dip)))))
    return np.array([exact[0], exact[1] if dip >= 0 else -exact[1]])


class Inclined(Table):
    """Planes with a dip, and in space a dip direction."""

    _dimension: int = PrivateAttr(default=2)

    @model_validator(mode="after")
    def _has_attitude(self: Any, info: ValidationInfo) -> Any:
        if check_dimension(self, info, space=("dip_direction",)):
            self._dimension = 3
            if self.dip % 180 and self.dip_direction is None:
                allowed = (
                    "is required in space: of the line of dip, degrees clockwise from north (y)"
                )
                raise contradiction(".dip_direction", None, allowed)
        return self

    @property
    def frame(self: Any) -> np.ndarray:
        """The upward unit normal of the planes, then unit vectors in them [d, d]: in the plane the
        direction of the joints, in space strike and dip line."""
        down, up = direction_of(self.dip)
        if self._dimension == 2:
            return np.array([[-up, down], [down, up]])
        turn = (self.dip_direction or 0.0) % 360
        north, east = direction_of(turn - 360 if turn > 180 else turn)
        return np.array(
            [[up * east, up * north, down], [north, -east, 0], [down * east, down * north, -up]]
        )

    @property
    def normal(self) -> np.ndarray:
        """The upward unit normal of the planes [d]."""
        return self.frame[0]


class JointSet(Joints, Inclined):
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

    @property
    def origin(self) -> np.ndarray:
        """A point of one of the joints [d], m."""
        return np.zeros(self._dimension) if self.through is None else np.array(self.through)
