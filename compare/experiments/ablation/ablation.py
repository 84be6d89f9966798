"""Ablation: the cost of every effect of a scene, and its influence on the result.

The cost is that of a step of one rigid block, and of one degree of freedom of the jointed rock if
that applies; the influence is the relative L2 misfit of the rigid blocks without the effect,
relative to those of the complete scene.
"""

from collections.abc import Callable
from math import nan
from typing import Any, NamedTuple

import xarray as xr

from cases.effects import active_effects
from cases.kinds import AnyScene
from compare.engines import applies, solve
from compare.experiments.ablation.variants import left_out, only
from compare.misfit.metrics import pairings, rms
from compare.misfit.weight import ROUND_OFF
from compare.solvers.continuum import JOINTED_ROCK
from compare.solvers.dem import DEM
from compare.studies.step_cost import StepCost, shortened, step_costs, with_every_effect
from compare.studies.store import FAILURES, reason_of

ROCK = JOINTED_ROCK.name
MISSING = StepCost(nan, nan)  # not timed
OWN = "own"  # the complete scene, among those without one of its effects


class Dropped(NamedTuple):
    """The result without an effect.

    misfit : from the result with it, of the waveforms that move with it; nan if none does.
    steps : of the scene over those without it, if the effect shortens the step. alone : whether
    the scene can have it without the others. rock : whether the jointed rock can be without it.
    reason : why it cannot be left out; empty if it can. stirred : a waveform that moves only
    without it, in words; empty if there is none.
    """

    effect: str
    misfit: float
    steps: float
    alone: bool
    rock: bool
    reason: str
    stirred: str = ""


class EffectCost(NamedTuple):
    """One effect of a scene; missing numbers are nan.

    alone : ns per block-step that it adds to the scene without other effects. cost : ns that it
    adds to the scene's own set. share : of the scene's own step. rock : ns that it adds to a step
    of one freedom of the jointed rock. noise : ns, resolution of these three by their names.
    steps, misfit, reason, stirred : as in `Dropped`.
    """

    effect: str
    alone: float
    cost: float
    share: float
    steps: float
    rock: float
    misfit: float
    reason: str
    noise: dict[str, float]
    stirred: str = ""

    def is_resolved(self, name: str) -> bool:
        """Return whether a cost in ns, given by its name, exceeds the noise of timings."""
        return bool(abs(getattr(self, name)) > self.noise[name])


class Ablation(NamedTuple):
    """All effects of a scene.

    scene, title, variant : its names. bare, own, everything : ns per block-step with the
    indispensable effects, with its own set, and with every effect in as many blocks. rock : ns per
    freedom-step of the jointed rock with the scene's own set, nan if that does not apply.
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
    """Return the results without each effect, and compile all kernels to be timed."""
    result = solve(DEM.name, scene)
    dropped = [_drop(scene, name, result) for name in active_effects(scene)]
    solve(DEM.name, shortened(only(scene, None)))
    _runs(lambda: solve(ROCK, scene))
    return dropped


def _drop(scene: AnyScene, name: str, result: Any) -> Dropped:
    try:
        one = left_out(scene, name)
        without = solve(DEM.name, one)
    except FAILURES as error:
        return Dropped(name, nan, nan, False, False, reason_of(error))
    steps = result.attrs["steps"] / without.attrs["steps"]
    alone = _runs(lambda: solve(DEM.name, shortened(only(scene, name))))
    rock = _runs(lambda: solve(ROCK, one))
    misfit, stirred = _influence(without, result)
    return Dropped(name, misfit, float(steps), alone, rock, "", stirred)


def _influence(without: xr.Dataset, result: xr.Dataset) -> tuple[float, str]:
    """Return the misfit of the worst waveform, and a waveform that moves only without the effect,
    in words: with the effect it is round-off, relative to which no misfit is defined."""
    found = [one for one in pairings(without, result) if not one.faint]
    loudest: dict[str, float] = {}
    for one in found:
        loudest[one.place.quantity] = max(loudest.get(one.place.quantity, 0.0), rms(one.other))
    moves = [rms(one.other) > ROUND_OFF * loudest[one.place.quantity] for one in found]
    misfits = [one.misfit for one, here in zip(found, moves, strict=True) if here]
    stirred = [one.place.words for one, here in zip(found, moves, strict=True) if not here]
    return max(misfits, default=nan if found else 0.0), next(iter(stirred), "")


def _runs(work: Callable[[], object]) -> bool:
    try:
        work()
    except FAILURES:
        return False
    return True


def ablate(name: str, scene: AnyScene, dropped: list[Dropped]) -> Ablation:
    """Return the cost and the influence of every effect of a scene.

    name : of the scene, as the user typed it. dropped : from `prepare`.
    """
    alone = {one.effect: only(scene, one.effect) for one in dropped if one.alone}
    without = {one.effect: left_out(scene, one.effect) for one in dropped if not one.reason}
    first = [with_every_effect(scene), only(scene, None), scene]
    full, bare, own, *rest = step_costs([*first, *alone.values(), *without.values()])
    in_alone = dict(zip(alone, rest, strict=False))
    in_without = dict(zip(without, rest[len(alone) :], strict=True))
    rock = _in_rock(scene, {one.effect: without[one.effect] for one in dropped if one.rock})
    found = []
    for one in dropped:
        pairs = {
            "alone": (in_alone.get(one.effect, MISSING), bare),
            "cost": (own, in_without.get(one.effect, MISSING)),
            "rock": (rock.get(OWN, MISSING), rock.get(one.effect, MISSING)),
        }
        ns = {name: more.ns - less.ns for name, (more, less) in pairs.items()}
        noise = {name: more.noise + less.noise for name, (more, less) in pairs.items()}
        about = one._asdict() | ns | {"share": ns["cost"] / own.ns, "noise": noise}
        found.append(EffectCost(**about))
    ns_rock = rock.get(OWN, MISSING).ns
    return Ablation(name, scene.title, scene.name, bare.ns, own.ns, full.ns, ns_rock, found)


def _in_rock(scene: AnyScene, without: dict[str, AnyScene]) -> dict[str, StepCost]:
    """Return the cost per freedom-step of jointed rock, for the scene and without each effect;
    empty if jointed rock does not apply."""
    if not applies(ROCK, scene):
        return {}
    timed = {OWN: scene} | without
    return dict(zip(timed, step_costs(list(timed.values()), ROCK), strict=True))
