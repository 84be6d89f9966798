"""`jointwave explain`: a scene before any run, its effects, critical steps and exact solutions."""

from __future__ import annotations

from itertools import pairwise
from math import isfinite
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from cases.effects import Effect, effects
from cases.errors import SceneError
from cases.kinds import AnyScene
from cases.material.calibrate import Properties, calibrate
from cases.schema.scene import Scene
from cases.size import spoken
from compare.cli.engine_facts import (
    Speeds,
    lever_words,
    levers_of,
    speed_facts,
    speed_words,
    speeds_of,
)
from compare.cli.terminal import print_json, say, show_table
from compare.engines import ENGINES, solver
from compare.experiments.cost import timings
from compare.experiments.cost.step_cost import nanoseconds, remembered_whole, whole
from compare.misfit.ranking import Reference, applicable, reference_of
from compare.readings.entering_wave import EnteringWave, entering_waves
from compare.solvers.record import Answer, Prepared

if TYPE_CHECKING:
    from cases.partition.blocks import Partition
    from cases.schema.rock_mass import RockMass

ROUND_OFF = 1e-6  # of a stiffness that is fitted


class Explanation(NamedTuple):
    """Everything known about a scene before a run.

    properties : of a pillar. blocks : of a rock mass, see `partition_facts`. runs : of each engine
    that applies, with its step; failures : why one that applies could not run. references : what
    each engine is held against; None where nothing checks it independently. speeds : of its waves
    in each engine, m/s. levers : of contact points, `engine_facts.levers_of`. block_step,
    with_everything : what a step of one rigid block of a pillar costs here, of this scene and with
    every effect, ns; None where it was never measured. entering : the plane waves that its loads
    and waves send into the rock.
    """

    scene: AnyScene
    properties: Properties | None
    blocks: dict[str, Any] | None
    effects: list[Effect]
    runs: dict[str, Prepared]
    failures: dict[str, str]
    answers: dict[str, Answer]
    references: dict[str, Reference | None]
    speeds: dict[str, Speeds]
    levers: dict[str, float]
    block_step: float | None
    with_everything: float | None
    entering: list[EnteringWave]


def explanation(scene: AnyScene, measured: bool = False) -> Explanation:
    """Return what a scene calls for, what is left out, and what can solve it.

    measured : step some blocks to say what they cost, which may compile kernels for a minute; else
    the cost is what such a scene's steps took here before.
    """
    answers = applicable(scene)
    able = [name for name, answer in answers.items() if answer]
    engines = [name for name in ENGINES if name in able]
    references = {name: reference_of(name, able, scene) for name in engines}
    if isinstance(scene, Scene):
        properties, blocks, cost = calibrate(scene), None, _cost(scene, measured)
    else:
        properties, blocks, cost = None, partition_facts(scene), (None, None)
    runs, failures = _prepared(scene, engines)
    of_engines = speeds_of(scene, list(runs)), levers_of(scene, list(runs))
    about = effects(scene), runs, failures, answers, references, *of_engines
    return Explanation(scene, properties, blocks, *about, *cost, entering_waves(scene))


def _prepared(scene: AnyScene, engines: list[str]) -> tuple[dict[str, Prepared], dict[str, str]]:
    """Return the runs of engines before their first step, and why others cannot run; raises
    SceneError of the first where none can."""
    runs, failures, errors = {}, {}, []
    for name in engines:
        try:
            runs[name] = solver(name).prepare(scene)
        except SceneError as error:
            failures[name] = str(error)
            errors.append(error)
    if errors and not runs:
        raise errors[0]
    return runs, failures


def _cost(scene: Scene, measured: bool) -> tuple[float | None, float | None]:
    count = scene.block_count
    if not measured:
        return timings.block_step(scene), remembered_whole(count)
    own = nanoseconds(scene)
    timings.note_block_step(scene, own)
    return own, whole(count)


def show_explanation(found: Explanation, as_json: bool) -> None:
    """Print what a scene calls for, its steps, and what can solve it."""
    if as_json:
        print_json(_explanation_facts(found))
        return
    say(f"{found.scene.title} {found.scene.name}".rstrip(), "bold")
    if found.properties is not None:
        _show_properties(found.properties)
    if found.blocks is not None:
        show_partition(found.blocks)
    for line in speed_words(found.scene, found.speeds):
        say(line)
    if found.levers:
        say(lever_words(found.levers))
    for one in found.entering:
        say(_entering_words(one))
    effects = [[e.name, "yes" if e.active else "no", e.reason] for e in found.effects]
    show_table(["effect", "computed", "because"], effects)
    steps = [
        [
            name,
            f"{r.critical:.4g}",
            f"{r.dt:.4g}",
            f"{r.dt / r.critical:.3g}",
            f"{r.steps:,}",
            spoken(r.bytes),
        ]
        for name, r in found.runs.items()
    ]
    show_table(["engine", "critical step, s", "step, s", "fraction", "steps", "memory"], steps)
    for name, reason in found.failures.items():
        say(f"{name} cannot run: {reason}")
    if found.properties is not None:
        say(_cost_sentence(found.block_step, found.with_everything))
    answers = [[k, "yes" if a else "no", a.reason] for k, a in found.answers.items()]
    show_table(["solution", "applies", "why not"], answers)
    for engine, reference in found.references.items():
        if reference is None:
            say(f"{engine} is not checked independently: no other solution resolves more")
        else:
            say(f"reference of {engine}: {reference.name} ({reference.reason})")


def _show_properties(p: Properties) -> None:
    if len(p.each) == 1:
        say(_rock_words(p))
        return
    ends = p.contact_y[np.cumsum([0, *(one.block_count for one in p.each)])].tolist()
    for (start, stop), one in zip(pairwise(ends), p.each, strict=True):
        joints = "" if isfinite(one.regular_own_stiffness) else ", without joints"
        say(f"{start:g} to {stop:g} m: {_rock_words(one)}{joints}")
    passed = [
        f"{2 * b.impedance / (a.impedance + b.impedance):.4g} at {y:g} m"
        for (a, b), y in zip(pairwise(p.each), ends[1:-1], strict=True)
        if a.impedance != b.impedance
    ]
    if passed:
        say(f"long-wave stress transmission 2 Z2 / (Z1 + Z2): {', '.join(passed)}")


def _rock_words(p: Properties) -> str:
    return (
        f"{p.block_count} blocks of {p.spacing:g} m; E_eq {p.modulus:.4g} Pa, Poisson "
        f"{p.poisson:.4g}, bar speed {p.bar_speed:.5g} m/s, K'_n {p.regular_stiffness:.4g} Pa/m"
    )


def _entering_words(one: EnteringWave) -> str:
    length = "" if one.length is None else f", a pulse of {one.length:.4g} m"
    return (
        f"{one.source}: {one.stress:.4g} Pa and {one.velocity:.4g} m/s enter the rock{length}, "
        f"{one.energy:.4g} J/m2"
    )


def _cost_sentence(own: float | None, everything: float | None) -> str:
    if own is None:
        return "the time per step of a rigid block is known after a run, or by --measure"
    said = f"a step of a rigid block takes {own:.2g} ns here"
    if everything is None:
        return said
    return f"{said}, {100 * own / everything:.2g} % of the {everything:.2g} ns with every effect"


def _explanation_facts(found: Explanation) -> dict[str, Any]:
    p = found.properties
    pillar = (
        {}
        if p is None
        else {
            "blocks": p.block_count,
            "bar_speed": p.bar_speed,
            "equivalent_modulus": p.modulus,
            "poisson": p.poisson,
        }
    )
    return {
        "title": found.scene.title,
        "variant": found.scene.name,
        **pillar,
        **(found.blocks or {}),
        "enters": [one._asdict() for one in found.entering],
        "effects": {e.name: {"active": e.active, "why": e.reason} for e in found.effects},
        "steps": [
            {"engine": name, "critical": r.critical, "dt": r.dt, "steps": r.steps}
            | {"bytes": r.bytes}
            for name, r in found.runs.items()
        ],
        "cannot_run": found.failures,
        "speeds": speed_facts(found.speeds),
        "levers": found.levers,
        "nanoseconds_per_block_step": found.block_step,
        "nanoseconds_with_everything": found.with_everything,
        "references": {k: r._asdict() if r else None for k, r in found.references.items()},
        "solutions": {k: {"applies": a.yes, "why_not": a.reason} for k, a in found.answers.items()},
    }


def partition_facts(scene: RockMass) -> dict[str, Any]:
    """Cut a rock mass into blocks and return what they are, SI."""
    from cases.partition.lattice import further_sets
    from cases.partition.scene import partition_bytes, partition_of

    found, further = partition_of(scene), further_sets(scene)
    per_set = {name: _of_set(found, k) for k, name in enumerate(found.joint_sets)}
    sides = np.bincount(found.boundary.side, minlength=len(found.sides))
    return {
        "blocks": found.count,
        "rigid_blocks": partition_of(scene, further).count if further else found.count,
        "area": float(found.area.sum()),
        "smallest": _block(found, int(np.argmin(found.area))),
        "largest": _block(found, int(np.argmax(found.area))),
        "regions": _regions(scene, found),
        "joint_sets": per_set,
        "cuts_through_rock": _of_set(found, -1),
        "boundary": {name: int(n) for name, n in zip(found.sides, sides, strict=True) if n},
        "bytes": found.nbytes,
        "bytes_at_most": partition_bytes(scene),
        "rigid_blocks_lack": _lack(scene),
    }


def _regions(scene: RockMass, found: Partition) -> dict[str, Any]:
    """Return what each region is, with what is left as "rock"; empty where there is none."""
    from cases.material.rock import elastic_rock
    from cases.partition.regions import rocks_of
    from cases.schema.region import REST

    facts = {}
    names = [*(one.name for one in scene.regions), REST]
    for k, (name, rock) in enumerate(zip(names, rocks_of(scene), strict=True)):
        own, elastic = found.region % len(names) == k, elastic_rock(rock)
        facts[name] = {
            "blocks": int(own.sum()),
            "area": float(found.area[own].sum()),
            "p_speed": float(elastic.p_speed),
            "s_speed": float(elastic.s_speed),
        }
    return facts if scene.regions else {}


def _lack(scene: RockMass) -> float | None:
    """Return the part of the intact rock's stiffness that rigid blocks cannot have; None where
    there are no rigid blocks."""
    from cases.material.rigid_blocks import rigid_joints
    from cases.partition.lattice import further_sets

    try:
        return rigid_joints(scene, further_sets(scene)).left_over
    except SceneError:
        return None


def show_partition(facts: dict[str, Any]) -> None:
    """Print the blocks of a rock mass."""
    say(f"{facts['blocks']:,} blocks, {facts['area']:.6g} m2 in total")
    if facts["rigid_blocks"] != facts["blocks"]:
        say(f"{facts['rigid_blocks']:,} rigid blocks: numerics.dem.block subdivides the rock")
    for word in ("smallest", "largest"):
        one = facts[word]
        x, y = one["centroid"]
        say(f"{word} block: {one['area']:.4g} m2, at [{x:.4g}, {y:.4g}]")
    for name, one in facts["regions"].items():
        speeds = f"waves of {one['p_speed']:.4g} and {one['s_speed']:.4g} m/s"
        say(f"region {name}: {one['blocks']:,} blocks, {one['area']:.6g} m2, {speeds}")
    cuts = facts["cuts_through_rock"]
    sets = facts["joint_sets"] | ({"(no joint)": cuts} if cuts["contacts"] else {})
    rows = [[name, f"{one['contacts']:,}", f"{one['length']:.6g}"] for name, one in sets.items()]
    show_table(["joint set", "contacts", "length, m"], rows)
    show_table(["side", "edges"], [[name, f"{n:,}"] for name, n in facts["boundary"].items()])
    at_most = spoken(facts["bytes_at_most"])
    if (lack := facts["rigid_blocks_lack"]) is not None:
        share, why = "0", "their joints represent all of it"
        if lack > ROUND_OFF:
            share = f"{float(f'{100 * lack:.2g}'):g}"
            why = "only their joints deform, and joints of few directions have no Poisson effect"
        say(f"rigid blocks cannot represent {share} % of the intact rock's stiffness: {why}")
    say(f"memory of the blocks: {spoken(facts['bytes'])}, at most {at_most} during subdivision")


def _of_set(found: Partition, index: int) -> dict[str, Any]:
    own = found.contacts.joint_set == index
    return {"contacts": int(own.sum()), "length": float(found.contacts.length[own].sum())}


def _block(found: Partition, one: int) -> dict[str, Any]:
    return {"area": float(found.area[one]), "centroid": found.centroid[one].tolist()}
