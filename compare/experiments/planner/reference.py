"""The references of a plan's errors: the finest physics of a scene, and each engine's own model.

Each is an exact solution with a sufficiently small error bound, or a converged run.
"""

from math import inf
from typing import Any, NamedTuple

import xarray as xr

from cases.errors import SceneError
from cases.kinds import AnyScene
from compare.engines import ENGINES, solve, solver
from compare.experiments.common import ErrorReference
from compare.experiments.planner.families import Family, configured, plain, rock, settings
from compare.misfit import ranking
from compare.misfit.metrics import JUDGED, misfit, worst
from compare.solvers.record import Prepared

SHARE = 1 / JUDGED  # of the requested misfit: largest error of a reference
LONGEST = {"pillar": 20.0, "rock mass": 60.0}  # s of stepping of the finest run
LEVELS = 10
#: Least growth in degrees of freedom of quadratic elements of half the size: 5 / 3 along a block of
#: one element, 25 / 9 in a quadrilateral.
GROWN = {"pillar": 1.5, "rock mass": 2.5}


class OwnModel(NamedTuple):
    """The model of one engine.

    reference : of its numerical errors. modelling : upper bound on its distance from the finest
    physics, including the latter's error; 0 if it is the finest physics itself.
    """

    reference: ErrorReference
    modelling: float

    @property
    def least(self) -> float:
        """The error that no step reduces: modelling error plus that of the own reference."""
        return self.modelling + self.reference.error

    def too_far(self, family: Family) -> str:
        """Return why no step of a family can reach a misfit below its modelling error."""
        return f"the modelling error of {family.model.label} is already {100 * self.least:.3g} %"


class References:
    """The references of one scene, accurate enough for the requested misfit.

    finest : that of the most complete physics; reason : why it is that one.
    Raises SceneError if there is no exact solution and no affordable run has converged.
    """

    def __init__(self, scene: AnyScene, asked: float) -> None:
        self.scene, self.asked = scene, asked
        self._own: dict[str, OwnModel] = {}
        found = ranking.finest(_applicable(scene), scene)
        if found is None:
            raise SceneError(scene.where, "", None, "no solver resolves all physics of the scene")
        self.finest = self._reference(found.name, Family(found.name, {}))
        self.reason = found.reason

    def own(self, family: Family) -> OwnModel:
        """Return the model of a family; raises SceneError if no run of it has converged."""
        model = family.model
        if model.label not in self._own:
            self._own[model.label] = self._find_own(model)
        return self._own[model.label]

    def _find_own(self, model: Family) -> OwnModel:
        scene, finest = configured(self.scene, model, {}), self.finest
        exact = ranking.own_exact(model.name, _applicable(scene), scene)
        block = getattr(self.scene.numerics.dem, "block", None)
        is_own = finest.name == model.name and model.changes.get("block", block) == block
        if is_own or finest.name == exact:
            return OwnModel(finest, 0.0)
        reference = self._reference(exact or model.name, model, finest.result)
        return OwnModel(reference, misfit(reference.result, finest.result) + finest.error)

    def _reference(
        self, name: str, model: Family, finest: xr.Dataset | None = None
    ) -> ErrorReference:
        """Return an exact solution, or a converged run of a model."""
        if name in ENGINES:
            return _converged(self.scene, model, self.asked, finest)
        result = solve(name, plain(self.scene))
        error = worst(result, result).floor
        if error > SHARE * self.asked:
            raise _not_known(self.scene, f"{name} knows itself", error, self.asked)
        return ErrorReference(name, result, error)


def _applicable(scene: AnyScene) -> list[str]:
    return [name for name, answer in ranking.applicable(scene).items() if answer]


def _converged(
    scene: AnyScene, model: Family, asked: float, finest: xr.Dataset | None
) -> ErrorReference:
    """Return a model's run that differs little enough from the previous one.

    Each has at most half the step, and half the elements' size, of the previous one. Its error is
    at most the difference if the error falls at least in proportion to the step. A run also
    suffices once its model is certain to be further from the finest physics than requested.
    """
    before, apart, longest = None, inf, LONGEST[scene.kind]
    for family in _refined(scene, model):
        numerics, run = _prepared(scene, family, before)
        if before is not None and not _is_finer(scene, model, run, before):
            continue
        if before is not None and _seconds(run, before) > longest:
            break
        result = solve(family.name, configured(scene, family, numerics))
        apart = inf if before is None else misfit(before, result)
        is_far = finest is not None and misfit(result, finest) - apart > asked
        if apart < SHARE * asked or is_far:
            made = ", ".join(f"{k} {v}" for k, v in (family.changes | numerics).items())
            return ErrorReference(model.name, result, apart, made)
        before = result
    what = f"no exact solution to plan by, and {model.label} within {longest:g} s a run"
    if apart == inf:
        raise SceneError(scene.where, "", None, f"{what} has no finer elements to compare with")
    raise _not_known(scene, f"{what} converges", apart, asked)


def _refined(scene: AnyScene, model: Family) -> list[Family]:
    if ENGINES[model.name].has_rigid_blocks:
        return [model] * LEVELS
    return [rock(scene, model.name, 2, 2**level) for level in range(LEVELS)]


def _prepared(
    scene: AnyScene, family: Family, before: xr.Dataset | None
) -> tuple[dict[str, Any], Prepared]:
    """Return the numerics for steps of 0.4 of the critical one, or half of the previous ones if
    that is less, and the prepared run.

    The step divides the sampling interval, so a smaller fraction may give the same step.
    """
    numerics = {"step_fraction": 0.4}
    run = solver(family.name).prepare(configured(scene, family, numerics))
    if before is None or run.dt <= (dt := float(before.attrs["dt"]) / 2) * (1 + 1e-9):
        return numerics, run
    numerics = settings(scene, family, round(scene.interval / dt), run.critical)
    return numerics, run._replace(dt=dt, steps=round(run.steps * run.dt / dt))


def _is_finer(scene: AnyScene, model: Family, run: Prepared, before: xr.Dataset) -> bool:
    """Return whether all elements have half the previous size: a block may be smaller than
    requested, and a given mesh is not refined."""
    if ENGINES[model.name].has_rigid_blocks:
        return True
    return bool(run.freedoms > GROWN[scene.kind] * before.attrs["degrees_of_freedom"])


def _seconds(run: Prepared, before: xr.Dataset) -> float:
    """Return the expected seconds of a run, from the previous one."""
    about = before.attrs
    work = run.steps * run.freedoms / (about["steps"] * about["degrees_of_freedom"])
    return float(about["seconds_stepping"] * work)


def _not_known(scene: AnyScene, what: str, error: float, asked: float) -> SceneError:
    """Return the error for a reference that is not accurate enough."""
    share = f"to {100 * error:.2g} %, not to {100 * SHARE * asked:.2g} %"
    return SceneError(scene.where, "", None, f"{what} {share}: ask for a larger --misfit")
