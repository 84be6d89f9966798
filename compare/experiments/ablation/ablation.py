"""Ablation: the cost of every effect of a scene, and how far the result is without it.

The cost is that of a step of one rigid block, and of one freedom of the jointed rock where that
applies; the influence is the relative L2 misfit of the rigid blocks without the effect, against
those of the scene as it stands.
"""

from __future__ import annotations

from collections.abc import Callable
from math import nan
from typing import TYPE_CHECKING, Any, NamedTuple

from cases.effects import active_effects
from compare.engines import applies, solve
from compare.experiments.ablation.variants import left_out, only
from compare.experiments.cost.step_cost import (
    everything_like,
    freedoms_in_turns,
    in_turns,
    stretch,
)
from compare.experiments.failures import FAILURES, reason_of
from compare.misfit.metrics import misfit
from compare.solvers.continuum import JOINTED_ROCK
from compare.solvers.dem import DEM

if TYPE_CHECKING:
    from cases.kinds import AnyScene

ROCK = JOINTED_ROCK.name
OWN = "own"  # the scene as it stands, among those without one of its effects


class Dropped(NamedTuple):
    """The result without an effect.

    misfit : from the result with it. steps : of the scene over those without it, where the effect
    shortens the step. alone : whether the scene can have it without the others. rock : whether the
    jointed rock can be without it. reason : why it cannot be left out; empty where it can.
    """

    effect: str
    misfit: float
    steps: float
    alone: bool
    rock: bool
    reason: str


class EffectCost(NamedTuple):
    """One effect of a scene; numbers that there are not are nan.

    alone : ns of a block-step that it adds to the scene without any other. cost : ns that it adds
    to the scene's own set. share : of the scene's own step. steps, misfit, reason : as in
    `Dropped`. rock : ns that it adds to a step of one freedom of the jointed rock.
    """

    effect: str
    alone: float
    cost: float
    share: float
    steps: float
    rock: float
    misfit: float
    reason: str


class Ablation(NamedTuple):
    """All effects of a scene.

    scene, title, variant : its names. bare, own, everything : ns of a block-step with what the
    scene cannot be without, with its own set, and with every effect in as many blocks. rock : ns of
    a freedom-step of the jointed rock with the scene's own set, nan where that does not apply.
    """

    scene: str
    title: str
    variant: str
    bare: float
    own: float
    everything: float
    rock: float
    effects: list[EffectCost]

    @property
    def label(self) -> str:
        """The scene's name and its variant's."""
        return f"{self.scene}, {self.variant}" if self.variant else self.scene


def prepare(scene: AnyScene) -> list[Dropped]:
    """Return the results without each effect, and compile all that is timed."""
    result = solve(DEM.name, scene)
    dropped = [_drop(scene, name, result) for name in active_effects(scene)]
    stretch(only(scene, None))[0]()
    _runs(lambda: solve(ROCK, scene))
    return dropped


def _drop(scene: AnyScene, name: str, result: Any) -> Dropped:
    try:
        one = left_out(scene, name)
        without = solve(DEM.name, one)
    except FAILURES as error:
        return Dropped(name, nan, nan, False, False, reason_of(error))
    steps = result.attrs["steps"] / without.attrs["steps"]
    alone = _runs(lambda: stretch(only(scene, name))[0]())
    rock = _runs(lambda: solve(ROCK, one))
    return Dropped(name, misfit(without, result), float(steps), alone, rock, "")


def _runs(work: Callable[[], object]) -> bool:
    try:
        work()
    except FAILURES:
        return False
    return True


def ablate(name: str, scene: AnyScene, dropped: list[Dropped]) -> Ablation:
    """Return the cost and the influence of every effect that a scene calls for.

    name : of the scene, as its user knows it. dropped : what `prepare` returned.
    """
    alone = {one.effect: only(scene, one.effect) for one in dropped if one.alone}
    without = {one.effect: left_out(scene, one.effect) for one in dropped if not one.reason}
    first = [everything_like(scene), only(scene, None), scene]
    full, bare, own, *rest = in_turns([*first, *alone.values(), *without.values()])
    ns_alone = dict(zip(alone, rest, strict=False))
    ns_without = dict(zip(without, rest[len(alone) :], strict=True))
    rock = _ns_in_rock(scene, {one.effect: without[one.effect] for one in dropped if one.rock})
    found = [
        EffectCost(
            one.effect,
            ns_alone.get(one.effect, nan) - bare,
            (cost := own - ns_without.get(one.effect, nan)),
            cost / own,
            one.steps,
            rock.get(OWN, nan) - rock.get(one.effect, nan),
            one.misfit,
            one.reason,
        )
        for one in dropped
    ]
    return Ablation(name, scene.title, scene.name, bare, own, full, rock.get(OWN, nan), found)


def _ns_in_rock(scene: AnyScene, without: dict[str, AnyScene]) -> dict[str, float]:
    """Return the ns of a freedom-step of jointed rock, as the scene stands and without each effect;
    empty where that rock does not apply."""
    if not applies(ROCK, scene):
        return {}
    timed = {OWN: scene} | without
    return dict(zip(timed, freedoms_in_turns(ROCK, list(timed.values())), strict=True))
