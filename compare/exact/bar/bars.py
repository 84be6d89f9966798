"""Bars of rock with interfaces, by recursion in the Laplace variable (`laplace`).

The homogenised bar has the rock mass's modulus E_eq (1 + s eta). The bar already contains an
ordinary joint at a soft layer, so the layer is an interface with the additional compliance 1/K =
1/K'_n(soft) - 1/K'_n(regular) and its own time constant. Segments of other rock are separate bars,
bonded together.

The jointed bar is intact rock (E, Kelvin-Voigt eta of the rock) between joints with their own
stiffness K_n (Guo & Li 2002, equation 4) and time constants; the dashpots of quiet and matched ends
have the rock mass's impedance. Rigid blocks and the homogenised bar both approximate this bar
(Schoenberg, JASA 68, 1980; Pyrak-Nolte et al., JGR 95, 1990).

Valid for any load; every joint carries tension. In the homogenised bar no layer is stiffer than the
ordinary joints; the jointed bar needs intact_modulus.
"""

from collections.abc import Mapping
from functools import partial

import numpy as np
import xarray as xr

from jointwave.cases.loads import late_load
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.constant_q import mechanisms_of
from jointwave.cases.sampling import sample_times
from jointwave.cases.schema.scene import Scene
from jointwave.compare.exact.bar.laplace import bounded
from jointwave.compare.exact.bar.transfer import Bar, end_of, rocks
from jointwave.compare.exact.conditions import DAMPED, holds
from jointwave.compare.solvers.record import Answer, Kind, Line, Rock, Solver, thin
from jointwave.results.dataset import dataset

HELD = ("prestress", "soft layers", "segments", "scatter", "quality factor", *DAMPED)


def applies(scene: Scene, resolved: bool) -> Answer:
    """Return whether the scene's bar is linear and, if joints are resolved, its intact rock known,
    else its layers softer than ordinary joints."""
    p = calibrate(scene)
    if resolved:
        unknown = p.own_stiffness is None, "rock.intact_modulus is not given"
        return holds(scene, (*HELD, "stiff layers"), unknown)
    many = scene.rock.quality_factor is not None and len(p.each) > 1
    return holds(
        scene,
        HELD,
        (bool(p.damps_alone.any()), "a homogenised bar cannot damp a single ordinary joint"),
        (many, "homogenised segments have no common quality_factor"),
    )


def bar_of(scene: Scene, resolved: bool) -> Bar:
    """Return the intact rock of a scene with its N - 1 joints, and half a joint before a matched
    end; if joints are not resolved, the homogenised bar with soft layers as interfaces."""
    p = calibrate(scene)
    model, moduli = "equivalent", [one.modulus for one in p.each]
    compliance, etas = p.excess_compliance, p.excess_time_constant
    if resolved:
        assert p.own_stiffness is not None
        model, moduli = "jointed", [one.intact_modulus or 0.0 for one in p.each]
        compliance, own = 1 / p.own_stiffness, p.own_time_constant
        etas = np.zeros_like(p.joint_y) if own is None else own
    start, end = (
        end_of(kind, rock.impedance, 0.5 / rock.regular_own_stiffness, rock.time_constant or 0.0)
        if resolved  # half a joint lies in front of a matched end
        else end_of(kind, rock.impedance)
        for kind, rock in ((scene.ends.start, p.at_start), (scene.ends.end, p.at_end))
    )
    return Bar(
        length=scene.pillar.length,
        rocks=rocks(p, moduli, mechanisms_of(scene, model)),
        joint_y=p.joint_y,
        joint_compliance=compliance,
        joint_time_constant=etas,
        start=start,
        end=end,
    )


def _solver(
    name: str, rock: Rock, label: str, line: Line, distances: Mapping[Kind, Mapping[str, str]]
) -> Solver:
    resolved = rock is Rock.JOINTED

    def solve(scene: Scene) -> xr.Dataset:
        """Return stress, velocity and displacement of the scene's bar."""
        times, bar = sample_times(scene), bar_of(scene, resolved)
        places = scene.record.stress, scene.record.velocity
        load = late_load(scene, "jointed" if resolved else "equivalent")
        found = bounded(bar, load, times, *places, scene.load.time_scale)
        names = "stress", "velocity", "displacement"
        waves, errors = (dict(zip(names, of, strict=True)) for of in found)
        waves["stress"] = waves["stress"] + calibrate(scene).prestress
        return dataset(scene, name, times, waves, errors=errors)

    applies_to = partial(applies, resolved=resolved)
    return Solver(name, rock, label, line, applies_to, solve, distances=distances)


JOINTED = _solver(
    "jointed-bar",
    Rock.JOINTED,
    "jointed bar, exact",
    thin("#a83200", 8, (4.5, 8.5)),
    {
        Kind.NUMERICAL: {"continuum-jointed": "elements and time stepping of the jointed rock"},
        Kind.MODELLING: {
            "dem": "rigid instead of deformable blocks",
            "continuum-equivalent": "joints smeared over the bar",
        },
    },
)
EQUIVALENT = _solver(
    "equivalent-bar",
    Rock.HOMOGENISED,
    "homogenised bar, exact",
    thin("#005a3c", 6, (9, 13)),
    {
        Kind.NUMERICAL: {
            "continuum-equivalent": "elements and time stepping of the homogenised bar"
        },
        Kind.MODELLING: {"dem": "the paper's comparison: discrete blocks and a homogenised bar"},
    },
)
