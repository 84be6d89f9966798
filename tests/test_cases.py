"""What the shipped scenes are; what they find is tested beside their pairs of [expect], by
`tests/theory/shipped_scenes.py`."""

from jointwave import cases
from jointwave.cases.effects import is_spatial
from jointwave.compare.engines import applies, names, solve
from jointwave.compare.exact.blocks import row_of_blocks
from jointwave.compare.misfit.metrics import misfit
from jointwave.compare.scenes import SHIPPED, shipped_files


def test_no_solution_of_axial_motion_claims_a_spatial_scene():
    """What solves a scene that leaves its axis is made for it; each other one says why not."""
    spatial = {"dem", "spatial-lattice", "slip-joint", "sliding-block"}
    spatial |= {"continuum-jointed", "continuum-equivalent"}
    every = [s for path in shipped_files() for s in cases.load(path)]
    scenes = [s for s in every if s.is_column and is_spatial(s)]
    assert scenes
    for scene in scenes:
        answers = {name: applies(name, scene) for name in names()}
        assert {name for name, answer in answers.items() if answer} <= spatial
        assert all(answer.reason for answer in answers.values() if not answer)


def test_spall_with_strong_joints_is_the_linear_chain():
    """Joints whose strength the pulse does not reach carry it as those without a strength."""
    scene = cases.load_variant(SHIPPED / "beyond" / "spall.toml", "strong joints")
    assert misfit(solve("dem", scene), row_of_blocks.solve(scene)) < 2e-3
