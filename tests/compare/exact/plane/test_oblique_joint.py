"""P and SV at one linear-slip joint: coefficients of harmonic waves."""

import numpy as np
import pytest

from closed_forms import one_joint
from closed_forms.oblique_joint import coefficients, energy_flux
from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane.oblique_joint import Joint, scattering
from jointwave.compare.exact.plane.waves import cosines, slowness_along

OMEGA = 2 * np.pi * 100.0
KINDS = pytest.mark.parametrize("kind", ["P", "SV"])
#: theta, degrees, and the moduli of R_p, R_s, T_p, T_s at K_n = Z_p omega, K_s = Z_s omega.
TABLE = [
    (0, 0.4472, 0, 0.8944, 0),
    (30, 0.2836, 0.4144, 0.8999, 0.0188),
    (45, 0.1560, 0.4410, 0.9103, 0.0515),
    (60, 0.0908, 0.3609, 0.9237, 0.0908),
]


def random_media(seed, count=300):
    """Return rocks, joints, angles and omega as arrays, over all that is allowed."""
    rng = np.random.default_rng(seed)
    b = rng.uniform(500, 4000, count)
    rock = ElasticRock(rng.uniform(1500, 3500, count), b * rng.uniform(1.05, 6, count), b)
    scale = np.array([rock.p_impedance, rock.s_impedance]) * OMEGA
    K = scale * 10 ** rng.uniform(-3, 3, (2, count))
    eta = scale / OMEGA * rng.uniform(0, 2, (2, count))
    angle = rng.uniform(-np.pi / 2, np.pi / 2, count)
    return rock, K, eta, angle, OMEGA * 10 ** rng.uniform(-1, 1, count)


@pytest.mark.parametrize("theta, R_p, R_s, T_p, T_s", TABLE)
def test_table_of_four_angles(rock, joint, theta, R_p, R_s, T_p, T_s):
    """nu = 0.25, P incident, to the four digits of two independent programs."""
    found = coefficients("P", np.radians(theta), OMEGA, rock, joint)
    assert np.abs(found) == pytest.approx([R_p, R_s, T_p, T_s], abs=5.1e-5)


@KINDS
@pytest.mark.parametrize("damped", [False, True])
def test_the_boundary_conditions_agree(referee, kind, damped):
    """Four equations for four amplitudes at random angles, rocks and joints, by numpy: round-off
    over the condition of that system, which grows towards grazing incidence."""
    rock, K, eta, angle, omega = random_media(1)
    eta = eta * damped
    found = np.array(coefficients(kind, angle, omega, rock, Joint(*K, *eta)))
    slowness = slowness_along(rock, kind, angle)
    for i in range(len(angle)):
        each = (rock.density[i], rock.p_speed[i], rock.s_speed[i])
        system = referee(each, [(*K[:, i], *eta[:, i])], [])
        expected = system.solve(kind, slowness[i], omega[i])
        np.testing.assert_allclose(found[:, i], expected, rtol=0, atol=2e-11)


@pytest.mark.parametrize("degrees", [0, 20, 45, 80])
def test_sh_in_closed_form(degrees):
    """T = 1 / (1 - i x), x = omega Z_s cos(phi) / 2 K_s, R = 1 - T: |T| = 1 / sqrt(1 + x^2)."""
    rock, phi = ElasticRock(2600.0, 5000.0, 2900.0), np.radians(degrees)
    omega, K, eta = np.array([10.0, 500.0, 4e3]), 3e9, 2e6
    for law in (K, K - 1j * omega * eta):
        found = coefficients("SH", phi, omega, rock, Joint(1e9, K, 1e5, eta if law is not K else 0))
        x = omega * rock.s_impedance * np.cos(phi) / (2 * law)
        np.testing.assert_allclose(found[1], 1 / (1 - 1j * x), rtol=1e-13)
        np.testing.assert_allclose(found[0], 1 - found[1], rtol=0, atol=1e-13)
        if law is K:
            np.testing.assert_allclose(np.abs(found[1]), (1 + x**2) ** -0.5, rtol=1e-13)
            np.testing.assert_allclose((np.abs(found) ** 2).sum(axis=0), 1.0, rtol=1e-13)


@KINDS
def test_energy_flux_sums_to_one(kind):
    """At round-off, evanescent P waves included; a dashpot takes a part."""
    rock, K, eta, angle, omega = random_media(2, 2000)
    found = coefficients(kind, angle, omega, rock, Joint(*K))
    flux = energy_flux(kind, angle, rock, found)
    assert np.abs(flux.sum(axis=0) - 1).max() < 1e-11
    if kind == "SV":
        evanescent = np.abs(np.sin(angle)) * rock.p_speed > rock.s_speed
        assert evanescent.sum() > 500 and not flux[[0, 2]][:, evanescent].any()
    damped = coefficients(kind, angle, omega, rock, Joint(*K, *(eta + 1)))
    assert (energy_flux(kind, angle, rock, damped).sum(axis=0) < 1).all()


@KINDS
@pytest.mark.parametrize("viscosity", [0.0, 2e6])
def test_normal_incidence_is_the_bar_of_one_joint(kind, viscosity):
    """R and T of velocity; that solution has those of stress and e^{+i omega t}."""
    rock, K, omega = ElasticRock(2600.0, 5000.0, 2900.0), 3e9, np.array([10.0, 500.0, 4e3])
    Z = rock.p_impedance if kind == "P" else rock.s_impedance
    found = coefficients(kind, 0.0, omega, rock, Joint(K, K, viscosity, viscosity))
    T, R = one_joint.coefficients(omega, K, Z, viscosity)
    own = (0, 2) if kind == "P" else (1, 3)
    other = (1, 3) if kind == "P" else (0, 2)
    # An SV wave and its mirror image move alike along t: R of velocity has stress's sign turned.
    sign = 1 if kind == "P" else -1
    np.testing.assert_allclose(found[own[0]], sign * R.conj(), rtol=1e-13)
    np.testing.assert_allclose(found[own[1]], T.conj(), rtol=1e-13)
    assert not np.abs([found[i] for i in other]).any()


@KINDS
def test_no_joint_and_free_faces(kind):
    """K = inf passes everything; K = 0 is a free face (Aki & Richards, 2002, chapter 5) that passes
    nothing; both are limits."""
    rock, angle = ElasticRock(2600.0, 5000.0, 2900.0), np.radians(np.linspace(-89, 89, 90))
    passed = np.array(coefficients(kind, angle, OMEGA, rock, Joint(np.inf, np.inf)))
    assert np.abs(passed - np.eye(4)[2 + (kind == "SV")][:, None]).max() < 1e-13
    stiff = np.array(coefficients(kind, angle, OMEGA, rock, Joint(1e25, 1e25)))
    assert np.abs(stiff - passed).max() < 1e-12
    R_p, R_s, T_p, T_s = coefficients(kind, angle, OMEGA, rock, Joint(0.0, 0.0))
    p, (a, b) = slowness_along(rock, kind, angle), (5000.0, 2900.0)
    xi, eta = (x / speed for x, speed in zip(cosines(rock, p), (a, b), strict=True))
    one, two = (1 / b**2 - 2 * p**2) ** 2, 4 * p**2 * xi * eta
    cross = 4 * p * (1 / b**2 - 2 * p**2)
    if kind == "P":
        expected = (two - one) / (two + one), a / b * cross * xi / (two + one)
    else:
        expected = b / a * cross * eta / (two + one), (one - two) / (two + one)
    np.testing.assert_allclose([R_p, R_s], expected, atol=1e-13)
    assert np.abs([T_p, T_s]).max() < 1e-13
    soft = np.array(coefficients(kind, angle, OMEGA, rock, Joint(1e-10, 1e-10)))
    assert np.abs(soft - [R_p, R_s, T_p, T_s]).max() < 1e-12


def test_a_lubricated_joint_passes_no_shear(rock):
    """K_s = 0, K_n = inf: the waves behind carry no shear stress, X T_p + C T_s = 0."""
    angle = np.radians(35.0)
    *_, T_p, T_s = coefficients("P", angle, OMEGA, rock, Joint(np.inf, 0.0))
    s = np.sin(angle) / np.sqrt(3)
    shear = 2 * s * np.cos(angle) * T_p + (1 - 2 * s**2) * T_s
    assert abs(shear) < 1e-15 and abs(T_s) > 0.1


def test_reciprocity():
    """Over the square roots of the waves' fluxes R and T are symmetric."""
    rock, K, eta, angle, omega = random_media(3)
    slowness = slowness_along(rock, "P", angle)
    R, T = scattering(rock, Joint(*K, *eta), slowness, omega)
    c, k = (x.real for x in cosines(rock, slowness))
    out = np.sqrt(np.stack([rock.p_impedance * c, rock.s_impedance * k], axis=-1))
    R, T = (out[:, :, None] * x / out[:, None, :] for x in (R, T))
    assert np.abs(R[:, 0, 1] - R[:, 1, 0]).max() < 1e-11
    assert np.abs(T[:, 0, 1] - T[:, 1, 0]).max() < 1e-11


def test_mirrored_travel():
    """From the other side of the normal the converted waves change sign, the others do not."""
    rock, K, eta, angle, omega = random_media(4)
    for kind, converted in (("P", [1, -1, 1, -1]), ("SV", [-1, 1, -1, 1])):
        one, other = (
            np.array(coefficients(kind, way * angle, omega, rock, Joint(*K, *eta)))
            for way in (1, -1)
        )
        np.testing.assert_allclose(other, np.array(converted)[:, None] * one, atol=1e-14)


def test_arguments_broadcast(rock, joint):
    angle, omega = np.radians([[0.0], [30.0], [60.0]]), np.array([100.0, 200.0])
    found = coefficients("SV", angle, omega, rock, joint)
    assert np.shape(found) == (4, 3, 2)
    one = coefficients("SV", np.radians(60.0), 200.0, rock, joint)
    np.testing.assert_allclose([x[2, 1] for x in found], one, rtol=1e-13)
