"""Effective media of joint sets: hand-worked numbers, invariance, and long waves through joints."""

from dataclasses import replace

import numpy as np
import pytest

from jointwave.cases.material.effective_medium import (
    JointSet,
    added,
    christoffel,
    speeds,
    stiffness,
    tensor,
)
from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane.oblique_joint import Joint, scattering
from jointwave.compare.exact.plane.waves import slownesses_across

UNIT = ElasticRock(1.0, np.sqrt(3.0), 1.0)  # lambda = mu = rho = 1


def random_sets(dimension, count=3, seed=0):
    """Return sets of any orientation."""
    rng = np.random.default_rng(seed)
    n = rng.normal(size=(count, dimension))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    return [JointSet(x, *rng.uniform(0, 2, 2)) for x in n]


def test_two_orthogonal_sets_in_plane_strain():
    """S_11 = 3/8 + 1/2, S_12 = -1/8, S_66 = 1 + 2: C_11 = 7/6, C_12 = 1/6, C_66 = 1/3, and the
    speeds along x those of the same sets in space."""
    C = stiffness(UNIT, [JointSet(n, 0.5, 1.0) for n in np.eye(2)])
    expected = np.array([[7 / 6, 1 / 6, 0], [1 / 6, 7 / 6, 0], [0, 0, 1 / 3]])
    np.testing.assert_allclose(C, expected, atol=1e-14)
    found, shapes = speeds(C, 1.0, [1.0, 0.0])
    assert found == pytest.approx(np.sqrt([1 / 3, 7 / 6]), rel=1e-13)
    np.testing.assert_allclose(np.abs(shapes), [[0, 1], [1, 0]], atol=1e-14)


@pytest.mark.parametrize("compliances", [(0.0, 0.0), (2e-11, 5e-11)], ids=["none", "one set"])
@pytest.mark.parametrize("n", [[0.6, 0.8], [0.48, 0.6, 0.64]], ids=["plane", "space"])
def test_one_set_along_its_normal_is_springs_in_a_row(n, compliances):
    """1/M_eff = 1/M + Z_N, 1/mu_eff = 1/mu + Z_T: without compliance the rock's own speeds."""
    rock, moduli = ElasticRock(2500.0, 4000.0, 2300.0), 2500 * np.array([4000.0**2, 2300.0**2])
    C = stiffness(rock, [JointSet(np.array(n), *compliances)], len(n))
    found, _ = speeds(C, 2500.0, n)
    p, s = np.sqrt(1 / (1 / moduli + compliances) / 2500)
    np.testing.assert_allclose(found, [*[s] * (len(n) - 1), p], rtol=1e-12)


def test_rotation_turns_all_waves_with_it():
    """Sets and direction turned together: the same speeds, turned polarisations."""
    for dimension in (2, 3):
        rng = np.random.default_rng(dimension)
        Q = np.linalg.qr(rng.normal(size=(dimension, dimension)))[0]
        sets, n = random_sets(dimension), rng.normal(size=(20, dimension))
        turned = [replace(one, normal=Q @ one.normal) for one in sets]
        one = christoffel(stiffness(UNIT, sets, dimension), n)
        other = christoffel(stiffness(UNIT, turned, dimension), n @ Q.T)
        np.testing.assert_allclose(other, Q @ one @ Q.T, atol=1e-13)


def test_normals_in_the_plane_give_the_plane_of_the_space():
    """Plane strain by two-component normals is the block 11, 22, 12 of the stiffness in space."""
    sets = random_sets(2)
    raised = [replace(one, normal=np.append(one.normal, 0)) for one in sets]
    C = stiffness(UNIT, raised, 3)
    np.testing.assert_allclose(C[np.ix_([0, 1, 5], [0, 1, 5])], stiffness(UNIT, sets), atol=1e-13)


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
        S = added(JointSet(n, 0.7, 1.9))
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


def test_a_medium_without_real_waves_is_refused():
    with pytest.raises(ValueError, match="no real waves"):
        speeds(-np.eye(3), 1.0, [1.0, 0.0])
