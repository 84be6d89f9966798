"""What acts on a rock mass, and the state that it starts from."""

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.continuum.plan import plan_of
from jointwave.continuum.problem import at_rest
from jointwave.continuum.run import simulate
from jointwave.results.dataset import energy_residual
from tests.turned import turned

HOLE = [[2.0, 2.5], [4.0, 2.5], [4.0, 4.0], [2.0, 4.0]]
EXCAVATED = {
    "domain": {"size": [6.0, 6.0], "openings": [HOLE], "non_convex": "cut"},
    "prestress": {"xx": 4e6, "yy": 6e6, "xy": 5e5},
    "boundaries": dict.fromkeys(("left", "right", "bottom", "top"), "quiet"),
    "record": {"points": [[0.7, 3.2], [3.3, 5.1]], "joints": [[1.0, 2.0]]},
}


def excavated(rock_mass, **changes):
    """Return a tunnel under stress in two sets that slip."""
    sets = [{"dip": 20.0, "spacing": 2.0, "through": [3.0, 2.0]}]
    sets += [{"dip": -70.0, "spacing": 3.0, "through": [3.0, 3.0]}]
    return rock_mass(*(one | {"friction_angle": 25.0} for one in sets), **(EXCAVATED | changes))


def test_a_prestress_is_in_equilibrium_where_joints_hold_it(rock_mass):
    # Along the normal (-sin, cos) of 30 degrees of dip and its left: t = P n.
    scene = rock_mass(
        {"dip": 30.0, "through": [3.0, 3.0], "friction_angle": 35.0},
        domain={"size": [6.0, 6.0]},
        prestress={"xx": 4e6, "yy": 6e6, "xy": 5e5},
        record={"points": [[2.0, 1.5]], "joints": [[3.0, 3.0]]},
    )
    P, n, s = np.array([[4e6, 5e5], [5e5, 6e6]]), [-0.5, np.sqrt(0.75)], [-np.sqrt(0.75), -0.5]
    found = simulate(scene)
    assert np.abs(found.velocity).max() < 1e-13  # under 6 MPa rock moves at up to 0.5 m/s
    assert np.abs(found.stress[0] - [4e6, 6e6, 5e5]).max() < 1e-6
    assert np.abs(found.traction[0] - [P @ n @ n, P @ n @ s]).max() < 1e-6


def test_joints_give_way_to_a_prestress_between_fixed_sides_without_weight(rock_mass):
    """No force acts but what the joint cannot carry: a stress of 1 MPa that pulls is gone, and of
    shear what friction carries of the pressure is left."""
    held = dict.fromkeys(("left", "right", "bottom", "top"), "fixed")
    tables = {"gravity": {"acceleration": 0.0}, "boundaries": held, "domain": {"size": [6.0, 6.0]}}
    tables["record"] = {"joints": [[3.0, 3.0]]}
    bed = {"dip": 0.0, "through": [3.0, 3.0]}
    pulled = rock_mass(bed | {"tension": False}, prestress={"xx": 0.0, "yy": -1e6}, **tables)
    assert np.abs(simulate(pulled).traction).max() < 1e-3
    shear = {"xx": 1e6, "yy": 1e6, "xy": 9e5}
    left = simulate(rock_mass(bed | {"friction_angle": 30.0}, prestress=shear, **tables)).traction
    assert np.abs(left[0, -1]).values == pytest.approx([1e6, 1e6 / np.sqrt(3)], rel=1e-6)


def test_rock_whose_every_node_is_held_is_refused(rock_mass):
    held = dict.fromkeys(("left", "right", "bottom", "top"), "fixed")
    own = {"domain": {"size": [4.0, 4.0]}, "continuum": {"size": 4.0, "order": 1}}
    with pytest.raises(SceneError, match="boundaries: hold every node of the mesh"):
        simulate(rock_mass(boundaries=held, **own))


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_nothing_moves_after_an_excavation(scheme, rock_mass):
    """Forces that are left, 1e-10 of the largest, move a node by at most themselves over its mass
    times the time; joints have slipped by then."""
    scene = excavated(rock_mass, continuum={"scheme": scheme})
    problem = plan_of(scene).problem
    force = problem.steady.reshape(-1, 2)
    assert np.abs(force.sum(axis=0)).max() < 1e-13 * np.abs(force).sum()
    moment = problem.body.x[:, 0] * force[:, 1] - problem.body.x[:, 1] * force[:, 0]
    assert abs(moment.sum()) < 1e-13 * np.abs(moment).sum()
    found = simulate(scene)
    most = 1e-10 * np.abs(force).max() / problem.body.mass.min() * 2e-3
    assert np.abs(found.velocity).max() < most
    assert np.abs(found.stress[:, 0] - [4e6, 6e6, 5e5]).max() > 1e5
    assert "gravity" not in found.term


def test_a_turned_excavation_is_the_same(rock_mass):
    """To 1e-11, of gap, slip and tractions where joints slip around it."""
    square = [[2.0, 2.0], [4.0, 2.0], [4.0, 4.0], [2.0, 4.0]]
    tables = {"domain": {"size": [6.0, 6.0], "openings": [square]}}
    tables["prestress"] = {"xx": 5e6, "yy": 5.6e6, "xy": 0.0}

    def scene(**law):
        law |= {"spacing": 2.0, "through": [0.0, 0.0]}
        return rock_mass(*({"dip": dip} | law for dip in (0.0, 90.0)), **EXCAVATED | tables)

    def found(scene):
        problem = plan_of(scene).problem
        u = at_rest(scene, problem)[1].u
        jump = problem.readings.jump @ problem.body.joints.jumps(u).ravel()
        return jump, simulate(scene).traction.values[0, 0]

    slips, turn = scene(friction_angle=21.0), np.array([[0.8, -0.6], [0.6, 0.8]])
    one, other, elastic = map(found, (slips, turned(slips, turn), scene()))
    for a, b in zip(one, other, strict=True):
        assert np.abs(a - b).max() < 1e-11 * np.abs(a).max()
    assert np.abs(elastic[0] - one[0]).max() > 1e-3 * np.abs(one[0]).max()


def test_gravity_that_acts_later_is_no_part_of_the_excavation(rock_mass):
    """Rock that nothing holds falls freely from the state that the excavation leaves."""
    free = dict.fromkeys(("left", "right", "bottom", "top"), "free")
    found = simulate(excavated(rock_mass, gravity={"static": False}, boundaries=free))
    fall = -9.81 * found.time.values
    assert np.abs(found.velocity.values[..., 1] - fall).max() < 1e-6 * np.abs(fall).max()
    assert np.abs(found.stress - found.stress[:, :1]).max() < 1e-6 * 6e6


@pytest.mark.parametrize("scheme", ["explicit", "implicit"])
def test_a_shaken_side_moves_by_the_sum_of_its_bases(rock_mass, scheme):
    base = {"kind": "base", "side": "bottom", "direction": [0.6, 0.8], "quantity": "velocity"}
    pulse = {"shape": "sine", "amplitude": 0.1, "period": 1e-3}
    scene = rock_mass(
        loads=[base | pulse, base | pulse | {"direction": [1.0, 0.0], "amplitude": 0.05}],
        boundaries={"bottom": "fixed"},
        record={"points": [[2.0, 0.0]], "interval": 1e-5},
        continuum={"scheme": scheme, "spectral_radius": 1.0},
    )  # fmt: skip
    found = simulate(scene)
    moved = 0.1 * 1e-3 / (2 * np.pi) * (1 - np.cos(2 * np.pi * np.minimum(found.time, 1e-3) / 1e-3))
    exact = moved.values[:, None] * [1.1, 0.8]
    assert np.abs(found.displacement[0] - exact).max() < 1e-12
    assert energy_residual(found) < 1e-11
