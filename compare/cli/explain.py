"""A scene before any run: its effects, its critical steps, its exact solutions."""

from dataclasses import dataclass

from cases.effects import Effect, effects
from cases.material.calibrate import Properties, calibrate
from cases.schema.scene import Scene
from compare.engines import ENGINES, solver
from compare.experiments.cost import timings
from compare.experiments.cost.step_cost import nanoseconds, remembered_whole, whole
from compare.misfit.ranking import Reference, applicable, reference_of
from compare.solvers.record import Answer


@dataclass(frozen=True)
class StepChoice:
    """The step of one engine: critical and chosen, s, and how many of them."""

    engine: str
    critical: float
    dt: float
    steps: int


@dataclass(frozen=True)
class Cost:
    """What a step of one rigid block costs here: of this scene, and with every effect, ns; None
    where it was never measured."""

    own: float | None
    everything: float | None


@dataclass(frozen=True)
class Explanation:
    """Everything that can be said of a scene but what comes out of it.

    references : what each engine is held against; None where nothing checks it independently.
    """

    scene: Scene
    properties: Properties
    effects: list[Effect]
    steps: list[StepChoice]
    answers: dict[str, Answer]
    references: dict[str, Reference | None]
    cost: Cost


def explanation(scene: Scene, measured: bool = False) -> Explanation:
    """Return what a scene calls for, what is left out, and what can solve it.

    measured : step some blocks to say what they cost, which may compile kernels for a minute; else
    the cost is what such a scene's steps took here before.
    """
    answers = applicable(scene)
    able = [name for name, answer in answers.items() if answer]
    references = {name: reference_of(name, able, scene) for name in ENGINES if answers[name]}
    steps = [_step(name, scene) for name in ENGINES if answers[name]]
    cost = _cost(scene, measured)
    return Explanation(scene, calibrate(scene), effects(scene), steps, answers, references, cost)


def _cost(scene: Scene, measured: bool) -> Cost:
    count = scene.pillar.block_count
    if not measured:
        return Cost(timings.block_step(scene), remembered_whole(count))
    own = nanoseconds(scene)
    timings.note_block_step(scene, own)
    return Cost(own, whole(count))


def _step(name: str, scene: Scene) -> StepChoice:
    run = solver(name).prepare(scene)
    return StepChoice(name, run.critical, run.dt, run.steps)
