"""The stiffness between rigid blocks against numbers worked out by hand."""

from pathlib import Path

import numpy as np
import pytest

from jointwave.cases.errors import SceneError
from jointwave.cases.material.effective_medium import intact
from jointwave.cases.material.rigid_blocks import rigid_joints
from jointwave.cases.material.rigid_fit import nearest_stiffness
from jointwave.cases.material.rock import ElasticRock
from jointwave.cases.partition.lattice import further_sets
from jointwave.cases.validate import validated

UNIT = ElasticRock(1.0, np.sqrt(3.0), 1.0)  # lambda = mu = 1


def normals(*angles):
    return np.array([[-np.sin(np.radians(a)), np.cos(np.radians(a))] for a in angles])


def scene(*sets, block=None, poisson=0.25, **tables):
    """Return rock with lambda = mu = 20 GPa, and these joint sets."""
    law = {"normal_stiffness": 1e10, "shear_stiffness": 4e9}
    own = {
        "title": "rigid blocks",
        "domain": {"size": [12.0, 10.0]},
        "rock": {"density": 2600.0, "intact_modulus": 5e10, "intact_poisson": poisson},
        "joint_sets": [{"name": str(k), **law, **one} for k, one in enumerate(sets)],
        "numerics": {"dem": {} if block is None else {"block": block}},
        "time": {"duration": 0.01},
        "record": {"points": [[4.0, 2.0]]},
    }
    return validated(own | tables, Path("scene.toml"), frozenset())


def found(own):
    return rigid_joints(own, further_sets(own))


@pytest.mark.parametrize("turned", [0.0, 20.0, 77.0])
def test_orthogonal_sets_have_the_speeds_of_the_rock_along_them(turned):
    """1 / Z_N = lambda + 2 mu = 3 and (Z_T + Z_T) / 2 = 1 / 2 mu, shared; C_12 is left over:
    sqrt(2) of sqrt(2 x 9 + 2 x 1 + 4)."""
    fit = nearest_stiffness(intact(UNIT, 2), normals(turned, turned + 90))
    assert 1 / fit.compliance == pytest.approx(np.array([[3, 2]] * 2), rel=1e-12)
    assert fit.left_over == pytest.approx(np.sqrt(2 / 24), rel=1e-12)


def test_one_set_has_the_confined_modulus_of_the_rock():
    """lambda + 2 mu and mu; what strains along the layers would take is left over: C_11 and C_12
    twice, 9 + 2 of 24."""
    fit = nearest_stiffness(intact(UNIT, 2), normals(40))
    assert 1 / fit.compliance == pytest.approx(np.array([[3, 1]]), rel=1e-12)
    assert fit.left_over == pytest.approx(np.sqrt(11 / 24), rel=1e-12)


@pytest.mark.parametrize("ratio", [0.0, 1.0, 4.0])
def test_three_sets_at_sixty_degrees_are_any_isotropic_rock(ratio):
    """lambda = ratio mu: nothing is left over, but for the root of round-off. Openings alone change
    the area: their compliances add up to 1 / (lambda + mu)."""
    rock = ElasticRock(1.0, np.sqrt(2 + ratio), 1.0)
    fit = nearest_stiffness(intact(rock, 2), normals(10, 70, 130))
    assert fit.left_over < 1e-7
    assert fit.compliance[:, 0].sum() == pytest.approx(1 / (1 + ratio), rel=1e-9)


def test_a_set_without_cuts_is_softened_by_the_rock_between_its_joints():
    """(6) with the confined modulus 60 GPa and the shear modulus 20 GPa: 1/1e10 + 3/6e10 and
    1/4e9 + 3/2e10."""
    own = found(scene({"dip": 20.0, "spacing": 3.0}))
    assert own.normal == pytest.approx([1 / 1.5e-10], rel=1e-12)
    assert own.shear == pytest.approx([1 / 4e-10], rel=1e-12)


def test_a_joint_in_squares_adds_its_compliance_to_that_of_the_cuts():
    """nu = 0, blocks of 0.5 m: cuts of 5e10 / 0.5 = 1e11 Pa/m and, as both directions slip, twice
    2.5e10 / 0.5 in shear."""
    own = found(scene({"dip": 30.0, "through": [6.0, 5.0]}, block=0.5, poisson=0.0))
    assert own.normal[1:] == pytest.approx([1e11, 1e11], rel=1e-12)
    assert own.shear[1:] == pytest.approx([1e11, 1e11], rel=1e-12)
    assert own.normal[0] == pytest.approx(1 / (1e-10 + 1e-11), rel=1e-12)
    assert own.shear[0] == pytest.approx(1 / (2.5e-10 + 1e-11), rel=1e-12)
    assert own.left_over < 1e-7


def test_joints_of_a_lattice_and_its_cuts_are_counted_once():
    """2 m in halves and 3 m in thirds, all of them 1 m apart: cuts of 60 and 2 x 20 GPa/m."""
    own = found(scene({"dip": 0.0, "spacing": 2.0}, {"dip": 90.0, "spacing": 3.0}, block=1.0))
    assert own.normal == pytest.approx([1 / (1e-10 + 1 / 6e10)] * 2 + [6e10] * 2, rel=1e-12)
    assert own.shear == pytest.approx([1 / (2.5e-10 + 1 / 4e10)] * 2 + [4e10] * 2, rel=1e-12)


def test_a_joint_alone_among_sets_is_as_it_is():
    sets = {"dip": 0.0, "spacing": 2.0}, {"dip": 90.0, "spacing": 2.0}
    own = found(scene(*sets, {"dip": 30.0, "through": [6.0, 5.0]}))
    assert own.normal[2] == 1e10 and own.shear[2] == pytest.approx(4e9, rel=1e-15)


@pytest.mark.parametrize(
    ("sets", "why"),
    [([], "has no joints"), ([{"dip": 30.0, "through": [6.0, 5.0]}], "only single joints")],
)
def test_a_domain_that_carries_no_waves_is_refused_in_one_line(sets, why):
    pulse = {"shape": "ricker", "amplitude": 1e6, "period": 0.005}
    waves = {"waves": [pulse | {"kind": "P", "direction": [0.0, 1.0]}]}
    sides = {"boundaries": dict.fromkeys(("left", "right", "bottom", "top"), "quiet")}
    with pytest.raises(SceneError, match=rf"scene\.toml: numerics\.dem\.block: is required.*{why}"):
        found(scene(*sets, **waves, **sides))


def test_joints_alone_carry_what_sends_no_short_wave():
    """Free to fall, or where a load of 1 s makes waves of 2,774 / 1.67 m, ten times and
    more of the domain: nothing of the rock is in the joint, of which rigid blocks lack all."""
    load = {"kind": "pressure", "side": "top", "shape": "ricker", "amplitude": 1e5}
    quick, slow = ([load | {"period": period}] for period in (0.05, 1.0))
    joint = {"dip": 30.0, "through": [6.0, 5.0]}
    for tables in ({}, {"gravity": {"static": False}}, {"loads": slow}):
        own = found(scene(joint, **tables))
        assert own.normal == [1e10] and own.shear == pytest.approx([4e9], rel=1e-15)
        assert own.left_over == 1.0
    with pytest.raises(SceneError, match="only single joints"):
        found(scene(joint, loads=quick))
