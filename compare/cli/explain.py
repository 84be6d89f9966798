"""`jointwave explain`: a scene before any run."""

from math import isfinite
from typing import Any

from jointwave.cases.effects import effects
from jointwave.cases.errors import SceneError
from jointwave.cases.material.block_summary import block_summary
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.scene import Scene
from jointwave.compare.cli.terminal import say, show_facts
from jointwave.compare.engines import ENGINES, solver
from jointwave.compare.misfit.ranking import NOT_CHECKED, Reference, applicable, reference_of
from jointwave.compare.readings.entering_wave import entering_waves
from jointwave.compare.runs import timings
from jointwave.compare.solvers.properties import spans, speeds
from jointwave.compare.solvers.record import Prepared
from jointwave.compare.studies.step_cost import step_costs, with_every_effect

#: What the facts are called on the terminal, with their units.
LABELS = {
    "area": "area, m2",
    "bar_speed": "bar speed, m/s",
    "block": "block, m",
    "bytes_at_most": "bytes at most, during subdivision",
    "critical": "critical step, s",
    "dt": "step, s",
    "effects": "effect",
    "energy": "energy, J/m2",
    "enters": "waves that enter",
    "equivalent_modulus": "E_eq, Pa",
    "from": "from, m",
    "impedance": "impedance, Pa s/m",
    "joint_stiffness": "K'_n, Pa/m",
    "length": "length, m",
    "p_speed": "P, m/s",
    "references": "reference of",
    "rigid_blocks_lack": "part of the intact rock's stiffness that rigid blocks cannot represent",
    "s_speed": "S, m/s",
    "solutions": "solution",
    "stress": "stress, Pa",
    "to": "to, m",
    "transmission": "transmission from the segment before",
    "velocity": "velocity, m/s",
}
UNCHECKED = Reference("", f"{NOT_CHECKED}: no other solution resolves more")

Facts = dict[str, Any]


def explanation(scene: AnyScene, measured: bool = False) -> Facts:
    """Return the effects of a scene, its steps, and what can solve it, SI.

    measured : time a step of a pillar's rigid blocks, which may compile kernels for a minute; else
    its cost is that of earlier runs here. Raises SceneError where no engine that applies can run.
    """
    answers = applicable(scene)
    able = [name for name, answer in answers.items() if answer]
    engines = [name for name in ENGINES if name in able]
    runs, failures = _prepared(scene, engines)
    references = {name: reference_of(name, able, scene) or UNCHECKED for name in engines}
    return {
        "title": scene.title,
        "variant": scene.name,
        **(_pillar(scene, measured) if isinstance(scene, Scene) else block_summary(scene)),
        "speeds": {name: speeds(scene, ENGINES[name].rock) for name in runs},
        "enters": [wave._asdict() for wave in entering_waves(scene)],
        "effects": {e.name: {"active": e.active, "why": e.reason} for e in effects(scene)},
        "steps": [
            {"engine": name, "critical": r.critical, "dt": r.dt, "steps": r.steps, "bytes": r.bytes}
            for name, r in runs.items()
        ],
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


def _pillar(scene: Scene, measured: bool) -> Facts:
    """Return the rock of each segment of a pillar, with the long-wave stress 2 Z2 / (Z1 + Z2) that
    it takes from the one before; and what a step of one rigid block costs here, of this scene and
    with every effect, ns, None where it was never measured."""
    p = calibrate(scene)
    before = [p.each[0], *p.each]
    segments = [
        {
            "from": start,
            "to": stop,
            "blocks": one.block_count,
            "block": one.spacing,
            "equivalent_modulus": one.modulus,
            "poisson": one.poisson,
            "bar_speed": one.bar_speed,
            "impedance": one.impedance,
            "joint_stiffness": one.regular_stiffness,
            "has_joints": len(p.each) == 1 or isfinite(one.regular_own_stiffness),
            "transmission": 2 * one.impedance / (other.impedance + one.impedance),
        }
        for (start, stop), one, other in zip(spans(p), p.each, before, strict=False)
    ]
    costs = [timings.block_step(scene), None]
    if measured:
        costs = [one.ns for one in step_costs([scene, with_every_effect(scene)])]
    names = "nanoseconds_per_block_step", "nanoseconds_with_everything"
    return {"segments": segments, **dict(zip(names, costs, strict=True))}


def show_explanation(found: Facts) -> None:
    """Print the facts of a scene."""
    say(f"{found['title']} {found['variant']}".rstrip(), "bold")
    labels = LABELS | {
        "speeds": f"speeds of {'bar and S' if 'segments' in found else 'P and S'} waves, m/s"
    }
    show_facts({k: v for k, v in found.items() if k not in ("title", "variant")}, labels)
