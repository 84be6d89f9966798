"""A scene before any run: its effects, its critical steps, its exact solutions."""

from typing import Any, NamedTuple

from cases.effects import Effect, effects
from cases.errors import SceneError
from cases.kinds import AnyScene
from cases.material.calibrate import Properties, calibrate
from cases.schema.scene import Scene
from compare.cli.partition_view import partition_facts
from compare.engines import ENGINES, solver
from compare.experiments.cost import timings
from compare.experiments.cost.step_cost import nanoseconds, remembered_whole, whole
from compare.misfit.ranking import Reference, applicable, reference_of
from compare.solvers.record import Answer, Prepared


class Explanation(NamedTuple):
    """Everything known about a scene before a run.

    properties : of a pillar. blocks : of a rock mass, see `partition_view`. runs : of each engine
    that applies, with its step; failures : why one that applies could not run. references : what
    each engine is held against; None where nothing checks it independently. block_step,
    with_everything : what a step of one rigid block of a pillar costs here, of this scene and with
    every effect, ns; None where it was never measured.
    """

    scene: AnyScene
    properties: Properties | None
    blocks: dict[str, Any] | None
    effects: list[Effect]
    runs: dict[str, Prepared]
    failures: dict[str, str]
    answers: dict[str, Answer]
    references: dict[str, Reference | None]
    block_step: float | None
    with_everything: float | None


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
    about = effects(scene), runs, failures, answers, references
    return Explanation(scene, properties, blocks, *about, *cost)


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
