"""The short pillar and its variants are within the error that a stable scheme can have."""

import pytest

from hard_runs import SCHEMES, SHORT, HardRun, marked
from jointwave import cases
from jointwave.cases.errors import SceneError
from jointwave.compare.engines import applies
from jointwave.compare.scenes import find

VARIANTS = [scene.name for scene in cases.load(find(SHORT))]
NONLINEAR = {"joints without tension", "softening just short of a snap-back"}


@pytest.mark.parametrize(("engine", "scheme"), marked(SCHEMES))
@pytest.mark.parametrize("variant", [name for name in VARIANTS if name not in NONLINEAR])
def test_misfit_from_the_exact_solution_is_at_most_the_phase_error(variant, engine, scheme):
    """Contrasts of 1e8, damping far beyond the critical, a resonance, a load above the cut-off."""
    run = HardRun(engine, scheme, variant=variant)
    try:
        name, found = run.referee() if applies(engine, run.scene) else (None, 0.0)
    except SceneError as error:
        assert error.key.endswith(".scheme")
        return
    assert name is None or found <= run.allowed()


def test_joints_a_little_stiffer_are_beyond_the_phase_error():
    """A twentieth on every joint is seen: the bound is no wider than what it bounds."""
    run = HardRun("dem", "leapfrog")
    layers = [{"y": 0.5 * j, "normal_stiffness": 1.05 * 8.748e9} for j in range(1, 20)]
    assert run.referee()[1] < run.allowed()
    run.result = run.run(soft_layers=layers)
    assert run.referee()[1] > run.allowed()
