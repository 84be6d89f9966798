"""The cost of every effect of a scene, and the misfit of the result without it.

Both are measured in rigid blocks and, if it applies, in the jointed rock: each effect is left out
in turn. The misfit is relative L2 from the engine's own result of the complete scene.
"""

from contextlib import suppress
from math import nan
from pathlib import Path
from typing import NamedTuple

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
from jointwave.compare.studies.step_cost import StepCost, step_costs, with_every_effect
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


class Variant(NamedTuple):
    """One variant of a scene, and the scene's name as its user knows it."""

    name: str
    scene: AnyScene

    @property
    def key(self) -> str:
        """The key of its results: a hash of everything that determines them."""
        return store.key(self.name, self.scene.name, scene_hash(self.scene))


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
    return [Variant(name, cases.load_variant(find(name), of)) for name, of in REPORTED.items()]


def run(wanted: list[Variant], folder: Path, progress: Progress | None = None) -> pd.DataFrame:
    """Return the table of all effects, one `EffectRow` each; results are saved in `folder`.

    Steps are timed: variants are run in this process, one after the other.
    """
    saved: Store[list[EffectRow]] = Store(list[EffectRow], folder)
    full: dict[str, StepCost] = {}  # of the scenes with every effect, which variants share
    with alone():
        measured = saved.compute(
            wanted, lambda one: one.key, lambda one: measure(one, full), progress=progress
        )
    return pd.DataFrame([row for some in measured for row in some], columns=EffectRow._fields)


def measure(variant: Variant, full: dict[str, StepCost]) -> list[EffectRow]:
    """Return the rows of a variant.

    full : the costs with every effect by the hash of their scene, completed here. Raises the errors
    of `solve` for rigid blocks, and SceneError for a scene without effects.
    """
    rows = _rows(variant, BLOCKS)
    everything = with_every_effect(variant.scene)
    if (key := scene_hash(everything)) not in full:
        (full[key],) = step_costs([everything])
    rows = [row._replace(everything=full[key].ns) for row in rows]
    if applies(ROCK, variant.scene):
        with suppress(*FAILURES):
            rows += _rows(variant, ROCK)
    return rows


def _rows(variant: Variant, engine: str) -> list[EffectRow]:
    scene, rows = variant.scene, []
    if not active_effects(scene):
        raise SceneError(scene.where, "", None, "has no effect to leave out")
    result, without = solve(engine, scene), {}
    for effect in active_effects(scene):
        row = EffectRow(variant.name, scene.title, scene.name, engine, effect)
        try:
            one = left_out(scene, effect)
            found = solve(engine, one)
        except FAILURES as error:
            rows.append(row._replace(reason=reason_of(error)))
            continue
        without[effect] = one
        steps = float(result.attrs["steps"] / found.attrs["steps"])
        rows.append(row._replace(misfit=misfit(found, result), steps=steps))
    own, *costs = step_costs([scene, *without.values()], engine)
    cost = dict(zip(without, costs, strict=True))
    return [_timed(row._replace(own=own.ns), own, cost.get(row.effect)) for row in rows]


def _timed(row: EffectRow, own: StepCost, less: StepCost | None) -> EffectRow:
    if less is None:
        return row
    ns = own.ns - less.ns
    return row._replace(ns=ns, noise=own.noise + less.noise, share=ns / own.ns)
