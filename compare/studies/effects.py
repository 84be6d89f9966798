"""The cost of every effect of a scene, and the misfit of the result without it.

The cost is that of a step of one rigid block, and of one degree of freedom of the jointed rock if
that applies; the misfit is that of the rigid blocks without the effect, relative L2, from those of
the complete scene.
"""

from collections.abc import Callable
from math import nan
from pathlib import Path
from typing import NamedTuple

import pandas as pd
import xarray as xr

from jointwave import cases
from jointwave.cases.effects import active_effects
from jointwave.cases.scene_type import AnyScene, pillar_of
from jointwave.cases.schema.scene import Scene
from jointwave.compare.engines import Progress, applies, solve
from jointwave.compare.misfit.metrics import pairings, rms
from jointwave.compare.misfit.weight import ROUND_OFF
from jointwave.compare.scenes import find, shipped
from jointwave.compare.solvers.continuum import JOINTED_ROCK
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.studies import store
from jointwave.compare.studies.effect_removal import left_out
from jointwave.compare.studies.step_cost import StepCost, step_costs, with_every_effect
from jointwave.compare.studies.store import DIED, FAILURES, Pool, Store, alone, reason_of
from jointwave.results.dataset import scene_hash

ROCK = JOINTED_ROCK.name
MISSING = StepCost(nan, nan)  # not timed
SOLVING = 0.8  # of the time, if nothing is compiled yet
#: Scenes of the report's page, each with its variants, whose kernels are compiled there anyhow.
REPORTED = {
    "guo-li-2002/fig-03": ["zeta 0.05"],
    "guo-li-2002/fig-05": ["matched"],
    "guo-li-2002/fig-07": ["soft layer"],
    "guo-li-2002/fig-09": ["no tension"],
    "beyond/paper-effects": [""],
}


class Variant(NamedTuple):
    """One variant of a scene, and the scene's name as its user knows it."""

    name: str
    scene: AnyScene

    @property
    def key(self) -> str:
        """The key of its results: a hash of everything that determines them."""
        return store.key(self.name, self.scene.name, scene_hash(self.scene))


class Removal(NamedTuple):
    """The result without an effect.

    reason : why the effect cannot be left out; "" if it can. misfit : from the result with it, of
    the waveforms that move with it; nan if none does. at_rest : a waveform that moves only without
    it, in words; "" if there is none. steps : of the scene over those without it, if the effect
    shortens the step. rock : whether the jointed rock can be without it.
    """

    effect: str
    reason: str
    misfit: float = nan
    at_rest: str = ""
    steps: float = nan
    rock: bool = False


class EffectRow(NamedTuple):
    """One effect of a scene; missing numbers are nan.

    ns : that it adds to a block-step of the scene, and share : of it. ns_rock : ns that it adds to
    a step of one freedom of the jointed rock. Noise: the resolution of timings. own, everything :
    ns per block-step with all effects of the scene, and with every effect in as many blocks. The
    others as in `Removal`.
    """

    scene: str
    title: str
    variant: str
    effect: str
    reason: str
    misfit: float
    at_rest: str
    steps: float
    ns: float
    ns_noise: float
    share: float
    ns_rock: float
    ns_rock_noise: float
    own: float
    everything: float


def all_shipped() -> list[Variant]:
    """Return every variant of every shipped pillar."""
    return [
        Variant(f"{path.parent.name}/{path.stem}", scene)
        for path in shipped()
        for scene in cases.load(path)
        if isinstance(scene, Scene)
    ]


def reported() -> list[Variant]:
    """Return the variants of the report's page."""
    return [
        Variant(name, pillar_of(cases.load_variant(find(name), variant)))
        for name, variants in REPORTED.items()
        for variant in variants
    ]


def run(
    wanted: list[Variant], folder: Path, pool: Pool | None = None, progress: Progress | None = None
) -> pd.DataFrame:
    """Return the table of all effects, one `EffectRow` each; results are saved in `folder`.

    pool : solves and compiles; steps are timed in this process, one scene after the other.
    """
    tell = progress or (lambda fraction: None)
    rows: Store[list[EffectRow]] = Store(list[EffectRow], folder)
    new = [one for one in wanted if not rows.has(one.key)]
    results = removals(new, folder, pool, lambda part: tell(SOLVING * part))
    found = {one.key: some for one, some in zip(new, results, strict=True)}
    with alone():
        measured = rows.compute(
            wanted,
            lambda one: one.key,
            lambda one: timed(one, found[one.key]),
            progress=lambda part: tell(SOLVING + (1 - SOLVING) * part),
        )
    return pd.DataFrame([row for some in measured for row in some], columns=EffectRow._fields)


def removals(
    wanted: list[Variant], folder: Path, pool: Pool | None = None, progress: Progress | None = None
) -> list[list[Removal]]:
    """Return the results without each effect of all variants, which are saved in `folder`, and
    compile what `run` will time."""
    known: Store[list[Removal]] = Store(list[Removal], folder)
    return known.compute(
        wanted,
        lambda one: f"{one.key}-without",
        without_each,
        pool,
        progress,
        lost=lambda one: [Removal(effect, DIED) for effect in active_effects(one.scene)],
    )


def without_each(variant: Variant) -> list[Removal]:
    """Return the results without each effect of a variant."""
    result = solve(DEM.name, variant.scene)
    _runs(lambda: solve(ROCK, variant.scene))
    return [_without(variant.scene, name, result) for name in active_effects(variant.scene)]


def _without(scene: AnyScene, name: str, result: xr.Dataset) -> Removal:
    try:
        one = left_out(scene, name)
        found = solve(DEM.name, one)
    except FAILURES as error:
        return Removal(name, reason_of(error))
    steps = float(result.attrs["steps"] / found.attrs["steps"])
    rock = _runs(lambda: solve(ROCK, one))
    return Removal(name, "", *influence(found, result), steps, rock)


def _runs(work: Callable[[], object]) -> bool:
    try:
        work()
    except FAILURES:
        return False
    return True


def influence(without: xr.Dataset, result: xr.Dataset) -> tuple[float, str]:
    """Return the misfit of the worst waveform, and a waveform that moves only without the effect,
    in words: with the effect it is round-off, relative to which no misfit is defined."""
    found = [one for one in pairings(without, result) if not one.faint]
    loudest: dict[str, float] = {}
    for one in found:
        quantity = one.place.quantity
        loudest[quantity] = max(loudest.get(quantity, 0.0), rms(one.other))
    moving = [x for x in found if rms(x.other) > ROUND_OFF * loudest[x.place.quantity]]
    at_rest = [one.place.words for one in found if one not in moving]
    misfit = max((one.misfit for one in moving), default=nan if found else 0.0)
    return misfit, next(iter(at_rest), "")


def timed(variant: Variant, removed: list[Removal]) -> list[EffectRow]:
    """Return the rows of a variant; removed : its results without each effect."""
    name, scene = variant
    without = {one.effect: left_out(scene, one.effect) for one in removed if not one.reason}
    full, own, *rest = step_costs([with_every_effect(scene), scene, *without.values()])
    blocks, rock, own_rock = dict(zip(without, rest, strict=True)), {}, MISSING
    if applies(ROCK, scene):
        names = [one.effect for one in removed if one.rock]
        own_rock, *rest = step_costs([scene, *(without[x] for x in names)], ROCK)
        rock = dict(zip(names, rest, strict=True))
    rows = []
    for one in removed:
        less, less_rock = blocks.get(one.effect, MISSING), rock.get(one.effect, MISSING)
        ns = own.ns - less.ns
        rows.append(
            EffectRow(
                name,
                scene.title,
                scene.name,
                *(one.effect, one.reason, one.misfit, one.at_rest, one.steps),
                *(ns, own.noise + less.noise, ns / own.ns),
                *(own_rock.ns - less_rock.ns, own_rock.noise + less_rock.noise),
                *(own.ns, full.ns),
            )
        )
    return rows
