"""The cost of every effect of a scene, and the misfit of the result without it.

Each effect is left out in turn, in rigid blocks and, if it applies, in jointed rock. The misfit is
the relative L2 difference from the same engine's result of the complete scene.
Columns of the table: `scene`, `title`, `variant`, `engine`, `effect`; `reason` why the effect
cannot be left out, "" if it can; `misfit` without it; `steps`, number with the effect over number
without it; `ns`, its cost per step and block, or per degree of freedom of the rock; `noise`,
resolution of the timings, ns; `own`, cost of such a step with all effects of the scene, ns;
`share`, ns / own; `everything`, cost with every effect that exists, in as many rigid blocks, ns.
"""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import chain
from math import nan
from pathlib import Path
from typing import Any

import pandas as pd

from jointwave import cases
from jointwave.cases.effects import SIDES, active_effects
from jointwave.cases.errors import SceneError
from jointwave.cases.material.properties import SLIP
from jointwave.cases.scene_type import AnyScene, Either
from jointwave.cases.schema.damping import Attenuating
from jointwave.cases.schema.law_parts import PARTS
from jointwave.cases.validate import checked
from jointwave.compare.engines import Progress, applies, solve
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.scenes import find
from jointwave.compare.solvers.continuum import JOINTED_ROCK
from jointwave.compare.solvers.dem import DEM
from jointwave.compare.studies import step_cost, store
from jointwave.compare.studies.effects_summary import summarise
from jointwave.compare.studies.experiment import Experiment, Summary
from jointwave.compare.studies.forecast import Run
from jointwave.compare.studies.step_cost import cost_of_every_effect, shortened, step_costs
from jointwave.compare.studies.store import FAILURES, Pool, Row, alone, reason_of
from jointwave.results.dataset import scene_hash

BLOCKS, ROCK = DEM.name, JOINTED_ROCK.name
#: Variants that the report page shows; their kernels are compiled there anyhow.
REPORTED = {
    "guo-li-2002/fig-03": "zeta 0.05",
    "guo-li-2002/fig-05": "matched",
    "guo-li-2002/fig-07": "soft layer",
    "guo-li-2002/fig-09": "no tension",
    "beyond/paper-effects": "",
}

ALONG = (*SLIP, *(key for part in PARTS if part.along for key in part.all_keys))
#: The changes that leave each effect out of a scene; `joints` stands for all its law tables.
WITHOUT: dict[str, dict[str, Any]] = {
    "dashpots": {
        "damping": {"rayleigh": None},
        "joints": {"damping_ratio": None, "viscosity": None},
    },
    "no tension": {"joints": {"tension": None}},
    "joints that differ": {"soft_layers": []},
    "scatter": {"scatter": None},
    "segments": {"segments": []},
    **{f"{kind} ends": {"ends": kind} for kind in ("quiet", "matched", "fixed")},
    **{f"{kind} sides": {"boundaries": kind} for kind in SIDES},
    "energy ledger": {"record": {"energy": False}},
    "field output": {"record": {"fields": None}},
    "finite rotation": {"motion": {"rotation": "small"}},
    "slip": {"joints": dict.fromkeys(ALONG)},
    **{part.name: {"joints": dict.fromkeys(part.all_keys)} for part in PARTS},
    "mass damping": {"damping": {"mass_proportional": None, "rayleigh": None}},
    "constant Q": {"rock": dict.fromkeys(Attenuating.model_fields)},
    "local damping": {"damping": {"local": None}},
    "gravity": {"gravity": None},
    "prestress": {"prestress": None},
}

COLUMNS = (
    *("scene", "title", "variant", "engine", "effect", "reason"),
    *("misfit", "steps", "ns", "noise", "share", "own", "everything"),
)
Variant = tuple[str, AnyScene]  #: a scene's name as the user gives it, and one of its variants
Point = tuple[Variant, str]  #: a variant, and the engine that runs it


def left_out(scene: Either, name: str) -> Either:
    """Return a scene without one of its effects; raises SceneError if it cannot be left out."""
    if name not in WITHOUT:
        raise SceneError(scene.where, name, None, "is the subject of the scene")
    changes = dict(WITHOUT[name])
    if law := changes.pop("joints", None):
        changes |= dict.fromkeys(scene.law_tables, law)
    tables = {key: _changed(getattr(scene, key), change) for key, change in changes.items()}
    changed: Any = scene.model_copy(update=tables)
    return checked(changed)


def _changed(table: Any, change: Any) -> Any:
    """Return a table with changes. A dict changes keys (of each table of a list), a string is the
    kind of ends or sides to set free, anything else replaces the table."""
    if isinstance(change, str):
        return table.model_copy(update={name: "free" for name, kind in table if kind == change})
    if not isinstance(change, dict):
        return change
    if isinstance(table, list):
        return [one.model_copy(update=change) for one in table]
    return table.model_copy(update=change)


def reported() -> list[Variant]:
    """Return the variants that the report page shows."""
    return [(name, cases.load_variant(find(name), of)) for name, of in REPORTED.items()]


class Effects(Experiment):
    """The effects of some variants: the pool runs them, which also compiles all kernels; then this
    process times the steps, one variant after the other."""

    def rows(self, pool: Pool | None = None, progress: Progress | None = None) -> list[Any]:
        """Return the rows of all effects of each point."""
        with alone():
            missing = sorted(self.missing(), key=lambda one: -len(active_effects(one[0][1])))
            runs = replace(self, points=missing, folder=None).measured(pool)
            rows = dict(zip(map(key, missing), runs, strict=True))
            costs = replace(self, measure=lambda point: timed(point, rows[key(point)]))
            return costs.measured(progress=progress)


def experiment(title: str, wanted: list[Variant], folder: Path) -> Experiment:
    """Return the study of all effects of some variants, with points and files in `folder`."""
    points = [
        (one, engine)
        for one in wanted
        for engine in (BLOCKS, ROCK)
        if engine == BLOCKS or applies(engine, one[1])
    ]

    def summary(rows: list[list[Row]]) -> Summary:
        return summarise(folder, pd.DataFrame(chain(*rows), columns=COLUMNS))

    return Effects(title, points, folder, key, measure, summary, runs)


def runs(points: Sequence[Point]) -> list[Run]:
    """Return the runs of variants with all effects and without each, and their timed beginnings."""
    found, whole = [], {}
    for (name, scene), engine in points:
        for effect in (None, *active_effects(scene)):
            with suppress(*FAILURES):
                one = scene if effect is None else left_out(scene, effect)
                short = shortened(one, engine)
                found += [Run(name, one, engine), Run(name, short, engine, 1 + step_cost.REPEATS)]
        if engine == BLOCKS and not scene.in_space:
            full = shortened(step_cost.with_every_effect(scene))
            whole[scene_hash(full)] = Run(name, full, BLOCKS, 1 + step_cost.REPEATS)
    return [*found, *whole.values()]


def key(point: Point) -> str:
    """Return the key of a variant in an engine: a hash of everything that determines its rows."""
    (name, scene), engine = point
    return store.key(name, scene.name, scene_hash(scene), engine)


def measure(point: Point) -> list[Row]:
    """Return the rows of a variant in an engine without timings; none for rock that cannot be run.

    Raises the errors of `solve` for rigid blocks, and SceneError for a scene without effects.
    """
    (name, scene), engine = point
    if not active_effects(scene):
        raise SceneError(scene.where, "", None, "has no effect to leave out")
    about: Row = {"scene": name, "title": scene.title, "variant": scene.name, "engine": engine}
    try:
        result = solve(engine, scene)
    except FAILURES:
        if engine == BLOCKS:
            raise
        return []
    rows = [about | {"effect": effect, "reason": ""} for effect in active_effects(scene)]
    for row in rows:
        try:
            other = solve(engine, left_out(scene, row["effect"]))
        except FAILURES as error:
            row["reason"] = reason_of(error)
        else:
            steps = float(result.attrs["steps"] / other.attrs["steps"])
            row |= {"misfit": misfit(other, result), "steps": steps}
    if engine == BLOCKS and not scene.in_space:
        solve(engine, shortened(step_cost.with_every_effect(scene)))  # compiles what `timed` runs
    return rows


def timed(point: Point, rows: list[Row]) -> list[Row]:
    """Return the rows of a variant in an engine, with the timed cost of each effect."""
    (_, scene), engine = point
    if not rows:
        return []
    able = [row for row in rows if not row["reason"]]
    own, *less = step_costs([scene, *(left_out(scene, row["effect"]) for row in able)], engine)
    whole = engine == BLOCKS and not scene.in_space
    every = {"own": own.ns, "everything": cost_of_every_effect(scene).ns if whole else nan}
    for row, one in zip(able, less, strict=True):
        ns = own.ns - one.ns
        row |= {"ns": ns, "noise": own.noise + one.noise, "share": ns / own.ns}
    return [row | every for row in rows]
