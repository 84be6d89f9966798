"""Intact rock with every joint resolved, by marching in the Laplace variable (`laplace`).

Segments of intact rock (E, Kelvin-Voigt eta of the rock) between joints of their own stiffness
K_n (Guo & Li 2002, equation 4) and time constants; quiet, matched, free or fixed ends, the
dashpots with the rock mass's impedance. This is the physics that both the rigid blocks and the
homogenised bar approximate (Schoenberg, JASA 68, 1980; Pyrak-Nolte et al., JGR 95, 1990).

Holds for any load; every joint carries tension and the scene gives intact_modulus.
"""

import numpy as np
import xarray as xr

from cases.material.calibrate import calibrate
from cases.schema.scene import Scene
from compare.exact.bar.laplace import Bar, end_of, solved
from compare.exact.conditions import DAMPED, holds
from compare.solvers.record import JOINTED, Answer, Kind, Rock, Solver, Words, thin

HELD = ("prestress", "soft layers", "stiff layers", *DAMPED)


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
    assert p.own_stiffness is not None and p.intact_modulus is not None
    etas, eta = p.joint_time_constant, p.time_constant or 0.0
    half_joint = 1 / (2 * p.regular_own_stiffness)
    return Bar(
        length=scene.pillar.length,
        density=p.density,
        modulus=p.intact_modulus,
        time_constant=eta,
        joint_y=p.joint_y,
        joint_compliance=1 / p.own_stiffness,
        joint_time_constant=np.zeros_like(p.joint_y) if etas is None else etas,
        start=end_of(scene.ends.start, p.impedance, half_joint, eta),
        end=end_of(scene.ends.end, p.impedance, half_joint, eta),
    )


SOLVER = Solver(
    name="jointed-bar",
    rock=Rock.JOINTED,
    words=Words(JOINTED, "jointed bar, exact", "节理杆（精确解）"),
    line=thin("#a83200", 8, (4.5, 8.5), (6, 2.4)),
    applies=applies,
    run=solve,
    distances={
        Kind.NUMERICAL: {"continuum-jointed": "elements and time stepping of the jointed rock"},
        Kind.MODELLING: {
            "dem": "rigid instead of deformable blocks",
            "continuum-equivalent": "joints smeared out over the bar",
        },
    },
)
