"""The facts of `jointwave explain`: a scene before any run."""

from itertools import pairwise
from math import isfinite, sqrt
from typing import Any

import numpy as np

from jointwave.cases.effects import effects
from jointwave.cases.errors import SceneError
from jointwave.cases.material.block_summary import block_summary
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import ENGINES, solver
from jointwave.compare.misfit.ranking import NOT_CHECKED, Reference, applicable, reference_of
from jointwave.compare.readings.entering_wave import entering_waves
from jointwave.compare.solvers.limiting import limiting
from jointwave.compare.solvers.record import Prepared
from jointwave.compare.solvers.wave_speeds import speeds

UNCHECKED = Reference("", f"{NOT_CHECKED}: no other solution resolves more")

Facts = dict[str, Any]


def explanation(scene: AnyScene) -> Facts:
    """Return the effects of a scene, its steps, and what can solve it, SI.

    Raises SceneError where no engine that applies can run.
    """
    about: Facts = {"title": scene.title, "variant": scene.name}
    active = {e.name: {"active": e.active, "why": e.reason} for e in effects(scene)}
    answers = applicable(scene)
    able = [name for name, answer in answers.items() if answer]
    engines = [name for name in ENGINES if name in able]
    runs, failures = _prepared(scene, engines)
    references = {name: reference_of(name, able, scene) or UNCHECKED for name in engines}
    if scene.is_column:
        about |= _pillar(scene)
    else:
        found = {name: speeds(scene, ENGINES[name].rock) for name in runs}
        about |= block_summary(scene) | {"speeds": found}
    limits = {
        name: limiting(name, ENGINES[name].model, scene)
        for name, run in runs.items()
        if run.scheme != "implicit"
    }
    return about | {
        "enters": [wave._asdict() for wave in entering_waves(scene)],
        "effects": active,
        "steps": [
            {"engine": name, "critical": r.critical, "dt": r.dt, "steps": r.steps, "bytes": r.bytes}
            for name, r in runs.items()
        ],
        "limits_the_step": [{"engine": name, **facts} for name, facts in limits.items() if facts],
        "cannot_run": failures,
        "solutions": {k: {"applies": bool(a), "why_not": a.reason} for k, a in answers.items()},
        "references": {name: r._asdict() for name, r in references.items()},
    }


def _prepared(scene: AnyScene, engines: list[str]) -> tuple[dict[str, Prepared], dict[str, str]]:
    """Return the runs of engines before their first step, and why others cannot run; raises
    SceneError of the first where none can."""
    runs: dict[str, Prepared] = {}
    errors: dict[str, SceneError] = {}
    for name in engines:
        try:
            runs[name] = solver(name).prepare(scene)
        except SceneError as error:
            errors[name] = error
    if errors and not runs:
        raise next(iter(errors.values()))
    return runs, {name: str(error) for name, error in errors.items()}


def _pillar(scene: Scene) -> Facts:
    """Return the rock of each segment of a pillar, with the long-wave stress 2 Z2 / (Z1 + Z2) that
    it takes from the one before."""
    p = calibrate(scene)
    before = [None, *p.each]
    ends = p.contact_y[np.cumsum([0, *(one.block_count for one in p.each)])].tolist()
    segments = [
        {
            "from": start,
            "to": stop,
            "blocks": one.block_count,
            "block": one.spacing,
            "equivalent_modulus": one.modulus,
            "poisson": one.poisson,
            "bar_speed": one.bar_speed,
            "shear_speed": one.shear_speed,
            "intact_bar_speed": one.intact_modulus and sqrt(one.intact_modulus / one.density),
            "impedance": one.impedance,
            "joint_stiffness": one.regular_stiffness,
            "has_joints": len(p.each) == 1 or isfinite(one.regular_own_stiffness),
            "transmission": other and 2 * one.impedance / (other.impedance + one.impedance),
        }
        for (start, stop), one, other in zip(pairwise(ends), p.each, before, strict=False)
    ]
    return {"segments": segments}
