"""The joint law: its parameters, its parts, and the complete law in one call.

Every formula here is plain Python that numba compiles into kernels. A kernel takes the parameters
as one table and `LawFlags`, a tuple of booleans, as a constant, so absent parts are not compiled.
To add a parameter, add a field of `Law` and its formula.

Per unit area: traction in Pa, compression positive; gap in m, positive when open, so that
penetration is negative. The shear traction acts on the right block.
"""

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from jointwave.cases.material.closure import stress_in_reach
from jointwave.cases.scene_type import AnyScene
from jointwave.joints.closure import closure_stiffness, closure_viscosity
from jointwave.joints.dilation import lift, riding_stiffness
from jointwave.joints.energy import elastic_energy, fracture_energy_spent, friction_work, lift_work
from jointwave.joints.formula import formula
from jointwave.joints.normal import spring_traction
from jointwave.joints.shear import UNLIMITED, cohesion_left, shear_return
from jointwave.joints.slide import trial_for


class Law(NamedTuple):
    """The parameters of all joints [n], or of one joint (floats, in kernels).

    normal_stiffness, normal_viscosity : K, Pa/m, and K eta, Pa s/m; None without dashpots.
    carries_tension : whether tension is carried; None where every joint does.
    shear_stiffness, shear_viscosity : K_s, Pa/m, and K_s eta, Pa s/m; None without shear.
    cohesion, friction : c, Pa, and tan(phi); None where no joint slides.
    residual_cohesion : cohesion after slip, Pa; None where slip does not reduce it.
    tensile_strength, critical_opening : s_t, Pa, and w_c, m; None without softening.
    maximum_closure : d_m, m, of joints with closure, initially of stiffness K; None without.
    rock_compliance, rock_time_constant : the rock's share of the compliance 1/K, m/Pa, and its eta,
        s; None without.
    dynamic_friction, weakening_distance : tan(phi) after weakening, its path D, m; None without.
    dilation, dilation_distance : tan(psi), and the path over which it falls to 0, m; None without.
    direct_effect, evolution_effect, critical_slip_distance, reference_rate, initial_state : a, b,
        D_c, m, V_0, m/s, and theta_0, s, of rate-and-state friction; None without. A joint without
        it among joints with it has a = 0.

    A joint without a strength that other joints have gets `joints.shear.UNLIMITED`.
    """

    normal_stiffness: Any
    normal_viscosity: Any = None
    carries_tension: Any = None
    shear_stiffness: Any = None
    shear_viscosity: Any = None
    cohesion: Any = None
    friction: Any = None
    residual_cohesion: Any = None
    tensile_strength: Any = None
    critical_opening: Any = None
    maximum_closure: Any = None
    rock_compliance: Any = None
    rock_time_constant: Any = None
    dynamic_friction: Any = None
    weakening_distance: Any = None
    dilation: Any = None
    dilation_distance: Any = None
    direct_effect: Any = None
    evolution_effect: Any = None
    critical_slip_distance: Any = None
    reference_rate: Any = None
    initial_state: Any = None


#: Rows of the table that a static state sets to zero; its friction is mu_0.
IN_MOTION = [
    Law._fields.index(name)
    for name in ("normal_viscosity", "shear_viscosity", "rock_time_constant", "direct_effect")
]


class LawFlags(NamedTuple):
    """The parts of the law: constants of a compiled kernel.

    path : the history has the accumulated slip, or the state of rate-and-state friction.
    varied : joints differ, and the table has a column for each; else one for all.
    planar : joints slip in one direction, x.
    limited : the shear traction is limited, by Coulomb's law or to zero where a joint is open.
    """

    dashpots: bool
    no_tension: bool
    softening: bool
    shear: bool
    slip: bool
    residual: bool
    limited: bool
    varied: bool
    closure: bool
    weakening: bool
    dilation: bool
    rate_state: bool
    path: bool
    planar: bool = False


#: The parameters of each part of a law; all laws have the normal stiffness.
OF_PART = {
    "dashpots": ("normal_viscosity", "shear_viscosity"),
    "no_tension": ("carries_tension",),
    "shear": ("shear_stiffness",),
    "slip": ("cohesion", "friction"),
    "residual": ("residual_cohesion",),
    "softening": ("tensile_strength", "critical_opening"),
    "closure": ("maximum_closure", "rock_compliance", "rock_time_constant"),
    "weakening": ("dynamic_friction", "weakening_distance"),
    "dilation": ("dilation", "dilation_distance"),
    "rate_state": (
        "direct_effect", "evolution_effect", "critical_slip_distance", "reference_rate",
        "initial_state",
    ),
}  # fmt: skip


def rows_of(parts: LawFlags) -> tuple[int, ...]:
    """Return the rows of the table that a law with these parts uses."""
    names = [name for part, own in OF_PART.items() if getattr(parts, part) for name in own]
    return tuple(sorted(map(Law._fields.index, ["normal_stiffness", *names])))


def sticking(table: np.ndarray) -> np.ndarray:
    """Return the table of a law [fields, ...] whose joints never open, slip, break or stiffen."""
    found, row = table.copy(), Law._fields.index
    found[IN_MOTION], found[row("friction")], found[row("carries_tension")] = 0.0, 0.0, 1.0
    for name in ("cohesion", "tensile_strength", "critical_opening", "maximum_closure"):
        found[row(name)] = UNLIMITED
    return found


class History(NamedTuple):
    """The history of one point of a joint; variables that its law does not use are 0.

    opening : the largest so far, m. slide_x, slide_z : slip less its elastic part, m. cohesion : of
    this point, Pa, where slip changes it. path : accumulated slip, m, where the law needs it; with
    rate-and-state friction ln(theta / theta_0).
    """

    opening: float = 0.0
    slide_x: float = 0.0
    slide_z: float = 0.0
    cohesion: float = 0.0
    path: float = 0.0


class Traction(NamedTuple):
    """Traction at one point of a joint at the end of a step, and its energies.

    n, x, z : traction, Pa. drag_n, drag_x, drag_z : the dashpots' share of it, Pa. history : after
    the step. stored : energy in the springs, J/m2. spent : fracture energy so far, J/m2. slid :
    energy dissipated by sliding in this step, J/m2.
    """

    n: float
    x: float
    z: float
    drag_n: float
    drag_x: float
    drag_z: float
    history: History
    stored: float
    spent: float
    slid: float


def parts_of(law: Law) -> LawFlags:
    """Return the parts of a law."""
    has = {
        part: any(getattr(law, name) is not None for name in names)
        for part, names in OF_PART.items()
    }
    has["closure"] = law.maximum_closure is not None  # rock_compliance alone does not count
    for part in ("weakening", "dilation", "rate_state"):
        has[part] = has[part] and has["shear"]
    return LawFlags(
        **has,
        limited=has["shear"] and (has["slip"] or has["no_tension"] or has["softening"]),
        varied=any(np.ndim(value) for value in law if value is not None),
        path=has["weakening"] or has["dilation"] or has["rate_state"],
    )


def uniform(values: Any) -> Any:
    """Return the common value of an array if there is one, else the array; None for None."""
    if values is None:
        return None
    same = values.size > 0 and (values == values[0]).all()
    return values[0].item() if same else np.ascontiguousarray(values)


def law(
    stiffness: np.ndarray,
    time_constant: np.ndarray | None,
    tension: np.ndarray,
    *,
    shear_stiffness: np.ndarray | None = None,
    **strengths: np.ndarray | None,
) -> Law:
    """Return the law of joints with these properties [n]; equal values become one number.

    stiffness, shear_stiffness : Pa/m. time_constant : eta, s, for both [n] or for each [2, n]; None
    without dashpots. tension : whether it is carried. strengths : the other fields of the law, None
    where no joint has them.
    """

    def viscosity(stiffness: np.ndarray | None, row: int) -> np.ndarray | None:
        if stiffness is None or time_constant is None:
            return None
        return stiffness * np.broadcast_to(time_constant, (2, len(stiffness)))[row]

    return Law(
        normal_stiffness=uniform(stiffness),
        normal_viscosity=uniform(viscosity(stiffness, 0)),
        carries_tension=None if tension.all() else uniform(tension),
        shear_stiffness=uniform(shear_stiffness),
        shear_viscosity=uniform(viscosity(shear_stiffness, 1)),
        **{name: uniform(values) for name, values in strengths.items()},
    )


def stiffest(law: Law, scene: "AnyScene") -> Law:
    """Return the law with the stiffness and viscosity for the critical step of a scene: the largest
    up to the largest closure in reach, and for dilatant joints while they slide."""
    normal, viscosity, shear = law.normal_stiffness, law.normal_viscosity, law.shear_stiffness
    if law.maximum_closure is not None:
        normal = closure_stiffness(law, most := stress_in_reach(scene))
        if viscosity is not None:
            viscosity = np.maximum(viscosity, closure_viscosity(law, most)[0])
    if law.dilation is not None:
        normal, shear = riding_stiffness(law.dilation, law.friction, normal, shear)
    return law._replace(normal_stiffness=normal, normal_viscosity=viscosity, shear_stiffness=shear)


def table_of(law: Law) -> np.ndarray:
    """Return the table of parameters for kernels: [field, 1], or [field, joint] where some vary.

    Absent parameters are 0; unused pages take no memory.
    """
    given = [(row, value) for row, value in enumerate(law) if value is not None]
    table = np.zeros((len(law), max(np.size(value) for _, value in given)))
    for row, value in given:
        table[row] = value
    return table


@formula
def law_of(table, j):
    """Return the law of column j of a table, every parameter a number."""
    return Law(
        table[0, j], table[1, j], table[2, j], table[3, j], table[4, j], table[5, j], table[6, j],
        table[7, j], table[8, j], table[9, j], table[10, j], table[11, j], table[12, j],
        table[13, j], table[14, j], table[15, j], table[16, j], table[17, j], table[18, j],
        table[19, j], table[20, j], table[21, j],
    )  # fmt: skip


@formula
def law_at(table, j, n):
    """Return the law of joint j from a flat table with rows of n joints."""
    return Law(
        table[j], table[n + j], table[2 * n + j], table[3 * n + j], table[4 * n + j],
        table[5 * n + j], table[6 * n + j], table[7 * n + j], table[8 * n + j], table[9 * n + j],
        table[10 * n + j], table[11 * n + j], table[12 * n + j], table[13 * n + j],
        table[14 * n + j], table[15 * n + j], table[16 * n + j], table[17 * n + j],
        table[18 * n + j], table[19 * n + j], table[20 * n + j],
        table[21 * n + j],
    )  # fmt: skip


@cache
def traction_for(shear: bool, path: bool) -> Callable:
    """Return the formula `traction`, compiled without shear or path if joints have none."""
    trial = trial_for(shear, path)

    @formula
    def traction(law, parts, jump, step, rate, dt, history):
        """Return the `Traction` of one point: the complete law.

        jump : gap and slip (n, x, z) at the end of the step, m. step : their increments over the
        step, m. rate : their rates for dashpots, m/s. dt : s. history : before the step.
        """
        found = trial(law, parts, jump, rate, dt, history)
        gap, opening, whole_x, whole_z, _, t_n, tau, way = found
        t_x, t_z, drag_x, drag_z, slid, slipped = 0.0, 0.0, 0.0, 0.0, 0.0, False
        x, z, cohesion = whole_x, whole_z, history.cohesion
        if path and parts.dilation:
            up = lift(law, way) - lift(law, history.path)
            slid = -lift_work(law, parts, gap - step[0], gap - up, opening, up)
            gap = gap - up
        if shear and parts.shear:
            old_x, old_z = x - step[1], z - step[2]
            t_x, t_z, x, z, slipped = shear_return(
                law, parts, x, z, old_x, old_z, rate[1], rate[2], tau, dt
            )
            drag_x, drag_z = t_x + law.shear_stiffness * x, t_z + law.shear_stiffness * z
            rubbed = friction_work(law, old_x, old_z, x, z, step[1], step[2])
            slid = slid + (rubbed if slipped else 0.0)
            cohesion = cohesion_left(law, parts, cohesion, slipped)
        spring = spring_traction(law, parts, gap, opening)
        stored = elastic_energy(law, parts, gap, opening, x, z)
        spent = fracture_energy_spent(law, opening) if parts.softening else 0.0
        after = History(
            opening, history.slide_x + (whole_x - x), history.slide_z + (whole_z - z), cohesion, way
        )
        return Traction(t_n, t_x, t_z, t_n - spring, drag_x, drag_z, after, stored, spent, slid)

    return traction


traction = traction_for(shear=True, path=True)
