"""What every effect of a scene costs, and what it is worth: how far the answer is without it.

Cost is that of a step of one rigid block, and of one freedom of the jointed rock where that
applies; worth is the relative L2 misfit of the rigid blocks with the effect left out, against those
of the scene as it stands.
"""

from __future__ import annotations

from math import nan
from typing import Any, NamedTuple

import dem
from cases.effects import active_effects
from cases.errors import SceneError, UnstableError
from cases.scene import Scene
from compare.effort import freedom_nanoseconds, nanoseconds, stretch, whole
from compare.engines import applies
from compare.metrics import misfit
from compare.without import left_out, only

ROCK = "continuum-jointed"


class Dropped(NamedTuple):
    """The answer without an effect.

    misfit : from the answer with it. steps : of the scene over those without it, where the effect
    shortens the step. reason : why it cannot be left out; empty where it can.
    """

    effect: str
    misfit: float
    steps: float
    reason: str


class Worth(NamedTuple):
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


class Balance(NamedTuple):
    """All effects of a scene.

    scene, title, variant : its names. bare, own, everything : ns of a block-step with what the
    scene cannot be without, with its own set, and with every effect. rock : ns of a freedom-step of
    the jointed rock with the scene's own set, nan where that does not apply.
    """

    scene: str
    title: str
    variant: str
    bare: float
    own: float
    everything: float
    rock: float
    effects: list[Worth]

    @property
    def label(self) -> str:
        """The scene's name and its variant's."""
        return f"{self.scene}, {self.variant}" if self.variant else self.scene


def prepare(scene: Scene) -> list[Dropped]:
    """Return what leaving out each effect does to the answer, and compile all that is timed."""
    answer = dem.simulate(scene)
    called = active_effects(scene)
    for one in _sets(scene, called):
        stretch(one)[0]()
    dropped = [_drop(scene, name, answer) for name in called]
    for one in (scene, *(left_out(scene, d.effect) for d in dropped if not d.reason)):
        _rock(one)
    return dropped


def _sets(scene: Scene, called: list[str]) -> list[Scene]:
    """Return the scene bare, and with each effect alone that can be."""
    found = [only(scene, None)]
    for name in called:
        try:
            found.append(only(scene, name))
        except SceneError:
            continue
    return found


def _drop(scene: Scene, name: str, answer: Any) -> Dropped:
    try:
        without = dem.simulate(left_out(scene, name))
    except (SceneError, UnstableError) as error:
        return Dropped(name, nan, nan, getattr(error, "allowed", str(error)))
    steps = answer.attrs["steps"] / without.attrs["steps"]
    return Dropped(name, misfit(without, answer), float(steps), "")


def balance(name: str, scene: Scene, dropped: list[Dropped]) -> Balance:
    """Return what every effect that a scene calls for costs and is worth.

    name : of the scene, as its user knows it. dropped : what `prepare` returned.
    """
    bare, own, rock = nanoseconds(only(scene, None)), nanoseconds(scene), _rock(scene)
    found = [_worth(scene, one, bare, own, rock) for one in dropped]
    return Balance(name, scene.title, scene.name, bare, own, whole(), rock, found)


def _worth(scene: Scene, one: Dropped, bare: float, own: float, rock: float) -> Worth:
    if one.reason:
        return Worth(one.effect, nan, nan, nan, nan, nan, nan, one.reason)
    without = left_out(scene, one.effect)
    cost = own - nanoseconds(without)
    alone = _alone(scene, one.effect, bare)
    added = rock - _rock(without)
    return Worth(one.effect, alone, cost, cost / own, one.steps, added, one.misfit, "")


def _alone(scene: Scene, effect: str, bare: float) -> float:
    try:
        return nanoseconds(only(scene, effect)) - bare
    except SceneError:
        return nan


def _rock(scene: Scene) -> float:
    try:
        return freedom_nanoseconds(ROCK, scene) if applies(ROCK, scene) else nan
    except UnstableError:
        return nan
