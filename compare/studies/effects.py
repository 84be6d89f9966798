"""The cost of every effect of a scene, and the misfit of the result without it.

The cost is that of a step of one rigid block, and of one degree of freedom of the jointed rock if
that applies; the misfit is that of the rigid blocks without the effect, relative L2, from those of
the complete scene.
"""

from contextlib import suppress
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

    def row(self, effect: str, reason: str) -> "EffectRow":
        """Return the row of an effect before it is measured; reason : why it cannot be left out."""
        return EffectRow(self.name, self.scene.title, self.scene.name, effect, reason)


class EffectRow(NamedTuple):
    """One effect of a scene; missing numbers are nan.

    reason : why the effect cannot be left out; "" if it can. misfit : of the result without it from
    that with it, of the waveforms that move with it; nan if none does. at_rest : a waveform that
    moves only without it, in words; "" if there is none. steps : of the scene over those without
    it, if the effect shortens the step. ns : that it adds to a block-step of the scene, and share :
    of it. ns_rock : ns that it adds to a step of one freedom of the jointed rock. Noise: the
    resolution of timings. own, everything : ns per block-step with all effects of the scene, and
    with every effect in as many blocks.
    """

    scene: str
    title: str
    variant: str
    effect: str
    reason: str
    misfit: float = nan
    at_rest: str = ""
    steps: float = nan
    ns: float = nan
    ns_noise: float = nan
    share: float = nan
    ns_rock: float = nan
    ns_rock_noise: float = nan
    own: float = nan
    everything: float = nan


def all_shipped() -> list[Variant]:
    """Return every variant of every shipped pillar, but for the hard cases."""
    return [
        Variant(f"{path.parent.name}/{path.stem}", scene)
        for path in shipped()
        if path.parent.name != "hard"
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
    saved: Store[list[EffectRow]] = Store(list[EffectRow], folder)
    new = [one for one in wanted if not saved.has(one.key)]
    results = saved.compute(
        new,
        lambda one: f"{one.key}-without",
        without_each,
        pool,
        lambda part: tell(SOLVING * part),
        lost=lambda one: [one.row(effect, DIED) for effect in active_effects(one.scene)],
    )
    found = {one.key: some for one, some in zip(new, results, strict=True)}
    full: dict[str, StepCost] = {}  # of the scenes with every effect, which variants share
    with alone():
        measured = saved.compute(
            wanted,
            lambda one: one.key,
            lambda one: timed(one, found[one.key], full),
            progress=lambda part: tell(SOLVING + (1 - SOLVING) * part),
        )
    return pd.DataFrame([row for some in measured for row in some], columns=EffectRow._fields)


def without_each(variant: Variant) -> list[EffectRow]:
    """Return the rows of a variant before they are timed, and compile what `timed` will run."""
    result = solve(DEM.name, variant.scene)
    _compile_rock(variant.scene)
    return [_without(variant, name, result) for name in active_effects(variant.scene)]


def _without(variant: Variant, name: str, result: xr.Dataset) -> EffectRow:
    try:
        one = left_out(variant.scene, name)
        found = solve(DEM.name, one)
    except FAILURES as error:
        return variant.row(name, reason_of(error))
    _compile_rock(one)
    misfit, at_rest = influence(found, result)
    steps = float(result.attrs["steps"] / found.attrs["steps"])
    return variant.row(name, "")._replace(misfit=misfit, at_rest=at_rest, steps=steps)


def _compile_rock(scene: AnyScene) -> None:
    with suppress(*FAILURES):
        solve(ROCK, scene)


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


def timed(variant: Variant, rows: list[EffectRow], full: dict[str, StepCost]) -> list[EffectRow]:
    """Return the rows of a variant with the costs of its effects.

    full : the costs with every effect by the hash of their scene, completed here.
    """
    scene = variant.scene
    everything = with_every_effect(scene)
    if (name := scene_hash(everything)) not in full:
        (full[name],) = step_costs([everything])
    found: list[EffectRow] = []
    without = {one.effect: left_out(scene, one.effect) for one in rows if not one.reason}
    own, *rest = step_costs([scene, *without.values()])
    blocks, rock = dict(zip(without, rest, strict=True)), _rock_costs(scene, without)
    for row in rows:
        ns, ns_noise = _difference(own, blocks.get(row.effect))
        ns_rock, ns_rock_noise = _difference(rock.get(""), rock.get(row.effect))
        row = row._replace(ns=ns, ns_noise=ns_noise, ns_rock=ns_rock, ns_rock_noise=ns_rock_noise)
        found.append(row._replace(share=ns / own.ns, own=own.ns, everything=full[name].ns))
    return found


def _rock_costs(scene: AnyScene, without: dict[str, AnyScene]) -> dict[str, StepCost]:
    """Return the costs of the jointed rock by the effect left out, "" for none."""
    if not applies(ROCK, scene):
        return {}
    scenes = {k: one for k, one in {"": scene, **without}.items() if applies(ROCK, one)}
    try:
        return dict(zip(scenes, step_costs([*scenes.values()], ROCK), strict=True))
    except FAILURES:
        return {}


def _difference(own: StepCost | None, less: StepCost | None) -> tuple[float, float]:
    """Return the difference of two costs and its noise; nan without one of them."""
    return (own.ns - less.ns, own.noise + less.noise) if own and less else (nan, nan)
