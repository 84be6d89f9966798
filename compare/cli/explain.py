"""`jointwave explain`: the contents of a scene before any run; on request also absent effects and
solutions that do not apply, with reasons."""

from itertools import pairwise
from math import isfinite, sqrt
from typing import Any

import numpy as np

from jointwave.cases.effects import effects
from jointwave.cases.errors import SceneError
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.material.rock_mass import block_summary
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.scene import Scene
from jointwave.cases.size import spoken
from jointwave.compare.cli.commands import Explain
from jointwave.compare.cli.inputs import load
from jointwave.compare.cli.terminal import print_json, progress, say, show_facts
from jointwave.compare.engines import ENGINES, in_words, label_of, solver
from jointwave.compare.misfit.ranking import NOT_CHECKED, Reference, applicable, reference_of
from jointwave.compare.readings.entering_wave import entering_waves
from jointwave.compare.runs.jobs import options_of
from jointwave.compare.solvers.limiting import limiting
from jointwave.compare.solvers.wave_speeds import speeds
from jointwave.compare.text import in_seconds, percent

UNCHECKED = Reference("", f"{NOT_CHECKED}: no other solution resolves more")
#: Units of facts, and labels of facts whose names are not enough.
UNITS = {
    "m": "from to block length centroid width",
    "m²": "area",
    "m³": "volume",
    "m/s": "bar_speed shear_speed intact_bar_speed velocity p_speed s_speed",
    "Pa": "equivalent_modulus stress",
    "Pa/m": "joint_stiffness",
    "Pa s/m": "impedance",
    "J/m²": "energy",
}
LABELS = {key: f"{key} ({unit})" for unit, keys in UNITS.items() for key in keys.split()} | {
    "bytes": "memory of the blocks",
    "bytes_at_most": "memory while they are cut, at most",
    "boundary": "contacts with the boundary",
    "largest": "largest block",
    "poisson": "Poisson's ratio",
    "rigid_blocks_lack": "part of the intact rock's stiffness that rigid blocks cannot represent",
    "smallest": "smallest block",
    "source": "what enters",
    "speeds": "speeds of P and S waves (m/s)",
    "transmission": "transmission from the segment before",
}
APART = ["title", "variant", "effects", "steps", "limits_the_step", "cannot_run"]
APART += ["solutions", "references"]

Facts = dict[str, Any]


def explain(asked: Explain) -> None:
    """Print the facts of a scene."""
    for scene in load(asked, every=False):
        with progress(f"explain {scene.title}"):
            found = explanation(scene)
        print_json(found) if asked.as_json else show_explanation(found, asked.every)


def explanation(scene: AnyScene) -> Facts:
    """Return the effects of a scene, its time steps and the solvers that apply, SI.

    Raises SceneError if engines apply but none can run.
    """
    answers = applicable(scene)
    able = [name for name, answer in answers.items() if answer]
    engines = [name for name in ENGINES if name in able]
    runs, errors = {}, {}
    for name in engines:
        try:
            runs[name] = solver(name).prepare(scene)
        except SceneError as error:
            errors[name] = error
    if errors and not runs:
        raise next(iter(errors.values()))
    if scene.is_column:
        about: Facts = {"segments": _segments(scene)}
    else:
        found = {name: speeds(scene, ENGINES[name].rock) for name in runs}
        about = block_summary(scene) | {"speeds": found}
    explicit = [name for name, run in runs.items() if run.scheme != "implicit"]
    limits = {name: limiting(name, ENGINES[name].model, scene) for name in explicit}
    references = {name: reference_of(name, able, scene) or UNCHECKED for name in engines}
    return {
        "title": scene.title,
        "variant": scene.name,
        **about,
        "enters": [wave._asdict() for wave in entering_waves(scene)],
        "effects": {e.name: {"active": e.active, "why": e.reason} for e in effects(scene)},
        "steps": [
            {"engine": name, "critical": r.critical, "dt": r.dt, "steps": r.steps, "bytes": r.bytes}
            for name, r in runs.items()
        ],
        "limits_the_step": [{"engine": name, **facts} for name, facts in limits.items() if facts],
        "cannot_run": {name: str(error) for name, error in errors.items()},
        "solutions": {k: {"applies": bool(a), "why_not": a.reason} for k, a in answers.items()},
        "references": {name: r._asdict() for name, r in references.items()},
    }


def _segments(scene: Scene) -> list[Facts]:
    """Return the rock of each segment of a pillar, and the stress transmission coefficient
    2 Z2 / (Z1 + Z2) of long waves from the previous segment."""
    p = calibrate(scene)
    each = [one.at_rest for one in p.each]
    ends = p.contact_y[np.cumsum([0, *(one.block_count for one in p.each)])].tolist()
    return [
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
            "has_joints": not one.intact_modulus or isfinite(one.regular_own_stiffness),
            "transmission": other and 2 * one.impedance / (other.impedance + one.impedance),
        }
        for (start, stop), one, other in zip(pairwise(ends), each, [None, *each], strict=False)
    ]


def show_explanation(found: Facts, every: bool) -> None:
    """Print the facts of a scene; every : also absent effects, and solutions that do not apply."""
    say(f"{found['title']} {found['variant']}".rstrip(), "bold")
    facts = {key: value for key, value in found.items() if key not in APART}
    facts |= {key: spoken(facts[key]) for key in ("bytes_at_most", "bytes") if key in facts}
    if "speeds" in facts:
        facts["speeds"] = {label_of(name): one for name, one in facts["speeds"].items()}
    show_facts(facts, LABELS)
    effects = [{"effect": name, **one} for name, one in found["effects"].items()]
    _show("effects are not active", effects, "active", every)
    say("")
    table = []
    for run in found["steps"]:
        critical = in_seconds(run["critical"]) if run["critical"] else None
        row: Facts = {"engine": label_of(run["engine"]), "step": in_seconds(run["dt"])}
        row |= {"critical_step": critical, "steps": run["steps"], "memory": spoken(run["bytes"])}
        table.append(row)
    show_facts({"steps": table})
    for limit in found["limits_the_step"]:
        say(_limit(**limit))
    for name, why in found["cannot_run"].items():
        say(f"{label_of(name)} cannot run: {why}", "red")
    rows = [
        {"solution": label_of(name), "applies": one["applies"]}
        | {"options": " ".join(options_of(name)), "why_not": in_words(one["why_not"])}
        for name, one in found["solutions"].items()
    ]
    _show("solutions do not apply", rows, "applies", every)
    for name in ENGINES if not every else ():
        if (one := found["solutions"].get(name)) and not one["applies"]:
            say(f"not by {label_of(name)}: {in_words(one['why_not'])}", "dim")
    for name, reference in found["references"].items():
        by, why = label_of(reference["name"]), reference["reason"]
        say(f"reference of {label_of(name)}: {f'{by} ({why})' if by else why}")


def _show(rest: str, rows: list[dict[str, Any]], key: str, every: bool) -> None:
    """Print the rows in which `key` is true, and the number of the others; every : print all."""
    say("")
    empty = {name for name in rows[0] if all(not row[name] for row in rows if row[key])}
    few = [{k: v for k, v in row.items() if k not in {key, *empty}} for row in rows if row[key]]
    show_facts({rest: rows if every else few})
    if (left := len(rows) - len(few)) and not every:
        say(f"{left} other {rest}; which, and why: --all", "dim")


def _limit(engine: str, at: list[float], size: float, longer_step: float, mass_added: float) -> str:
    """Return, as a sentence, what limits a step, and the added mass that would lengthen it."""
    part = "block" if solver(engine).has_rigid_blocks else "element"
    place = ", ".join(f"{round(x, 9) + 0.0:.4g}" for x in at)
    return (
        f"the step of {label_of(engine)} is limited by the {part} at {place} m, {size:.3g} m in "
        f"size: {percent(mass_added)} % more mass, on at most 5 % of the {part}s, would make it "
        f"{longer_step:.3g} times as long"
    )
