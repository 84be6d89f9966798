"""`jointwave explain`: a scene before any run, as facts for --json and as paragraphs."""

from collections.abc import Callable
from itertools import pairwise
from math import isfinite
from typing import Any

from jointwave.cases.effects import effects
from jointwave.cases.errors import SceneError
from jointwave.cases.material.block_summary import block_summary
from jointwave.cases.material.calibrate import calibrate
from jointwave.cases.scene_type import AnyScene
from jointwave.cases.schema.scene import Scene
from jointwave.cases.size import spoken
from jointwave.compare.cli.terminal import say, show_table
from jointwave.compare.engines import ENGINES, solver
from jointwave.compare.misfit.ranking import applicable, reference_of
from jointwave.compare.readings.entering_wave import entering_waves
from jointwave.compare.runs import timings
from jointwave.compare.solvers.properties import least_lever, spans, speeds
from jointwave.compare.solvers.record import Prepared
from jointwave.compare.studies.step_cost import step_costs, with_every_effect

ROUND_OFF = 1e-6  # of a stiffness that is fitted

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
    levers = {name: least_lever(scene, ENGINES[name].rock) for name in runs}
    references = {name: reference_of(name, able, scene) for name in engines}
    return {
        "title": scene.title,
        "variant": scene.name,
        **(_pillar(scene) if isinstance(scene, Scene) else block_summary(scene)),
        **_cost(scene, measured),
        "speeds": {name: speeds(scene, ENGINES[name].rock) for name in runs},
        "levers": {name: lever for name, lever in levers.items() if lever is not None},
        "enters": [wave._asdict() for wave in entering_waves(scene)],
        "effects": {e.name: {"active": e.active, "why": e.reason} for e in effects(scene)},
        "steps": [
            {"engine": name, "critical": r.critical, "dt": r.dt, "steps": r.steps, "bytes": r.bytes}
            for name, r in runs.items()
        ],
        "cannot_run": failures,
        "solutions": {k: {"applies": a.yes, "why_not": a.reason} for k, a in answers.items()},
        "references": {name: r._asdict() if r else None for name, r in references.items()},
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
    """Return the rock of a pillar, and of each of its segments."""
    p = calibrate(scene)
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
        }
        for (start, stop), one in zip(spans(p), p.each, strict=True)
    ]
    whole = {"blocks": p.block_count, "bar_speed": p.bar_speed, "equivalent_modulus": p.modulus}
    return whole | {"poisson": p.poisson, "segments": segments}


def _cost(scene: AnyScene, measured: bool) -> Facts:
    """Return what a step of one rigid block of a pillar costs here, of this scene and with every
    effect, ns; None where it was never measured."""
    own: float | None = None
    everything: float | None = None
    if isinstance(scene, Scene) and measured:
        own, everything = (one.ns for one in step_costs([scene, with_every_effect(scene)]))
    elif isinstance(scene, Scene):
        own = timings.block_step(scene)
    return {"nanoseconds_per_block_step": own, "nanoseconds_with_everything": everything}


def show_explanation(found: Facts) -> None:
    """Print the facts of a scene in words."""
    say(f"{found['title']} {found['variant']}".rstrip(), "bold")
    rock = _show_segments if "segments" in found else _show_blocks
    paragraphs: list[Callable[[Facts], None]] = [rock, _show_waves, _show_steps, _show_solutions]
    for show in paragraphs:
        show(found)


def _show_segments(found: Facts) -> None:
    segments = found["segments"]
    for one in segments:
        where = f"{one['from']:g} to {one['to']:g} m: " if len(segments) > 1 else ""
        joints = "" if one["has_joints"] else ", without joints"
        say(
            f"{where}{one['blocks']} blocks of {one['block']:g} m; "
            f"E_eq {one['equivalent_modulus']:.4g} Pa, Poisson {one['poisson']:.4g}, "
            f"bar speed {one['bar_speed']:.5g} m/s, K'_n {one['joint_stiffness']:.4g} Pa/m{joints}"
        )
    passed = [
        f"{2 * b['impedance'] / (a['impedance'] + b['impedance']):.4g} at {b['from']:g} m"
        for a, b in pairwise(segments)
        if a["impedance"] != b["impedance"]
    ]
    if passed:
        say(f"long-wave stress transmission 2 Z2 / (Z1 + Z2): {', '.join(passed)}")


def _show_blocks(found: Facts) -> None:
    say(f"{found['blocks']:,} blocks, {found['area']:.6g} m2 in total")
    if found["rigid_blocks"] != found["blocks"]:
        say(f"{found['rigid_blocks']:,} rigid blocks: numerics.dem.block subdivides the rock")
    for word in ("smallest", "largest"):
        x, y = found[word]["centroid"]
        say(f"{word} block: {found[word]['area']:.4g} m2, at [{x:.4g}, {y:.4g}]")
    for name, one in found["regions"].items():
        waves = f"waves of {one['p_speed']:.4g} and {one['s_speed']:.4g} m/s"
        say(f"region {name}: {one['blocks']:,} blocks, {one['area']:.6g} m2, {waves}")
    cuts = found["cuts_through_rock"]
    sets = found["joint_sets"] | ({"(no joint)": cuts} if cuts["contacts"] else {})
    rows = [[name, f"{one['contacts']:,}", f"{one['length']:.6g}"] for name, one in sets.items()]
    show_table(["joint set", "contacts", "length, m"], rows)
    show_table(["side", "edges"], [[name, f"{n:,}"] for name, n in found["boundary"].items()])
    if (lack := found["rigid_blocks_lack"]) is not None:
        share, why = "0", "their joints represent all of it"
        if lack > ROUND_OFF:
            share = f"{float(f'{100 * lack:.2g}'):g}"
            why = "only their joints deform, and joints of few directions have no Poisson effect"
        say(f"rigid blocks cannot represent {share} % of the intact rock's stiffness: {why}")
    size, most = spoken(found["bytes"]), spoken(found["bytes_at_most"])
    say(f"memory of the blocks: {size}, at most {most} during subdivision")


def _show_waves(found: Facts) -> None:
    """Print the speeds of waves, where joints bear when they open, and the waves that enter."""
    fast, where = ("bar", "") if "segments" in found else ("P", " in the rock of no region")
    where = where if found.get("regions") else ""
    for engine, own in found["speeds"].items():
        each = (f"{k}: {fast} {_speed(p)}, S {_speed(s)}" for k, (p, s) in own.items())
        say(f"waves in {engine}{where}, m/s: {'; '.join(each)}")
    if found["levers"]:
        each = (f"{engine} {value:.3g}" for engine, value in found["levers"].items())
        say(f"a joint's face that opens bears at this part of its half width: {', '.join(each)}")
    for one in found["enters"]:
        length = "" if one["length"] is None else f", a pulse of {one['length']:.4g} m"
        wave = f"{one['stress']:.4g} Pa and {one['velocity']:.4g} m/s enter the rock{length}"
        say(f"{one['source']}: {wave}, {one['energy']:.4g} J/m2")


def _speed(speed: float) -> str:
    return f"{speed:.4g}" if isfinite(speed) else "none (rigid)"


def _show_steps(found: Facts) -> None:
    """Print the effects, and the steps of each engine with their cost."""
    rows = [[k, "yes" if e["active"] else "no", e["why"]] for k, e in found["effects"].items()]
    show_table(["effect", "computed", "because"], rows)
    steps = [
        [
            one["engine"],
            f"{one['critical']:.4g}",
            f"{one['dt']:.4g}",
            f"{one['dt'] / one['critical']:.3g}",
            f"{one['steps']:,}",
            spoken(one["bytes"]),
        ]
        for one in found["steps"]
    ]
    show_table(["engine", "critical step, s", "step, s", "fraction", "steps", "memory"], steps)
    for name, reason in found["cannot_run"].items():
        say(f"{name} cannot run: {reason}")
    if "segments" in found:
        _show_cost(found["nanoseconds_per_block_step"], found["nanoseconds_with_everything"])


def _show_cost(own: float | None, everything: float | None) -> None:
    if own is None:
        say("the time per step of a rigid block is known after a run, or by --measure")
        return
    share = (
        f", {100 * own / everything:.2g} % of the {everything:.2g} ns with every effect"
        if everything
        else ""
    )
    say(f"a step of a rigid block takes {own:.2g} ns here{share}")


def _show_solutions(found: Facts) -> None:
    """Print which solutions apply, and the reference of each engine."""
    answers = found["solutions"].items()
    rows = [[name, "yes" if a["applies"] else "no", a["why_not"]] for name, a in answers]
    show_table(["solution", "applies", "why not"], rows)
    for engine, reference in found["references"].items():
        if reference is None:
            say(f"{engine} is not checked independently: no other solution resolves more")
        else:
            say(f"reference of {engine}: {reference['name']} ({reference['reason']})")
