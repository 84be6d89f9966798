"""What a scene is, before any run: its effects, its critical steps, its exact solutions."""

from dataclasses import dataclass

from cases.calibrate import Properties, calibrate
from cases.effects import Effect, effects, is_spatial
from cases.scene import Scene
from compare import rates
from compare.effort import nanoseconds, whole
from compare.engines import ENGINES, applies, exact_names
from compare.exact.answer import Answer


@dataclass(frozen=True)
class StepChoice:
    """The step of one engine: critical and chosen, s, and how many of them."""

    engine: str
    critical: float
    dt: float
    steps: int


@dataclass(frozen=True)
class Cost:
    """What a step of one rigid block costs here: of this scene, and with every effect, ns."""

    own: float
    everything: float

    @property
    def share(self) -> float:
        """The scene's own part of the cost of everything."""
        return self.own / self.everything


@dataclass(frozen=True)
class Explanation:
    """Everything that can be said of a scene but what comes out of it."""

    scene: Scene
    properties: Properties
    effects: list[Effect]
    steps: list[StepChoice]
    answers: dict[str, Answer]
    cost: Cost


def explanation(scene: Scene) -> Explanation:
    """Return what a scene calls for, what is left out, and what can solve it."""
    answers = {name: applies(name, scene) for name in (*ENGINES, *exact_names())}
    steps = [_step(name, scene) for name in ENGINES if answers[name]]
    cost = Cost(nanoseconds(scene), whole(scene.pillar.block_count))
    rates.note_block_step(scene, cost.own)
    return Explanation(scene, calibrate(scene), effects(scene), steps, answers, cost)


def _step(name: str, scene: Scene) -> StepChoice:
    if name == "dem" and is_spatial(scene):
        from dem.spatial.simulate import prepare

        _, _, time, critical = prepare(scene)
    elif name == "dem":
        from dem.axial.simulate import scheme_of

        _, _, time, critical = scheme_of(scene).build(scene)
    else:
        from continuum.simulate import steps_of

        choice, critical = steps_of(scene, name.removeprefix("continuum-"))
        time = choice.time
    return StepChoice(name, critical, time.dt, time.steps)
