"""Deformable rock of several regions: waves in layers, their sides and their effective medium."""

import numpy as np
import pytest

from jointwave.compare.engines import solve
from jointwave.compare.exact.rock_mass.field import field_of
from jointwave.compare.misfit.metrics import relative_l2
from jointwave.continuum import simulate

SOFT = {"name": "soft", "dip": 20.0, "through": [10.0, 9.0], "density": 2200.0}
HARD = {"name": "hard", "dip": 20.0, "through": [10.0, 14.0], "intact_modulus": 8e10}


@pytest.mark.parametrize("kind", ["P", "S"])
def test_a_pulse_in_layers_is_the_exact_one(struck, kind):
    """Three rocks that dip by 20 degrees with a joint in the middle one: sides, receivers in each
    rock and on the joint, at 14 elements of order 2 a wavelength of the slowest wave."""
    scene = struck(
        kind,
        dip=20.0,
        regions=[SOFT | {"intact_modulus": 3e10}, HARD],
        record={"points": [[10.0, 4.0], [12.0, 13.0], [9.0, 17.0]], "joints": [[10.0, 10.0]]},
        continuum={"size": 0.8},
    )
    found, exact = simulate(scene, incident=field_of(scene)), solve("parallel-joints", scene)
    for name in ("velocity", "displacement", "stress", "traction", "gap", "slip"):
        assert relative_l2(found[name].values, exact[name].values) < 3e-3
    energy = found.energy.values
    assert np.abs(energy[:-1].sum(axis=0) - energy[-1]).max() < 1e-11 * np.abs(energy).max()


@pytest.mark.parametrize("model", ["jointed", "equivalent"])
def test_a_column_of_two_rocks_is_pressed_as_both_in_series(rock_mass, model):
    """2 m by 6 m without a Poisson effect, at rest under 1 MPa: sigma h / E of each rock and four
    joints in the upper one, of which the lowest lies along the boundary, or their medium."""
    scene = rock_mass(
        {"dip": 0.0, "spacing": 0.5, "regions": ["upper"]},
        domain={"size": [2.0, 6.0]},
        rock={"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": 0.0},
        regions=[{"name": "upper", "through": [0.0, 4.0], "intact_modulus": 2e10}],
        boundaries={"bottom": "fixed"},
        loads=[{"kind": "pressure", "side": "top", "shape": "step", "amplitude": 1e6}],
        damping={"mass_proportional": 500.0},
        continuum={"order": 2},
        time={"duration": 0.05},
        record={"points": [[1.0, 2.0], [1.0, 6.0]]},
    )
    moved = -simulate(scene, model).displacement.values[:, -1, 1]
    assert moved[0] == pytest.approx(1e6 * 2 / 5e10, rel=1e-4)
    assert moved[1] == pytest.approx(1e6 * (4 / 5e10 + 2 / 2e10 + 4 / 2e10), rel=1e-4)


def test_an_outline_of_the_same_rock_changes_nothing(struck):
    """A pentagon in rock that a P wave passes: the waves of one rock, in another mesh."""
    corners = [[6.0, 8.0], [12.0, 7.0], [15.0, 11.0], [11.0, 15.0], [7.0, 13.0]]
    tables = {
        "joints": [],
        "domain": {"size": [20.0, 20.0], "non_convex": "cut"},
        "record": {"points": [[10.0, 10.0], [10.0, 17.0]]},
    }
    plain = struck(**tables)
    lens = struck(**tables, regions=[{"name": "lens", "outline": corners, "density": 2600.0}])
    soft = struck(**tables, regions=[{"name": "lens", "outline": corners, "intact_modulus": 1e10}])
    one, other, third = (simulate(x, incident=field_of(x)) for x in (plain, lens, soft))
    exact = field_of(plain)(np.array(plain.record.points), one.time.values).velocity
    for found in (one, other):
        assert relative_l2(found.velocity.values.swapaxes(1, 2), exact) < 5e-3
    assert relative_l2(third.velocity.values, one.velocity.values) > 0.3
    energy = third.energy.values
    assert np.abs(energy[:-1].sum(axis=0) - energy[-1]).max() < 1e-11 * np.abs(energy).max()
