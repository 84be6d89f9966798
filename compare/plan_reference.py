"""What a plan measures misfits from: an exact solution, or a run that has converged to itself."""

from __future__ import annotations

from math import inf
from typing import Any, NamedTuple

import xarray as xr

from cases.errors import SceneError
from cases.scene import Scene
from compare.engines import applies, solve
from compare.metrics import misfit
from compare.plan_families import Family, configured, plain, settings

#: Whatever knows the physics of a scene best, the first that applies.
EXACT = ("jointed-bar", "slip-joint", "no-tension-chain", "spatial-lattice", "lattice")

SHARE = 0.1  # of the misfit asked for, that a run may be from the next finer one
LONGEST = 20.0  # s of stepping of the finest run
LEVELS = 10


class Reference(NamedTuple):
    """What misfits are from; settings : of an engine's run, "" where the solution is exact.

    error : of a run, its estimated misfit: how far it is from the one before; 0 where exact.
    """

    name: str
    result: xr.Dataset
    settings: str = ""
    error: float = 0.0

    @property
    def is_exact(self) -> bool:
        """Whether it is an exact solution."""
        return not self.settings


def reference_of(scene: Scene, asked: float) -> Reference:
    """Return what a scene's misfits are from, good enough for the misfit that is asked for.

    Raises SceneError where nothing exact is known of it and no run in reach has converged.
    """
    exact = exact_name(scene)
    if exact is not None:
        return Reference(exact, solve(exact, plain(scene)))
    return _converged(scene, asked)


def exact_name(scene: Scene) -> str | None:
    """Return the exact solution that knows a scene best; it takes layers for joints, so that none
    knows a layer with a thickness."""
    if any(layer.thickness is not None for layer in scene.soft_layers):
        return None
    return next((name for name in EXACT if applies(name, scene)), None)


def finest_name(scene: Scene) -> str:
    """Return the engine with the finest physics that can simulate a scene."""
    if applies("continuum-jointed", scene):
        return "continuum-jointed"
    thick = any(layer.thickness is not None for layer in scene.soft_layers)
    return "continuum-equivalent" if thick and applies("continuum-equivalent", scene) else "dem"


def _converged(scene: Scene, asked: float) -> Reference:
    """Return the finest engine's run that differs from the one before by little enough.

    Each has at most half the step, and half the elements' size, of the one before. Its error is at
    most the difference where the error falls at least in proportion to the step.
    """
    name, before, apart = finest_name(scene), None, inf
    for level in range(LEVELS):
        family = _family(name, level)
        numerics, result = _at_most(scene, family, _half(before))
        apart = inf if before is None else misfit(before, result)
        if apart < SHARE * asked:
            made = ", ".join(f"{k} {v}" for k, v in (family.changes | numerics).items())
            return Reference(name, result, made, apart)
        before = result
        if float(result.attrs["seconds_stepping"]) * 4 > LONGEST:
            break
    raise SceneError(
        scene.where,
        "",
        None,
        f"no exact solution to plan by, and {name} within {LONGEST:g} s a run converges to "
        f"{100 * apart:.2g} %, not to {100 * SHARE * asked:.2g} %: ask for a larger --misfit",
    )


def _half(before: xr.Dataset | None) -> float:
    return inf if before is None else float(before.attrs["dt"]) / 2


def _family(name: str, level: int) -> Family:
    if name == "dem":
        return Family(name, "dem", {"scheme": "leapfrog"}, 2)
    changes = {"scheme": "explicit", "order": 2, "elements_per_block": 2**level}
    return Family(name, "continuum", changes, 2)


def _at_most(scene: Scene, family: Family, dt: float) -> tuple[dict[str, Any], xr.Dataset]:
    """Return the numerics and the result of steps of 0.4 critical ones, or dt (s) if that is less.

    The step divides the sampling interval, so that a part of the critical one may be no other.
    """
    numerics = {"step_fraction": 0.4}
    result = solve(family.name, configured(scene, family, numerics))
    if float(result.attrs["dt"]) > dt * (1 + 1e-9):
        per_sample, critical = round(scene.interval / dt), float(result.attrs["critical_dt"])
        numerics = settings(scene, family, per_sample, critical)
        result = solve(family.name, configured(scene, family, numerics))
    return numerics, result
