"""The cheapest way to solve a scene within a misfit: predicted from a few cheap runs, then run.

Every family of configurations (an engine, a scheme, elements) is run at two steps, n0 and 2 n0
steps per sample. Its error falls with the order q of its scheme, so that its waveforms at n steps
per sample are w + c n^-q (Richardson): their misfit from the reference is known for every n, and
their seconds are in proportion to n.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import ceil, inf
from typing import Any, NamedTuple

from cases.consistency import checked
from cases.errors import SceneError, UnstableError
from cases.scene import Numerics, Scene
from compare.engines import Progress, applies, solve
from compare.metrics import recorded, relative_l2

COARSEST = 0.9  # of the critical step
FINEST = 64  # times the steps of the coarsest
#: Whatever knows the physics of a scene best, the first that applies.
REFERENCES = ("jointed-bar", "slip-joint", "no-tension-chain", "spatial-lattice", "lattice")


class Family(NamedTuple):
    """Configurations that differ in their step alone.

    name : of the engine. engine : whose numerics `changes` are of. order : of the scheme.
    """

    name: str
    engine: str
    changes: dict[str, Any]
    order: int


def _rock(model: str, **changes: Any) -> Family:
    return Family(f"continuum-{model}", "continuum", {"scheme": "explicit", **changes}, 2)


FAMILIES = (
    Family("dem", "dem", {"scheme": "leapfrog"}, 2),
    Family("dem", "dem", {"scheme": "fourth-order"}, 4),
    *(_rock("jointed", order=p, elements_per_block=1) for p in (1, 2, 3, 4)),
    *(_rock("jointed", order=p, elements_per_block=n) for p, n in ((1, 2), (1, 4), (2, 2), (4, 2))),
    *(_rock("equivalent", order=p, elements_per_block=1) for p in (1, 2, 4)),
)


class Choice(NamedTuple):
    """One configuration, and what it is predicted to give: relative L2 misfit and s of stepping."""

    family: Family
    settings: dict[str, Any]
    misfit: float
    seconds: float


class Plan(NamedTuple):
    """What was chosen, and what came of it.

    reference : what the misfit is from. trials : runs that were made to predict. chosen : None
    where nothing is predicted to do. misfit, seconds : obtained; inf and 0 without.
    skipped : families that could not be run, with their reason.
    """

    scene: Scene
    reference: str
    trials: int
    chosen: Choice | None
    misfit: float
    seconds: float
    skipped: dict[str, str]


def plan(
    scene: Scene, misfit: float, seconds: float | None = None, progress: Progress | None = None
) -> Plan:
    """Return the cheapest configuration predicted to meet a misfit, run.

    seconds : instead the best misfit within so many s of stepping, where `misfit` costs more.
    Raises SceneError where nothing exact is known of the scene.
    """
    name = reference_of(scene)
    exact, choices, skipped = solve(name, plain(scene)), [], {}
    for i, family in enumerate(FAMILIES):
        try:
            choices += list(_predicted(scene, family, exact))
        except (SceneError, UnstableError) as error:
            skipped[_label(family)] = getattr(error, "allowed", str(error))
        if progress:
            progress((i + 1) / (len(FAMILIES) + 1))
    trials = 2 * (len(FAMILIES) - len(skipped))
    chosen = _cheapest(choices, misfit, seconds)
    if chosen is None:
        return Plan(scene, name, trials, None, inf, 0.0, skipped)
    result = solve(chosen.family.name, configured(scene, chosen.family, chosen.settings))
    obtained = relative_l2(*recorded(result, exact))
    spent = float(result.attrs["seconds_stepping"])
    return Plan(scene, name, trials, chosen, obtained, spent, skipped)


def reference_of(scene: Scene) -> str:
    """Return the name of the solution that knows a scene best."""
    for name in REFERENCES:
        if applies(name, scene):
            return name
    reason = applies(REFERENCES[0], scene).reason
    raise SceneError(scene.where, "", None, f"no exact solution to plan by: {reason}")


def plain(scene: Scene) -> Scene:
    """Return a scene with default numerics, without ledger and snapshots."""
    record = scene.record.model_copy(
        update={"interval": scene.interval, "energy": False, "fields": None}
    )
    return scene.model_copy(update={"numerics": Numerics(), "record": record, "expect": {}})


def configured(scene: Scene, family: Family, settings: dict[str, Any]) -> Scene:
    """Return a scene with a family's numerics, its own where the family has none; raises SceneError
    where it cannot have them."""
    table = getattr(scene.numerics, family.engine).model_copy(update=family.changes | settings)
    numerics = scene.numerics.model_copy(update={family.engine: table})
    return checked(plain(scene).model_copy(update={"numerics": numerics}))


def _predicted(scene: Scene, family: Family, exact) -> Iterator[Choice]:
    """Yield the configurations of a family with what they are predicted to give."""
    answer = applies(family.name, scene)
    if not answer:
        raise SceneError(scene.where, "", None, answer.reason)
    first = solve(family.name, configured(scene, family, {"step_fraction": COARSEST}))
    critical = float(first.attrs["critical_dt"])
    least = max(1, round(scene.interval / float(first.attrs["dt"])))
    second = solve(family.name, configured(scene, family, _steps(scene, 2 * least, critical)))
    (coarse, goal), (fine, _) = recorded(first, exact), recorded(second, exact)
    part = (coarse - fine) / (1 - 0.5**family.order)
    limit, each = coarse - part, float(second.attrs["seconds_stepping"]) / (2 * least)
    for n in dict.fromkeys(ceil(least * 2 ** (k / 4)) for k in range(1 + 4 * FINEST.bit_length())):
        there = limit + part * (least / n) ** family.order
        settings = _steps(scene, n, critical)
        yield Choice(family, settings, relative_l2(there, goal), each * n)


def _steps(scene: Scene, per_sample: int, critical: float) -> dict[str, Any]:
    """Return the settings that take so many steps per sample."""
    return {"step_fraction": float(f"{scene.interval / per_sample / critical * (1 + 1e-6):.7g}")}


def _cheapest(choices: list[Choice], misfit: float, seconds: float | None) -> Choice | None:
    """Return the cheapest that meets the misfit; else, or where it costs more, the best in time."""
    meets = [c for c in choices if c.misfit <= misfit]
    best = min(meets, key=lambda c: c.seconds, default=None)
    if seconds is None or (best is not None and best.seconds <= seconds):
        return best
    in_time = [c for c in choices if c.seconds <= seconds]
    return min(in_time, key=lambda c: c.misfit, default=None)


def _label(family: Family) -> str:
    return f"{family.name} ({', '.join(f'{k} {v}' for k, v in family.changes.items())})"


def options_of(choice: Choice) -> list[str]:
    """Return the `--set` options that make a configuration."""
    found = {**choice.family.changes, **choice.settings}
    return [f"numerics.{choice.family.engine}.{key}={value}" for key, value in found.items()]
