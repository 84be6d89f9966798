"""N parallel joints at any angle: coefficients of harmonic waves."""

import numpy as np
import pytest

from closed_forms import parallel_joints as normal_incidence
from closed_forms.oblique_joint import energy_flux
from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.plane.parallel_joints import coefficients
from jointwave.compare.exact.plane.waves import slowness_along

OMEGA = 2 * np.pi * 100.0
KINDS = pytest.mark.parametrize("kind", ["P", "SV"])


@pytest.mark.parametrize(
    "count, T_p, T_s", [(2, 0.9098, 0.0443), (3, 0.9809, 0.0449), (5, 0.9256, 0.0721)]
)
def test_numbers_at_thirty_degrees(rock, joint, count, T_p, T_s):
    """nu = 0.25, K_n = Z_p omega, K_s = Z_s omega, 0.1 P wavelengths apart, to the four digits of
    two independent programs."""
    spacings = [0.1 * rock.p_speed / 100] * (count - 1)
    found = coefficients("P", np.radians(30), OMEGA, rock, [joint] * count, spacings)
    assert np.abs(found[2:]) == pytest.approx([T_p, T_s], abs=5.1e-5)


@KINDS
@pytest.mark.parametrize("count", [2, 3, 5, 40])
@pytest.mark.parametrize("spacing", [0.05, 0.1, 0.2])
def test_normal_incidence_is_the_closed_form(rock, joint, kind, count, spacing):
    """|T| by Chebyshev polynomials at kappa = 1."""
    speed = rock.p_speed if kind == "P" else rock.s_speed
    spacings = [spacing * speed / 100] * (count - 1)
    found = coefficients(kind, 0.0, OMEGA, rock, [joint] * count, spacings)
    own = found[2] if kind == "P" else found[3]
    expected = normal_incidence.transmission(count, 1.0, spacing)
    assert abs(own) == pytest.approx(expected, rel=1e-11)


@pytest.mark.parametrize("degrees", [0, 30, 70])
@pytest.mark.parametrize("count", [1, 2, 5, 40])
def test_sh_is_the_bar_of_its_slowness_across(rock, joint, count, degrees):
    """|T| by Chebyshev polynomials at kappa = 1 / cos(phi), spacings over the wavelength across."""
    cos, apart = np.cos(np.radians(degrees)), 0.1 * rock.s_speed / 100
    found = coefficients(
        "SH", np.radians(degrees), OMEGA, rock, [joint] * count, [apart] * (count - 1)
    )
    expected = normal_incidence.transmission(count, 1 / cos, 0.1 * cos)
    assert abs(found[1]) == pytest.approx(expected, rel=1e-11)
    assert np.sum(np.abs(found) ** 2) == pytest.approx(1.0, abs=1e-11)


@KINDS
@pytest.mark.parametrize("count", [1, 2, 3, 6])
def test_all_boundary_conditions_at_once_agree(referee, kind, count):
    """4 N equations for 4 N amplitudes by numpy, joints and spacings of each their own."""
    rng = np.random.default_rng(count)
    for _ in range(40):
        b = rng.uniform(1000, 3000)
        rock = (2500.0, b * rng.uniform(1.2, 4), b)
        joints = [
            tuple(2500 * b * np.array([OMEGA, OMEGA, 1, 1]) * 10 ** rng.uniform(-1.5, 1.5, 4))
            for _ in range(count)
        ]
        spacings = list(rng.uniform(0.02, 0.6, count - 1) * b / 100)
        angle = rng.uniform(-1.5, 1.5)
        found = coefficients(
            kind, angle, OMEGA, ElasticRock(*rock), [Joint(*j) for j in joints], spacings
        )
        slowness = float(slowness_along(ElasticRock(*rock), kind, angle))
        expected = referee(rock, joints, spacings).solve(kind, slowness, OMEGA)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11)


@KINDS
def test_energy_flux_sums_to_one(rock, kind):
    """Also with evanescent P waves, which carry energy from joint to joint but not away."""
    rng = np.random.default_rng(7)
    joints = [Joint(*(1e9 * 10 ** rng.uniform(0, 2, 2))) for _ in range(8)]
    spacings, angle = rng.uniform(0.5, 20, 7), np.linspace(-1.55, 1.55, 200)
    for omega in (100.0, 1000.0):
        found = coefficients(kind, angle, omega, rock, joints, spacings)
        assert np.abs(energy_flux(kind, angle, rock, found).sum(axis=0) - 1).max() < 1e-11


def test_joints_far_apart_in_evanescent_waves(rock, joint):
    """P waves decayed by e^-2000 between the joints neither overflow nor matter: two joints of SV
    alone are a Fabry-Perot of their T_s and R_s."""
    angle, d = np.radians(70.0), 1e5 / 3
    one = coefficients("SV", angle, OMEGA, rock, [joint], [])
    _, R_s, _, T_s = one
    e = np.exp(1j * OMEGA * d * np.cos(angle) / rock.s_speed)
    found = coefficients("SV", angle, OMEGA, rock, [joint] * 2, [d])
    assert found[3] == pytest.approx(T_s * e * T_s / (1 - (R_s * e) ** 2), rel=1e-9)
