"""The homogenised bar with dashpots, soft layers and any ends, in the Laplace variable (`laplace`).

A bar of the rock mass's modulus E_eq (1 + s eta); a soft layer is an interface with the additional
compliance 1/K = 1/K'_n(soft) - 1/K'_n(regular) and its own time constant, because the bar already
contains one ordinary joint there. Segments of other rock are bars of their own, bonded together.

Valid for any load; every joint carries tension and no layer is stiffer than the ordinary joints.
"""

import numpy as np
import xarray as xr

from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.constant_q import mechanisms_of
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar.laplace import solved
from jointwave.compare.exact.bar.transfer import Bar, end_of, rocks
from jointwave.compare.exact.conditions import DAMPED, holds
from jointwave.compare.solvers.record import Answer, Kind, Rock, Solver, thin

HELD = ("prestress", "soft layers", "segments", "scatter", "quality factor", *DAMPED)


def applies(scene: Scene) -> Answer:
    """Return whether the scene's homogenised bar is linear and its layers add compliance."""
    alone = bool(calibrate(scene).damps_alone.any())
    reason = "a homogenised bar cannot damp a single ordinary joint"
    many = scene.rock.quality_factor is not None and len(calibrate(scene).each) > 1
    return holds(
        scene,
        HELD,
        (alone, reason),
        (many, "homogenised segments have no common quality_factor"),
    )


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement of the scene's homogenised bar."""
    return solved(scene, SOLVER.name, bar(scene))


def bar(scene: Scene) -> Bar:
    """Return the scene's homogenised bar with its soft layers as interfaces."""
    p = calibrate(scene)
    relaxation = mechanisms_of(scene, "equivalent")
    etas = p.joint_time_constant
    return Bar(
        length=scene.pillar.length,
        rocks=rocks(p, [one.modulus for one in p.each], relaxation),
        joint_y=p.joint_y,
        joint_compliance=p.excess_compliance,
        joint_time_constant=np.zeros_like(p.joint_y) if etas is None else etas,
        start=end_of(scene.ends.start, p.at_start.impedance),
        end=end_of(scene.ends.end, p.at_end.impedance),
    )


SOLVER = Solver(
    name="equivalent-bar",
    rock=Rock.HOMOGENISED,
    label="homogenised bar, exact",
    line=thin("#005a3c", 6, (9, 13)),
    applies=applies,
    run=solve,
    distances={
        Kind.NUMERICAL: {
            "continuum-equivalent": "elements and time stepping of the homogenised bar"
        },
        Kind.MODELLING: {"dem": "the paper's comparison: discrete blocks and a homogenised bar"},
    },
)
