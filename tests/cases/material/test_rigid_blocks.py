"""The stiffness between rigid blocks by hand, and the critical step that follows from it."""

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st
from scipy.linalg import block_diag, eigh

from closed_forms.block_lattice import Lattice, modes
from jointwave.cases.errors import SceneError
from jointwave.cases.material.effective_medium import JointSet, added, intact, nearest_stiffness
from jointwave.cases.material.rigid_blocks import rigid_joints
from jointwave.cases.material.rock import ElasticRock
from jointwave.cases.partition.lattice import further_sets
from jointwave.dem.prepare import blocks_of
from tests.cases.material.block_stiffness import stiffness

UNIT = ElasticRock(1.0, np.sqrt(3.0), 1.0)  # lambda = mu = 1


def normals(*angles):
    return np.array([[-np.sin(np.radians(a)), np.cos(np.radians(a))] for a in angles])


def found(own):
    return rigid_joints(own, further_sets(own))


@pytest.mark.parametrize("turned", [0.0, 20.0, 77.0])
def test_orthogonal_sets_have_the_speeds_of_the_rock_along_them(turned):
    """1 / Z_N = lambda + 2 mu = 3 and (Z_T + Z_T) / 2 = 1 / 2 mu, shared; C_12 is left over:
    sqrt(2) of sqrt(2 x 9 + 2 x 1 + 4). Waves in the lattice of such blocks, which turn, have them.
    """
    fit = nearest_stiffness(intact(UNIT, 2), normals(turned, turned + 90))
    assert 1 / fit.compliance == pytest.approx(np.array([[3, 2]] * 2), rel=1e-12)
    assert fit.left_over == pytest.approx(np.sqrt(2 / 24), rel=1e-12)
    omega, _ = modes(Lattice(1.0, 1.0, 1 / 6, 3.0, 2.0, 3.0 / 12), [1e-3, 0.0])
    assert omega[:2] / 1e-3 == pytest.approx([1.0, np.sqrt(3)], rel=1e-6)


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


def test_joints_that_are_all_the_compliance_are_found_again():
    def of_joints(each):
        sets = [JointSet(n, *z) for n, z in zip(normals(0, 50, 110), each, strict=True)]
        return sum(map(added, sets))

    S = of_joints([(2, 3), (1, 4), (0.5, 2)])
    fit = nearest_stiffness(np.linalg.inv(S), normals(0, 50, 110))
    assert fit.left_over < 1e-6
    np.testing.assert_allclose(of_joints(fit.compliance), S, atol=1e-6 * np.abs(S).max())


def test_a_set_without_cuts_is_softened_by_the_rock_between_its_joints(rock_with):
    """(6), confined modulus 60 GPa and shear modulus 20 GPa: 1/1e10 + 3/6e10, 1/4e9 + 3/2e10."""
    own = found(rock_with({"dip": 20.0, "spacing": 3.0}))
    assert own.normal == pytest.approx([1 / 1.5e-10], rel=1e-12)
    assert own.shear == pytest.approx([1 / 4e-10], rel=1e-12)


def in_blocks(size):
    return {"numerics": {"dem": {"block": size}}}


def test_a_joint_in_squares_adds_its_compliance_to_that_of_the_cuts(rock_with):
    """nu = 0, blocks of 0.5 m: cuts of 5e10 / 0.5 = 1e11 Pa/m and, as both directions slip, twice
    2.5e10 / 0.5 in shear."""
    joint = {"dip": 30.0, "through": [6.0, 5.0]}
    own = found(rock_with(joint, poisson=0.0, **in_blocks(0.5)))
    assert own.normal[1:] == pytest.approx([1e11, 1e11], rel=1e-12)
    assert own.shear[1:] == pytest.approx([1e11, 1e11], rel=1e-12)
    assert own.normal[0] == pytest.approx(1 / (1e-10 + 1e-11), rel=1e-12)
    assert own.shear[0] == pytest.approx(1 / (2.5e-10 + 1e-11), rel=1e-12)
    assert own.left_over < 1e-7


def test_joints_of_a_lattice_and_its_cuts_are_counted_once(rock_with):
    """2 m in halves and 3 m in thirds, all of them 1 m apart: cuts of 60 and 2 x 20 GPa/m."""
    sets = {"dip": 0.0, "spacing": 2.0}, {"dip": 90.0, "spacing": 3.0}
    own = found(rock_with(*sets, **in_blocks(1.0)))
    assert own.normal == pytest.approx([1 / (1e-10 + 1 / 6e10)] * 2 + [6e10] * 2, rel=1e-12)
    assert own.shear == pytest.approx([1 / (2.5e-10 + 1 / 4e10)] * 2 + [4e10] * 2, rel=1e-12)


#: Sets in the plane and in space, as dip and dip direction, and a slab that one joint halves.
RIGID = {
    "10 degrees apart": ([(0.0, None), (10.0, None)], {"spacing": 4.0}, [12.0, 10.0]),
    "three in space": ([(30.0, 120.0), (70.0, 210.0), (60.0, 160.0)], {"spacing": 4.0}, [9.0] * 3),
    "thin slab": ([(0.0, 0.0)], {"through": [4.0, 5.0, 2.0]}, [8.0, 10.0, 4.0]),
}


@pytest.mark.parametrize("name", RIGID)
def test_cuts_give_way_where_the_nearest_stiffness_is_rigid(rock_with, name):
    """As 1/20 of confined rock, 60 GPa, and the least block then bounds the step: waves of
    sqrt(20) times its 4804 m/s take some four of them through blocks of 0.3 m."""
    attitudes, where, size = RIGID[name]
    sets = [{"dip": dip, "dip_direction": way} | where for dip, way in attitudes]
    sets = [{key: one for key, one in each.items() if one is not None} for each in sets]
    scene = rock_with(*sets, domain={"size": size}, **in_blocks(2.0))
    spacings = np.array([one.spacing for one in further_sets(scene)])
    assert (found(scene).normal[len(sets) :] * spacings).max() == pytest.approx(20 * 6e10)
    assert blocks_of(scene).critical > 0.3 / (20**0.5 * 4804) / 4


def test_a_joint_alone_among_sets_is_as_it_is(rock_with):
    sets = {"dip": 0.0, "spacing": 2.0}, {"dip": 90.0, "spacing": 2.0}
    own = found(rock_with(*sets, {"dip": 30.0, "through": [6.0, 5.0]}))
    assert own.normal[2] == 1e10 and own.shear[2] == pytest.approx(4e9, rel=1e-15)


@pytest.mark.parametrize(
    ("sets", "why"),
    [([], "has no joints"), ([{"dip": 30.0, "through": [6.0, 5.0]}], "only single joints")],
)
def test_a_domain_that_carries_no_waves_is_refused_in_one_line(rock_with, sets, why):
    pulse = {"shape": "ricker", "amplitude": 1e6, "period": 0.005}
    waves = {"waves": [pulse | {"kind": "P", "direction": [0.0, 1.0]}]}
    sides = {"boundaries": dict.fromkeys(("left", "right", "bottom", "top"), "quiet")}
    with pytest.raises(SceneError, match=rf"scene\.toml: numerics\.dem\.block: is required.*{why}"):
        found(rock_with(*sets, **waves, **sides))


def test_joints_alone_carry_what_sends_no_short_wave(rock_with):
    """Free to fall, or where a load of 1 s makes waves of 2,774 / 1.67 m, ten times and
    more of the domain: nothing of the rock is in the joint, of which rigid blocks lack all."""
    load = {"kind": "pressure", "side": "top", "shape": "ricker", "amplitude": 1e5}
    quick, slow = ([load | {"period": period}] for period in (0.05, 1.0))
    joint = {"dip": 30.0, "through": [6.0, 5.0]}
    for tables in ({}, {"gravity": {"static": False}}, {"loads": slow}):
        own = found(rock_with(joint, **tables))
        assert own.normal == [1e10] and own.shear == pytest.approx([4e9], rel=1e-15)
        assert own.left_over == 1.0
    with pytest.raises(SceneError, match="only single joints"):
        found(rock_with(joint, loads=quick))


@st.composite
def crossing(draw):
    """Two sets of joints, of which the second may end at the first."""
    dips, spacings = (st.floats(5, 80), st.floats(-80, -5)), st.floats(1.0, 2.0)
    sets = [{"dip": draw(dip), "spacing": draw(spacings)} for dip in dips]
    if draw(st.booleans()):
        sets[1] |= {"ends_at": ["0"], "offset": 0.5}
    return [one | {"shear_stiffness": draw(st.floats(1e9, 2e10))} for one in sets]


@given(sets=crossing())
@settings(max_examples=25)
def test_critical_step_of_blocks_is_bounded_on_both_sides(rock_with, sets):
    """Against scipy's eigenvalues of the whole system: bound <= 2 / omega <= sqrt(2) bound; three
    rigid motions of all blocks cost nothing."""
    domain = {"size": [4.0, 3.0], "least_width": 1e-3, "least_angle": 0.0}
    scene = rock_with(*sets, domain=domain)
    try:
        blocks = blocks_of(scene)
    except SceneError:  # joints that end at others may all miss so small a domain
        reject()
    squared = eigh(stiffness(blocks), block_diag(*blocks.masses), eigvals_only=True)
    exact = 2 / np.sqrt(squared[-1])
    assert blocks.critical <= exact * (1 + 1e-9) and exact <= 2**0.5 * blocks.critical * (1 + 1e-9)
    assert (squared[:3] < 1e-6 * squared[-1]).all()


@pytest.mark.parametrize("count", [1, 2])
def test_critical_step_of_a_square_lattice(rock_with, count):
    """Squares of side 1 m held by their neighbours have omega^2 = 2 (k_n + k_s) / m, and
    (k_s + 4 k_b) / (m / 6) in rotation, k_b = k_n / 12 of two points and 0 of one; twice the larger
    bounds it. With one point translation is the faster, and the bound is exact, at x = y = pi."""
    points = {"spacing": 1.0, "point_rule": "gauss", "contact_points": count}
    sides = dict.fromkeys(("left", "right", "bottom", "top"), "periodic")
    scene = rock_with({"dip": 0.0, **points}, {"dip": 90.0, **points}, boundaries=sides)
    (k_n, *_), (k_s, *_), k_b = *found(scene)[:2], (count - 1) * found(scene).normal[0] / 12
    held = 2 * (k_n + k_s) / 2600, (k_s + 4 * k_b) * 6 / 2600
    assert blocks_of(scene).critical == pytest.approx(2 / np.sqrt(2 * max(held)), rel=1e-12)
    if count == 1:
        omega, _ = modes(Lattice(1.0, 2600.0, 2600.0 / 6, k_n, k_s, 0.0), [np.pi, np.pi])
        assert blocks_of(scene).critical == pytest.approx(2 / omega.max(), rel=1e-12)
