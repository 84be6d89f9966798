"""What the shipped scenes are; what they find is tested beside their pairs of [expect], by
`tests/theory/shipped_scenes.py`."""

from jointwave import cases
from jointwave.compare.engines import applies, names
from jointwave.compare.scenes import shipped_files


def test_no_solution_of_axial_motion_claims_a_spatial_scene():
    """What solves a scene that leaves its axis is made for it; each other one says why not."""
    spatial = {"dem", "spatial-lattice", "slip-joint", "sliding-block"}
    spatial |= {"continuum-jointed", "continuum-equivalent"}
    every = [s for path in shipped_files() for s in cases.load(path)]
    scenes = [s for s in every if s.is_column and s.is_spatial]
    assert scenes
    for scene in scenes:
        answers = {name: applies(name, scene) for name in names()}
        assert {name for name, answer in answers.items() if answer} <= spatial
        assert all(answer.reason for answer in answers.values() if not answer)
