"""Every shipped scene on every engine and model that applies, held against exact solutions.

The bounds are those that the project promises at the default numerics: the engines' distance from
the exact solution of the model that they discretise, and the closing of their energy ledger.
"""

from functools import cache

import numpy as np
import pytest

import cases
from cases.result import energy_residual
from compare.engines import ENGINES, applies, solve
from compare.metrics import misfit, relative_l2
from compare.scenes import shipped

REFEREES = {
    "dem": ("lattice", "no-tension-chain"),
    "continuum-jointed": ("jointed-bar",),
    "continuum-equivalent": ("equivalent-bar", "images", "kelvin-voigt"),
}
BOUNDS = {"dem": 2e-3, "continuum-jointed": 5e-3, "continuum-equivalent": 5e-3}
ENERGY_BOUND = 1e-3  # of the work put in
LINEAR_ENERGY_BOUND = 1e-10  # in the form that leapfrog conserves


def every_run():
    for path in shipped():
        for scene in cases.load(path):
            for engine in ENGINES:
                if applies(engine, scene):
                    label = f"{path.parent.name}/{path.stem}-{scene.name or 'base'}-{engine}"
                    yield pytest.param(scene, engine, id=label.replace(" ", "_"))


@cache
def _solve_by_hash(digest, name, scene):
    return solve(name, scene.value)


class _Scene:
    """A scene that can be a cache key: equal when everything that decides its result is."""

    def __init__(self, scene):
        self.value = scene
        self.digest = cases.result.scene_hash(scene)

    def __hash__(self):
        return hash(self.digest)

    def __eq__(self, other):
        return self.digest == other.digest


def result_of(name, scene):
    """Return a result, solved once for all tests of this file."""
    key = _Scene(scene)
    return _solve_by_hash(key.digest, name, key)


@pytest.mark.parametrize("scene, engine", list(every_run()))
def test_shipped_scene(scene, engine):
    """Finite, right to the promised misfit in stress and velocity, and the ledger closes."""
    result = result_of(engine, scene)
    assert all(np.isfinite(variable.values).all() for variable in result.data_vars.values())
    linear = not (~cases.calibrate.calibrate(scene).tension).any()
    assert energy_residual(result) < (LINEAR_ENERGY_BOUND if linear else ENERGY_BOUND)
    for referee in REFEREES[engine]:
        if applies(referee, scene):
            exact = result_of(referee, scene)
            assert misfit(result, exact) < BOUNDS[engine]
            assert relative_l2(result.velocity.values, exact.velocity.values) < BOUNDS[engine]


def test_every_folder_ships_scenes():
    """The paper's nine figures are all there, and scenes beyond them."""
    names = {f"{path.parent.name}/{path.stem}" for path in shipped()}
    assert {f"guo-li-2002/fig-{n:02d}" for n in range(2, 11)} <= names
    assert {name.split("/")[0] for name in names} == {"guo-li-2002", "beyond", "hard"}
