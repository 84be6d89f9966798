"""Every shipped scene on every engine and model that applies, held against exact solutions.

The bounds are those that the project promises at the default numerics: the engines' distance from
the exact solution of the model that they discretise, and the closing of their energy ledger.
"""

from functools import cache

import numpy as np
import pytest

import cases
from cases.effects import active_effects, is_spatial
from cases.schema.scene import Scene
from compare.engines import ENGINES, applies, names, solve
from compare.exact.blocks import lattice
from compare.misfit.metrics import misfit, relative_l2
from compare.scenes import SHIPPED, shipped
from results.dataset import energy_residual, scene_hash

REFEREES = {
    "dem": ("lattice", "no-tension-chain", "spatial-lattice"),
    "continuum-jointed": ("jointed-bar", "oblique-joint", "parallel-joints", "line-force"),
    "continuum-equivalent": ("equivalent-bar", "images", "kelvin-voigt", "effective-medium"),
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
        self.digest = scene_hash(scene)

    def __hash__(self):
        return hash(self.digest)

    def __eq__(self, other):
        return self.digest == other.digest


def result_of(name, scene):
    """Return a result, solved once for all tests of this file."""
    key = _Scene(scene)
    return _solve_by_hash(key.digest, name, key)


def is_linear(scene):
    """Return whether every joint holds and carries tension."""
    return not {"slip", "softening", "no tension"} & set(active_effects(scene))


@pytest.mark.parametrize("scene, engine", list(every_run()))
def test_shipped_scene(scene, engine):
    """Finite, right to the promised misfit in force and motion, and the ledger closes."""
    result = result_of(engine, scene)
    recorded = result.drop_vars("break_time", errors="ignore")
    assert all(np.isfinite(variable.values).all() for variable in recorded.data_vars.values())
    linear = is_linear(scene)
    if "energy" in result:
        assert energy_residual(result) < (LINEAR_ENERGY_BOUND if linear else ENERGY_BOUND)
    for referee in REFEREES[engine]:
        if applies(referee, scene):
            exact = result_of(referee, scene)
            assert misfit(result, exact) < BOUNDS[engine]
            for quantity in {"velocity", "rotation"} & set(result) & set(exact):
                assert relative_l2(result[quantity].values, exact[quantity].values) < BOUNDS[engine]


def shipped_scenes():
    for path in shipped():
        for scene in cases.load(path):
            label = f"{path.parent.name}/{path.stem}-{scene.name or 'base'}"
            yield pytest.param(scene, id=label.replace(" ", "_"))


@pytest.mark.parametrize("scene", list(shipped_scenes()))
def test_shipped_scene_meets_what_it_expects(scene):
    """Every bound of [expect] holds, in each variant that both of the pair apply to."""
    for pair, bound in scene.expect.items():
        one, other = pair.split(" ~ ")
        if applies(one, scene) and applies(other, scene):
            assert misfit(result_of(one, scene), result_of(other, scene)) <= bound, pair


def shipped_variants():
    for path in shipped():
        if cases.load(path)[1:]:
            yield pytest.param(path, id=f"{path.parent.name}/{path.stem}")


@pytest.mark.parametrize("path", list(shipped_variants()))
def test_every_variant_has_an_answer_of_its_own(path):
    """What a variant is named for shows in what one engine or the other records."""
    scenes = cases.load(path)
    for k, scene in enumerate(scenes):
        for other in scenes[:k]:
            assert any(differs(engine, scene, other) for engine in ENGINES), (
                scene.name,
                other.name,
            )


def differs(engine, scene, other):
    """Return whether two scenes differ by an engine in more than round-off."""
    if not (applies(engine, scene) and applies(engine, other)):
        return bool(applies(engine, scene)) != bool(applies(engine, other))
    one, two = result_of(engine, scene), result_of(engine, other)
    if any(one[key].shape != two[key].shape for key in ("velocity", "time")):
        return True
    return misfit(one, two) > 1e-6


def test_no_solution_of_axial_motion_claims_a_spatial_scene():
    """What solves a scene that leaves its axis is made for it; each other one says why not."""
    spatial = {"dem", "spatial-lattice", "slip-joint", "sliding-block"}
    spatial |= {"continuum-jointed", "continuum-equivalent"}
    every = [s for path in shipped() for s in cases.load(path)]
    scenes = [s for s in every if isinstance(s, Scene) and is_spatial(s)]
    assert scenes
    for scene in scenes:
        answers = {name: applies(name, scene) for name in names()}
        assert {name for name, answer in answers.items() if answer} <= spatial
        assert all(answer.reason for answer in answers.values() if not answer)


def test_spall_with_strong_joints_is_the_linear_chain():
    """Joints whose strength the pulse does not reach carry it as those without a strength."""
    scene = cases.load_variant(SHIPPED / "beyond" / "spall.toml", "strong joints")
    assert misfit(result_of("dem", scene), lattice.solve(scene)) < BOUNDS["dem"]


def test_every_folder_ships_scenes():
    """The paper's nine figures are all there, and scenes beyond them."""
    names = {f"{path.parent.name}/{path.stem}" for path in shipped()}
    assert {f"guo-li-2002/fig-{n:02d}" for n in range(2, 11)} <= names
    assert {name.split("/")[0] for name in names} == {"guo-li-2002", "beyond", "hard", "rock-mass"}
