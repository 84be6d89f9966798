"""The strength and the closure of every joint, from its own keys or those of [joints]."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from cases.schema.joint import PARTS, JointLaw
from cases.schema.scene import Scene

#: Strength (Pa) and opening (m) of a joint that never fails beside joints that do, and closure (m)
#: of one that does not stiffen; its square is still a number.
UNLIMITED = 1e100

#: The keys of slip: without them no joint has that effect.
SLIP = ("friction_angle", "cohesion", "residual_cohesion")
KEYS = (*SLIP, *(key for part in PARTS for key in part.all_keys))
#: The parameters that do not act along a joint alone: axial motion leaves the others out.
ACROSS = ("tensile_strength", "critical_opening", "maximum_closure")
#: The parameters that are keys as they stand: what a joint without has beside joints with them.
PLAIN = {
    "maximum_closure": UNLIMITED,
    "weakening_distance": 1.0,
    "dilation_distance": 1.0,
    "direct_effect": 0.0,
    "evolution_effect": 0.0,
    "critical_slip_distance": 1.0,
    "reference_rate": 1.0,
}


@dataclass(frozen=True)
class Strength:
    """The parameters of the joints' strength and closure, the one list of them: float arrays
    [N - 1], each None where no joint has it. They bear the names that the joint law gives them.

    friction : tan of the friction angle. cohesion, residual_cohesion, tensile_strength : Pa.
    critical_opening : w_c = 2 G_c / sigma_t, at which softening has used up the strength, m.
    maximum_closure : d_m, m.
    dynamic_friction, weakening_distance : tan of the angle that is left, and the path of slip, m.
    dilation, dilation_distance : tan of the angle at first, and the path that leaves none, m.
    direct_effect, evolution_effect, critical_slip_distance, reference_rate, initial_state : a, b,
    D_c, m, V_0, m/s, and theta_0, s, of friction that depends on rate and state.
    """

    friction: np.ndarray | None = None
    cohesion: np.ndarray | None = None
    residual_cohesion: np.ndarray | None = None
    tensile_strength: np.ndarray | None = None
    critical_opening: np.ndarray | None = None
    maximum_closure: np.ndarray | None = None
    dynamic_friction: np.ndarray | None = None
    weakening_distance: np.ndarray | None = None
    dilation: np.ndarray | None = None
    dilation_distance: np.ndarray | None = None
    direct_effect: np.ndarray | None = None
    evolution_effect: np.ndarray | None = None
    critical_slip_distance: np.ndarray | None = None
    reference_rate: np.ndarray | None = None
    initial_state: np.ndarray | None = None

    def strengths(
        self, shears: bool = True, joint: np.ndarray | slice = np.s_[:]
    ) -> dict[str, np.ndarray | None]:
        """Return the parameters by name at some joints; shears : those along the joints, too."""
        names = [one.name for one in fields(Strength) if shears or one.name in ACROSS]
        values = {name: getattr(self, name) for name in names}
        return {name: None if x is None else x[joint] for name, x in values.items()}


def strength(scene: Scene, soft: np.ndarray) -> Strength:
    """Return the strength of all joints, of which `soft` are those of the soft layers."""
    which = np.zeros(scene.pillar.block_count - 1, dtype=np.int64)
    which[soft] = 1 + np.arange(len(soft))
    return strength_of((scene.joints, *scene.layers), which)


def strength_of(laws: Sequence[JointLaw], which: np.ndarray) -> Strength:
    """Return the strength of joints, of which each has the law `which` (int array [n]) of `laws`.

    Beside joints that slip, one without friction and cohesion of its own has a cohesion without
    limit; beside joints that break, one without tensile strength likewise, and beside joints that
    stiffen one that closes linearly; beside joints that slip weakens, one whose friction stays.
    """
    if all(getattr(law, key) is None for law in laws for key in KEYS):
        return Strength()
    given = {key: np.array([_number(getattr(law, key)) for law in laws])[which] for key in KEYS}
    angle, cohesion, residual = (given[key] for key in SLIP)
    limit, dynamic, dilation = (
        given[key] for key in ("tensile_strength", "dynamic_friction_angle", "dilation_angle")
    )
    steady = given["critical_slip_distance"] / given["reference_rate"]
    begun = np.where(np.isnan(given["initial_state"]), steady, given["initial_state"])
    slips = ~(np.isnan(angle) & np.isnan(cohesion))
    never = ~slips & slips.any()
    whole = np.where(never, UNLIMITED, np.nan_to_num(cohesion))
    friction, weakens = _tangent(angle), np.where(np.isnan(dynamic), angle, dynamic)
    return Strength(
        friction=_where_given(angle, friction),
        cohesion=whole if never.any() or not np.isnan(cohesion).all() else None,
        residual_cohesion=_where_given(residual, np.where(np.isnan(residual), whole, residual)),
        tensile_strength=_where_given(limit, np.nan_to_num(limit, nan=UNLIMITED)),
        critical_opening=_where_given(
            limit, np.nan_to_num(2 * given["fracture_energy"] / limit, nan=UNLIMITED)
        ),
        dynamic_friction=_where_given(dynamic, _tangent(weakens)),
        dilation=_where_given(dilation, _tangent(dilation)),
        initial_state=_where_given(begun, np.nan_to_num(begun, nan=1.0)),
        **{
            key: _where_given(given[key], np.nan_to_num(given[key], nan=without))
            for key, without in PLAIN.items()
        },
    )


def _number(value: float | None) -> float:
    return np.nan if value is None else value


def _tangent(angle: np.ndarray) -> np.ndarray:
    return np.tan(np.radians(np.nan_to_num(angle)))


def _where_given(given: np.ndarray, filled: np.ndarray) -> np.ndarray | None:
    return None if np.isnan(given).all() else filled
