"""Every shipped scene on every engine and model that applies, held against exact solutions.

The bounds are those that the project promises at the default numerics: the engines' distance from
the exact solution of the model that they discretise, and the closing of their energy ledger.
"""

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
    "continuum-jointed": (
        "jointed-bar",
        "oblique-joint",
        "parallel-joints",
        "line-force",
        "normal-incidence",
    ),
    "continuum-equivalent": ("equivalent-bar", "images", "kelvin-voigt", "effective-medium"),
}
BOUNDS = {"dem": 2e-3, "continuum-jointed": 5e-3, "continuum-equivalent": 5e-3}
ENERGY_BOUND = 1e-3  # of the work put in
LINEAR_ENERGY_BOUND = 1e-10  # in the form that leapfrog conserves


class Solved:
    """The scenes of a file with their results, each solved once."""

    def __init__(self, path):
        self.scenes, self.known = cases.load(path), {}

    def result(self, name, scene):
        key = name, scene_hash(scene)
        if key not in self.known:
            self.known[key] = solve(name, scene)
        return self.known[key]

    def differ(self, engine, one, other):
        """Return whether two scenes differ by an engine in more than round-off."""
        if not (applies(engine, one) and applies(engine, other)):
            return bool(applies(engine, one)) != bool(applies(engine, other))
        a, b = self.result(engine, one), self.result(engine, other)
        if any(a[key].shape != b[key].shape for key in ("velocity", "time")):
            return True
        return misfit(a, b) > 1e-6


#: Scenes of many seconds, which their own [expect] holds to the same exact solutions in every run;
#: the ledgers of their joints close in tests/dem/blocks and tests/continuum/plane.
LONG = {f"rock-mass/{name}" for name in ("closing-joint", "one-joint", "parallel-joints")}


def files():
    """Yield every shipped file."""
    for path in shipped():
        name = f"{path.parent.name}/{path.stem}"
        yield pytest.param(path, id=name, marks=[pytest.mark.slow] if name in LONG else [])


@pytest.fixture(scope="module", params=files())
def solved(request):
    """Return a file's scenes; their results are released with it."""
    return Solved(request.param)


def is_linear(scene):
    """Return whether every joint holds, carries tension and closes linearly."""
    return not {"slip", "softening", "no tension", "closure"} & set(active_effects(scene))


@pytest.mark.parametrize("engine", ENGINES)
def test_shipped_scenes(solved, engine):
    """Finite, right to the promised misfit in force and motion, and the ledger closes, in every
    variant. Bounds of [expect] are held by the scenes themselves, which are tests."""
    for scene in (one for one in solved.scenes if applies(engine, one)):
        result = solved.result(engine, scene)
        recorded = result.drop_vars("break_time", errors="ignore")
        assert all(np.isfinite(variable.values).all() for variable in recorded.data_vars.values())
        if "energy" in result:
            bound = LINEAR_ENERGY_BOUND if is_linear(scene) else ENERGY_BOUND
            assert energy_residual(result) < bound, scene.name
        for referee in (one for one in REFEREES[engine] if applies(one, scene)):
            exact = solved.result(referee, scene)
            assert misfit(result, exact) < BOUNDS[engine], (scene.name, referee)
            for quantity in {"velocity", "rotation"} & set(result) & set(exact):
                off = relative_l2(result[quantity].values, exact[quantity].values)
                assert off < BOUNDS[engine], (scene.name, referee)


def test_every_variant_has_an_answer_of_its_own(solved):
    """What a variant is named for shows in what one engine or the other records."""
    for k, scene in enumerate(solved.scenes):
        for other in solved.scenes[:k]:
            assert any(solved.differ(engine, scene, other) for engine in ENGINES), (
                scene.name,
                other.name,
            )


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
    assert misfit(solve("dem", scene), lattice.solve(scene)) < BOUNDS["dem"]


def test_every_folder_ships_scenes():
    """The paper's nine figures are all there, and scenes beyond them."""
    names = {f"{path.parent.name}/{path.stem}" for path in shipped()}
    assert {f"guo-li-2002/fig-{n:02d}" for n in range(2, 11)} <= names
    assert {name.split("/")[0] for name in names} == {"guo-li-2002", "beyond", "hard", "rock-mass"}
