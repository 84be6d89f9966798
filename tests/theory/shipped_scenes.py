"""What each shipped scene holds beside its pairs of [expect], of the results that those have made.

The bounds are those that the project promises at the default numerics: the engines' distance from
the exact solution of the model that they discretise, and the closing of their energy ledger."""

import numpy as np

from jointwave import cases
from jointwave.cases.effects import active_effects
from jointwave.compare.cli.scene_tests import PairItem, SceneFile
from jointwave.compare.engines import ENGINES, applies
from jointwave.compare.misfit.metrics import misfit, relative_l2
from jointwave.compare.scenes import shipped_files
from jointwave.results.dataset import energy_residual

PLANE_WAVES = ("oblique-joint", "parallel-joints", "normal-incidence")
REFEREES = {
    "dem": ("lattice", "no-tension-chain", "spatial-lattice"),
    "continuum-jointed": ("jointed-bar", *PLANE_WAVES, "line-force", "point-force"),
    "continuum-equivalent": ("equivalent-bar", "images", "kelvin-voigt", "effective-medium"),
}
BOUNDS = {"dem": 2e-3, "continuum-jointed": 5e-3, "continuum-equivalent": 5e-3}
ENERGY_BOUND = 1e-3  # of the work put in
LINEAR_ENERGY_BOUND = 1e-10  # in the form that leapfrog conserves
FAILS = {"slip", "softening", "no tension", "closure"}  # effects by which a scene is not linear


class WholeItem(PairItem):
    """All variants of a shipped file on every engine and model that applies.

    release : called when its results are no longer needed."""

    def __init__(self, *, release, **kwargs):
        super().__init__(**kwargs)
        self.release = release

    def runtest(self):
        """Hold every result to the bounds, and tell every variant from the others."""
        scenes = cases.load(self.path)
        for scene in scenes:
            for engine in ENGINES:
                if applies(engine, scene):
                    self.hold(engine, scene)
        for k, scene in enumerate(scenes):
            for other in scenes[:k]:
                differ = any(self.differ(engine, scene, other) for engine in ENGINES)
                assert differ, f"{scene.name} records what {other.name} does"

    def teardown(self):
        """Release the results of the file, whose last test this is."""
        self.parent.results.clear()
        self.release()

    def result(self, name, scene):
        self.scene = scene
        return self._solved(name)

    def hold(self, engine, scene):
        """Finite, right to the promised misfit in force and motion, and the ledger closes."""
        result = self.result(engine, scene)
        recorded = result.drop_vars("break_time", errors="ignore")
        assert all(np.isfinite(variable.values).all() for variable in recorded.data_vars.values())
        if "energy" in result:
            bound = ENERGY_BOUND if FAILS & set(active_effects(scene)) else LINEAR_ENERGY_BOUND
            assert energy_residual(result) < bound, scene.name
        for referee in (one for one in REFEREES[engine] if applies(one, scene)):
            exact = self.result(referee, scene)
            assert misfit(result, exact) < BOUNDS[engine], (scene.name, referee)
            for quantity in {"velocity", "rotation"} & set(result) & set(exact):
                off = relative_l2(result[quantity].values, exact[quantity].values)
                assert off < BOUNDS[engine], (scene.name, referee)

    def differ(self, engine, one, other):
        """Return whether two scenes differ by an engine in more than round-off."""
        if not (applies(engine, one) and applies(engine, other)):
            return bool(applies(engine, one)) != bool(applies(engine, other))
        a, b = self.result(engine, one), self.result(engine, other)
        if any(a[key].shape != b[key].shape for key in ("velocity", "time")):
            return True
        return misfit(a, b) > 1e-6


def added_to(items, release):
    """Return collected tests with that of each shipped file behind its pairs; release : called
    after each of them. Long ones come before short ones: near the end, processes take tests from
    one another."""
    # tests/hard holds hard scenes, by every scheme.
    files, found = {path for path in shipped_files() if path.parent.name != "hard"}, []
    items = sorted(items, key=lambda item: item.path.suffix == ".toml" and _is_short(item.path))
    for item, after in zip(items, [*items[1:], None], strict=True):
        found.append(item)
        file, last = item.parent, after is None or after.parent is not item.parent
        if last and isinstance(file, SceneFile) and file.path in files:
            name = "every engine, every variant"
            found.append(WholeItem.from_parent(file, name=name, release=release))
    return found


def _is_short(path):
    """Return whether a scene takes about a second: any but those of rock masses."""
    return path.parent.name != "rock-mass"
