"""The homogenised bar with dashpots, soft layers and any ends, in the Laplace variable (`laplace`).

A bar of the rock mass's modulus E_eq (1 + s eta); a soft layer is an interface of the compliance
that it adds, 1/K = 1/K'_n(soft) - 1/K'_n(regular), with its own time constant, because the bar
already holds one ordinary joint there.

Holds for any load; every joint carries tension and no layer is stiffer than the ordinary joints.
"""

import numpy as np
import xarray as xr

from cases.material.calibrate import calibrate
from cases.schema.scene import Scene
from compare.exact.answer import YES, Answer, Resolves, Rock, no
from compare.exact.bar.laplace import Bar, end_of, solved
from compare.exact.conditions import bars_tension, beyond, has_thick_layer

NAME = "equivalent-bar"
RESOLVES = Resolves(Rock.HOMOGENISED)


def applies(scene: Scene) -> Answer:
    """Return whether the scene's homogenised bar is linear and its layers add compliance."""
    p = calibrate(scene)
    if reason := beyond(scene, "prestress"):
        return no(reason)
    if has_thick_layer(scene):
        return no("a soft layer has a thickness")
    if bars_tension(p):
        return no("a joint bars tension")
    if (p.excess_compliance < 0).any():
        return no("a soft layer is stiffer than the ordinary joints")
    if p.damps_alone.any():
        return no("a homogenised bar cannot damp one ordinary joint by itself")
    if scene.ends.start == "fixed":
        return no("the loaded end is fixed")
    return YES


def solve(scene: Scene) -> xr.Dataset:
    """Return stress, velocity and displacement of the scene's homogenised bar."""
    return solved(scene, NAME, bar(scene))


def bar(scene: Scene) -> Bar:
    """Return the scene's homogenised bar with its soft layers as interfaces."""
    p = calibrate(scene)
    etas = p.joint_time_constant
    return Bar(
        length=scene.pillar.length,
        density=p.density,
        modulus=p.modulus,
        time_constant=p.time_constant or 0.0,
        joint_y=p.joint_y,
        joint_compliance=p.excess_compliance,
        joint_time_constant=np.zeros_like(p.joint_y) if etas is None else etas,
        start=end_of(scene.ends.start, p.impedance),
        end=end_of(scene.ends.end, p.impedance),
    )
