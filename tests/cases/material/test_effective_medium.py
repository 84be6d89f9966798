"""Effective media of joint sets: hand-worked numbers, invariance, and long waves through joints."""

import numpy as np
import pytest

from closed_forms.block_lattice import Lattice, modes
from jointwave.cases.material.effective_medium import (
    JointSet,
    christoffel,
    compliance,
    intact,
    speeds,
    stiffness,
    tensor,
)
from jointwave.cases.material.rigid_fit import rigid_fit
from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane.oblique_joint import Joint, scattering
from jointwave.compare.exact.plane.waves import slownesses_across

UNIT = ElasticRock(1.0, np.sqrt(3.0), 1.0)  # lambda = mu = rho = 1


def normal_at(degrees):
    return np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])


def random_sets(dimension, count=3, seed=0):
    """Return sets of any orientation."""
    rng = np.random.default_rng(seed)
    n = rng.normal(size=(count, dimension))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    return [JointSet(x, *rng.uniform(0, 2, 2)) for x in n]


def test_two_orthogonal_sets_in_space():
    """lambda = mu = rho = 1, spacing 1, K_n = 2, K_s = 1: the speeds along x and (1, 1, 0)."""
    sets = [JointSet(n, 0.5, 1.0) for n in np.eye(3)[:2]]
    found, _ = speeds(stiffness(UNIT, sets, 3), 1.0, [[1, 0, 0], [1, 1, 0]])
    assert found[0] == pytest.approx([0.57735, 0.70711, 1.08012], abs=5e-6)
    assert found[1] == pytest.approx([0.70711, 0.70711, 1.0], abs=5e-6)


def test_two_orthogonal_sets_in_plane_strain():
    """S_11 = 3/8 + 1/2, S_12 = -1/8, S_66 = 1 + 2: C_11 = 7/6, C_12 = 1/6, C_66 = 1/3, and the
    speeds along x those of the same sets in space."""
    C = stiffness(UNIT, [JointSet(n, 0.5, 1.0) for n in np.eye(2)])
    expected = np.array([[7 / 6, 1 / 6, 0], [1 / 6, 7 / 6, 0], [0, 0, 1 / 3]])
    np.testing.assert_allclose(C, expected, atol=1e-14)
    found, shapes = speeds(C, 1.0, [1.0, 0.0])
    assert found == pytest.approx(np.sqrt([1 / 3, 7 / 6]), rel=1e-13)
    np.testing.assert_allclose(np.abs(shapes), [[0, 1], [1, 0]], atol=1e-14)


def test_rock_without_joints():
    rock = ElasticRock(2600.0, 5000.0, 2900.0)
    for dimension, directions in (
        (2, np.eye(2)),
        (3, np.random.default_rng(0).normal(size=(9, 3))),
    ):
        found, _ = speeds(stiffness(rock, [], dimension), 2600.0, directions)
        np.testing.assert_allclose(found[:, -1], 5000.0, rtol=1e-12)
        np.testing.assert_allclose(found[:, :-1], 2900.0, rtol=1e-12)


def test_one_set_along_its_normal_is_springs_in_a_row():
    """1/M_eff = 1/M + Z_N, 1/mu_eff = 1/mu + Z_T, in the plane and in space."""
    rock, Z_N, Z_T = ElasticRock(2500.0, 4000.0, 2300.0), 2e-11, 5e-11
    M, mu = 2500 * 4000.0**2, 2500 * 2300.0**2
    for n in (normal_at(33.0), np.array([0.48, 0.6, 0.64])):
        C = stiffness(rock, [JointSet(n, Z_N, Z_T)], len(n))
        found, _ = speeds(C, 2500.0, n)
        assert found[-1] == pytest.approx(np.sqrt(1 / (1 / M + Z_N) / 2500), rel=1e-12)
        expected = np.sqrt(1 / (1 / mu + Z_T) / 2500)
        np.testing.assert_allclose(found[:-1], expected, rtol=1e-12)


def test_rotation_turns_all_waves_with_it():
    """Sets and direction turned together: the same speeds, turned polarisations."""
    for dimension in (2, 3):
        rng = np.random.default_rng(dimension)
        Q = np.linalg.qr(rng.normal(size=(dimension, dimension)))[0]
        sets, n = random_sets(dimension), rng.normal(size=(20, dimension))
        turned = [JointSet(Q @ s.normal, s.normal_compliance, s.shear_compliance) for s in sets]
        one = christoffel(stiffness(UNIT, sets, dimension), n)
        other = christoffel(stiffness(UNIT, turned, dimension), n @ Q.T)
        np.testing.assert_allclose(other, Q @ one @ Q.T, atol=1e-13)


def test_normals_in_the_plane_give_the_plane_of_the_space():
    """Plane strain by two-component normals is the block 11, 22, 12 of the stiffness in space."""
    sets = random_sets(2)
    raised = [JointSet(np.append(s.normal, 0), *list(vars(s).values())[1:]) for s in sets]
    C = stiffness(UNIT, raised, 3)
    np.testing.assert_allclose(C[np.ix_([0, 1, 5], [0, 1, 5])], stiffness(UNIT, sets), atol=1e-13)


@pytest.mark.parametrize("dimension", [2, 3])
def test_energy_is_positive_and_joints_only_soften(dimension):
    """C is positive definite, has the major symmetry, and C0 - C is not negative."""
    for seed in range(20):
        scale = np.ones(3 * dimension - 3)
        scale[dimension:] = np.sqrt(2)
        C = stiffness(UNIT, random_sets(dimension, seed=seed), dimension) * np.outer(scale, scale)
        np.testing.assert_allclose(C, C.T, atol=1e-14)
        assert np.linalg.eigvalsh(C).min() > 0
        assert np.linalg.eigvalsh(intact(UNIT, dimension) - C).min() > -1e-13


def test_jump_and_strain_by_hand():
    """The strain that a set adds is the mean of (n d + d n)/2 / spacing, d = tau/K, of the traction
    of any stress."""
    rng = np.random.default_rng(3)
    for dimension in (2, 3):
        n = rng.normal(size=dimension)
        n /= np.linalg.norm(n)
        sigma = rng.normal(size=(dimension, dimension))
        sigma = sigma + sigma.T
        traction = sigma @ n
        d = 0.7 * (traction @ n) * n + 1.9 * (traction - (traction @ n) * n)
        S = compliance(UNIT, [JointSet(n, 0.7, 1.9)], dimension) - compliance(UNIT, [], dimension)
        root = np.where(np.eye(dimension), 1.0, 1 / np.sqrt(2))
        pairs = {2: ([0, 1, 0], [0, 1, 1]), 3: ([0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1])}[dimension]
        expected = (np.outer(n, d) + np.outer(d, n)) / 2
        np.testing.assert_allclose(S @ (sigma / root)[pairs], (expected / root)[pairs], atol=1e-13)


@pytest.mark.parametrize("kind, degrees", [("P", 0.0), ("P", 40.0), ("SV", 30.0), ("SV", 55.0)])
def test_long_waves_through_joints_travel_at_its_speeds(kind, degrees):
    """Bloch waves through periods of joint and rock, at 1/500 of a wavelength: their slownesses
    satisfy Christoffel's equation to the square of k d."""
    rock, joint, d = ElasticRock(2600.0, 5000.0, 2900.0), Joint(4e10, 1.5e10), 1.0
    speed = rock.p_speed if kind == "P" else rock.s_speed
    omega, p = 2 * np.pi * speed / 500, np.sin(np.radians(degrees)) / speed
    R, T = scattering(rock, joint, p, omega)
    E = np.diag(np.exp(1j * omega * d * slownesses_across(rock, p)))
    # Forth a and back b in front of the joint, and a period later: a' = E (T a + R E b') and
    # b = R a + T E b'.
    later = np.block([[np.eye(2), -E @ R @ E], [np.zeros((2, 2)), T @ E]])
    now = np.block([[E @ T, np.zeros((2, 2))], [-R, np.eye(2)]])
    q = np.log(np.linalg.eigvals(np.linalg.solve(later, now))) / (1j * omega * d)
    n = np.array([0.0, 1.0])
    C = tensor(stiffness(rock, [JointSet(n, 1 / (d * 4e10), 1 / (d * 1.5e10))]))
    for one in q:
        s = np.array([p, one])
        gamma = np.einsum("ijkl,j,l->ik", C, s, s) / 2600.0
        assert abs(np.linalg.det(gamma - np.eye(2))) < (2 * np.pi / 500) ** 2


def test_rigid_blocks_of_two_orthogonal_sets_by_hand():
    """Plane strain, lambda = mu = 1: S_11 = 3/8, S_12 = -1/8, 2 S_1212 = 1/2. Z_N = 3/8 each,
    (Z_T + Z_T)/2 = 1/2 shared equally, and S_12 is left over: sqrt(2)/8 of 6/8."""
    fit = rigid_fit(compliance(UNIT, []), np.eye(2))
    assert fit.compliance[:, 0] == pytest.approx(3 / 8, rel=1e-12)
    assert fit.compliance[:, 1] == pytest.approx(1 / 2, rel=1e-9)
    assert fit.left_over == pytest.approx(np.sqrt(2) / 6, rel=1e-12)


def test_rigid_blocks_fit_joints_that_are_all_the_compliance():
    """Rock stiffer than its joints by far: the sets themselves, and nothing left over."""
    stiff = ElasticRock(2600.0, 5e9, 3e9)
    sets = [JointSet(normal_at(a), *z) for a, z in ((0, (2, 3)), (50, (1, 4)), (110, (0.5, 2)))]
    scaled = [
        JointSet(s.normal, s.normal_compliance / 1e10, s.shear_compliance / 1e10) for s in sets
    ]
    S = compliance(stiff, scaled)
    fit = rigid_fit(S, np.array([s.normal for s in sets]))
    assert fit.left_over < 1e-6
    found = [JointSet(s.normal, *z) for s, z in zip(sets, fit.compliance, strict=True)]
    added = sum(compliance(stiff, [s]) - compliance(stiff, []) for s in found)
    np.testing.assert_allclose(added, S, atol=1e-6 * np.abs(S).max())


def test_one_set_of_rigid_blocks_lacks_most():
    """One set in isotropic rock has S_22 and S_12 of 3/8, -1/8 left over: sqrt(11)/8 of 6/8."""
    fit = rigid_fit(compliance(UNIT, []), np.eye(2)[:1])
    assert fit.left_over == pytest.approx(np.sqrt(11) / 6, rel=1e-12)


def test_three_sets_at_sixty_degrees_have_a_poisson_effect():
    """Sets at 0, 60 and 120 degrees are isotropic with S_12 = 3/8 (Z_N - Z_T), so that they are all
    of rock with nu = 0.25."""
    fit = rigid_fit(compliance(UNIT, []), np.array([normal_at(a) for a in (0, 60, 120)]))
    assert fit.left_over < 1e-12
    assert 3 / 8 * np.subtract(*fit.compliance.T) == pytest.approx(-1 / 8)


def test_the_lattice_of_the_fit_has_the_speeds_of_the_rock():
    """Blocks of the fitted joints: along x, c_p^2 = 1/(Z_N rho) and c_s^2 = mu / rho, as blocks
    that turn make both sets shear."""
    fit = rigid_fit(compliance(UNIT, []), np.eye(2))
    k_n, k_s = 1 / fit.compliance[0]
    omega, _ = modes(Lattice(1.0, 1.0, 1 / 6, k_n, k_s, k_n / 12), [1e-3, 0.0])
    assert omega[:2] / 1e-3 == pytest.approx([1.0, np.sqrt(8 / 3)], rel=1e-6)


def test_a_medium_without_real_waves_is_refused():
    with pytest.raises(ValueError, match="no real waves"):
        speeds(-np.eye(3), 1.0, [1.0, 0.0])
