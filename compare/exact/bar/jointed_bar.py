"""Intact rock with every joint resolved, by marching in the Laplace variable (`laplace`).

Intact rock (E, Kelvin-Voigt eta of the rock) between joints of their own stiffness K_n (Guo & Li
2002, equation 4) and time constants; E and density may differ between segments; quiet, matched,
free or fixed ends, the dashpots with the rock mass's impedance there. This is the physics that both
the rigid blocks and the homogenised bar approximate (Schoenberg, JASA 68, 1980; Pyrak-Nolte et al.,
JGR 95, 1990).

Valid for any load; every joint carries tension and the scene gives intact_modulus.
"""

import numpy as np
import xarray as xr

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.constant_q import mechanisms_of
from jointwave.cases.material.jointed_rock import JointedRock
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar import equivalent_bar
from jointwave.compare.exact.bar.laplace import solved
from jointwave.compare.exact.bar.transfer import Bar, End, end_of, rocks
from jointwave.compare.exact.conditions import holds
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin

HELD = (*equivalent_bar.HELD, "stiff layers")


def applies(scene: Scene) -> Answer:
    """Return whether the scene is a linear bar of known intact rock."""
    unknown = calibrate(scene).own_stiffness is None
    return holds(scene, HELD, (unknown, "rock.intact_modulus is not given"))


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement of the scene's jointed bar."""
    return solved(scene, SOLVER.name, bar(scene))


def bar(scene: Scene) -> Bar:
    """Return the scene's intact rock with its N - 1 joints."""
    p = calibrate(scene)
    assert p.own_stiffness is not None
    relaxation = mechanisms_of(scene, "jointed")
    etas = p.own_time_constant
    return Bar(
        length=scene.pillar.length,
        rocks=rocks(p, [one.intact_modulus or 0.0 for one in p.each], relaxation),
        joint_y=p.joint_y,
        joint_compliance=1 / p.own_stiffness,
        joint_time_constant=np.zeros_like(p.joint_y) if etas is None else etas,
        start=_end(scene.ends.start, p.at_start),
        end=_end(scene.ends.end, p.at_end),
    )


def _end(kind: str, p: JointedRock) -> End:
    """Return an end behind half a joint of this rock."""
    half_joint = 1 / (2 * p.regular_own_stiffness)
    return end_of(kind, p.impedance, half_joint, p.time_constant or 0.0)


SOLVER = Solver(
    name="jointed-bar",
    rock=Rock.JOINTED,
    label="jointed bar, exact",
    line=thin("#a83200", 8, (4.5, 8.5)),
    applies=applies,
    run=solve,
    distances={
        Kind.NUMERICAL: {"continuum-jointed": "elements and time stepping of the jointed rock"},
        Kind.MODELLING: {
            "dem": "rigid instead of deformable blocks",
            "continuum-equivalent": "joints smeared over the bar",
        },
    },
)
