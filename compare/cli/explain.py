"""A scene before any run: its effects, its critical steps, its exact solutions."""

from typing import NamedTuple

from cases.effects import Effect, effects
from cases.material.calibrate import Properties, calibrate
from cases.schema.scene import Scene
from compare.engines import ENGINES, solver
from compare.experiments.cost import timings
from compare.experiments.cost.step_cost import nanoseconds, remembered_whole, whole
from compare.misfit.ranking import Reference, applicable, reference_of
from compare.solvers.record import Answer, Prepared


class Explanation(NamedTuple):
    """Everything that can be said of a scene but what comes out of it.

    runs : of each engine that applies, with its step. references : what each engine is held
    against; None where nothing checks it independently. block_step, with_everything : what a step
    of one rigid block costs here, of this scene and with every effect, ns; None where it was never
    measured.
    """

    scene: Scene
    properties: Properties
    effects: list[Effect]
    runs: dict[str, Prepared]
    answers: dict[str, Answer]
    references: dict[str, Reference | None]
    block_step: float | None
    with_everything: float | None


def explanation(scene: Scene, measured: bool = False) -> Explanation:
    """Return what a scene calls for, what is left out, and what can solve it.

    measured : step some blocks to say what they cost, which may compile kernels for a minute; else
    the cost is what such a scene's steps took here before.
    """
    answers = applicable(scene)
    able = [name for name, answer in answers.items() if answer]
    engines = [name for name in ENGINES if answers[name]]
    references = {name: reference_of(name, able, scene) for name in engines}
    runs = {name: solver(name).prepare(scene) for name in engines}
    cost = _cost(scene, measured)
    return Explanation(scene, calibrate(scene), effects(scene), runs, answers, references, *cost)


def _cost(scene: Scene, measured: bool) -> tuple[float | None, float | None]:
    count = scene.pillar.block_count
    if not measured:
        return timings.block_step(scene), remembered_whole(count)
    own = nanoseconds(scene)
    timings.note_block_step(scene, own)
    return own, whole(count)
