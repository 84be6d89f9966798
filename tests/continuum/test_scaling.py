"""Mass that small cells lack: bounded, told, and without a force of its own."""

import numpy as np
import pytest

from jointwave.continuum.problem import problem_of
from jointwave.continuum.run import simulate
from jointwave.continuum.scene import body_of
from jointwave.continuum.space.evaluation import blocks_of_nodes
from jointwave.continuum.stepping.scaling import OF_ALL, OF_PIECE, scaled_mass

SHORT = 1e-3  # m, of an edge on top of a block between two joints
WEDGE = [{"dip": dip, "through": [3.0 + np.sign(dip) * SHORT / 2, 4.0]} for dip in (-80.0, 80.0)]
RAYLEIGH = {"rayleigh": {"frequencies": [200.0, 800.0], "ratios": [0.02, 0.02]}}


@pytest.mark.parametrize("damping", [{}, RAYLEIGH])
def test_the_step_of_a_short_edge_is_longer_by_little_mass(rock_mass, damping):
    scene = rock_mass(*WEDGE, continuum={"size": 0.8}, damping=damping)
    found = body_of(scene)
    problem, body, block = problem_of(scene, found), found.body, blocks_of_nodes(found.body)
    scaled = scaled_mass(problem)
    added = scaled.mass - body.mass
    assert added.min() == 0 and scaled.nodes == np.count_nonzero(added) / 2 < 10
    assert scaled.share == pytest.approx(added.sum() / body.mass.sum()) and scaled.share <= OF_ALL
    of_block = np.bincount(block, added[::2]) / np.bincount(block, body.mass[::2])
    assert of_block.max() <= OF_PIECE
    before, after = (
        problem._replace(body=body._replace(mass=mass)).critical_step()
        for mass in (body.mass, scaled.mass)
    )
    assert before <= scaled.before and after > 3 * before


def test_a_regular_mesh_has_its_own_mass(rock_mass):
    scene = rock_mass({"dip": 30.0, "through": [3.0, 2.0]})
    assert scaled_mass(problem_of(scene, body_of(scene))) is None


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_rock_at_rest_under_its_weight_stays_at_rest(rock_mass, caplog, scheme):
    """Added mass has its weight; implicit steps have none."""
    scene = rock_mass(
        *WEDGE,
        continuum={"size": 0.8, "scheme": scheme, "steps_per_period": 50},
        gravity={"direction": [0.0, -1.0]},
        boundaries={"bottom": "fixed", "left": "roller", "right": "roller"},
        time={"duration": 1e-4},
    )
    result = simulate(scene)
    assert ("have more mass" in caplog.text) == (scheme == "explicit")
    assert np.abs(result["velocity"]).max() < 1e-9
