"""The cost of every effect of a scene, and the misfit of the result without it.

Both are measured in rigid blocks and, if it applies, in the jointed rock: each effect is left out
in turn. The misfit is relative L2 from the engine's own result of the complete scene.
"""

from contextlib import suppress
from math import nan
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from jointwave import cases
from jointwave.cases.effects import active_effects
from jointwave.cases.errors import SceneError
from jointwave.cases.scene_type import AnyScene
from jointwave.compare.engines import Progress, applies, solve
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.scenes import find
from jointwave.compare.solvers.continuum import JOINTED_ROCK
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.studies import store
from jointwave.compare.studies.effect_removal import left_out
from jointwave.compare.studies.forecast import Run
from jointwave.compare.studies.step_cost import REPEATS, shortened, step_costs, with_every_effect
from jointwave.compare.studies.store import FAILURES, Store, alone, reason_of
from jointwave.results.dataset import scene_hash

BLOCKS, ROCK = DEM.name, JOINTED_ROCK.name
#: Variants on the report's page, whose kernels are compiled there anyhow.
REPORTED = {
    "guo-li-2002/fig-03": "zeta 0.05",
    "guo-li-2002/fig-05": "matched",
    "guo-li-2002/fig-07": "soft layer",
    "guo-li-2002/fig-09": "no tension",
    "beyond/paper-effects": "",
}


Variant = tuple[str, AnyScene]  #: a scene's name as its user knows it, and one of its variants


class EffectRow(NamedTuple):
    """One effect of a scene in an engine; missing numbers are nan.

    reason : why the effect cannot be left out; "" if it can. misfit : of the result without it.
    steps : with it over those without it. ns : that it adds to a step of one block, or of one
    degree of freedom of the rock; noise : the resolution of timings; share : of such a step with
    all effects of the scene, which takes `own`, ns. everything : ns with every effect there is, in
    as many rigid blocks.
    """

    scene: str
    title: str
    variant: str
    engine: str
    effect: str
    reason: str = ""
    misfit: float = nan
    steps: float = nan
    ns: float = nan
    noise: float = nan
    share: float = nan
    own: float = nan
    everything: float = nan


def reported() -> list[Variant]:
    """Return the variants of the report's page."""
    return [(name, cases.load_variant(find(name), of)) for name, of in REPORTED.items()]


def run(wanted: list[Variant], folder: Path, progress: Progress | None = None) -> pd.DataFrame:
    """Return the table of all effects, one `EffectRow` each; results are saved in `folder`.

    Steps are timed: variants are run in this process, one after the other.
    """
    saved: Store[list[EffectRow]] = Store(list[EffectRow], folder)
    with alone():
        measured = saved.compute(wanted, key, measure, progress=progress)
    return pd.DataFrame([row for some in measured for row in some], columns=EffectRow._fields)


def planned(wanted: list[Variant], folder: Path) -> list[Run]:
    """Return the runs of the variants that are not saved yet, and those that time their steps."""
    left, found = Store(list[EffectRow], folder).missing(wanted, key), []
    for name, scene in left:
        for engine in (one for one in (BLOCKS, ROCK) if applies(one, scene)):
            for effect in (None, *active_effects(scene)):
                with suppress(*FAILURES):
                    one = scene if effect is None else left_out(scene, effect)
                    short = shortened(one, engine)
                    found += [Run(name, one, engine), Run(name, short, engine, 1 + REPEATS)]
        full = [] if scene.in_space else [shortened(with_every_effect(scene))]
        found += [Run(name, one, BLOCKS, 1 + REPEATS) for one in full]
    return found


def key(one: Variant) -> str:
    """Return the key of a variant: a hash of everything that determines its rows."""
    name, scene = one
    return store.key(name, scene.name, scene_hash(scene))


def measure(variant: Variant) -> list[EffectRow]:
    """Return the rows of a variant; raises the errors of `solve` for rigid blocks, and SceneError
    for a scene without effects."""
    scene = variant[1]
    if not active_effects(scene):
        raise SceneError(scene.where, "", None, "has no effect to leave out")
    rows = _rows(variant, BLOCKS)
    if applies(ROCK, scene):
        with suppress(*FAILURES):
            rows += _rows(variant, ROCK)
    return rows


def _rows(variant: Variant, engine: str) -> list[EffectRow]:
    name, scene = variant
    result, without, found = solve(engine, scene), {}, {}
    for effect in active_effects(scene):
        about: dict[str, Any] = {}
        try:
            one = left_out(scene, effect)
            other = solve(engine, one)
        except FAILURES as error:
            about["reason"] = reason_of(error)
        else:
            without[effect] = one
            about["misfit"] = misfit(other, result)
            about["steps"] = float(result.attrs["steps"] / other.attrs["steps"])
        found[effect] = about
    timed = engine == BLOCKS and not scene.in_space
    full = [with_every_effect(scene)] if timed else []
    own, *costs = step_costs([scene, *without.values(), *full], engine)
    for effect, less in zip(without, costs, strict=False):
        ns = own.ns - less.ns
        found[effect] |= {"ns": ns, "noise": own.noise + less.noise, "share": ns / own.ns}
    of = name, scene.title, scene.name, engine
    everything = costs[-1].ns if full else nan
    return [
        EffectRow(*of, effect, own=own.ns, everything=everything, **about)
        for effect, about in found.items()
    ]
