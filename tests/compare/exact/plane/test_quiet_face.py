"""Viscous boundaries: reflection of P and SV against the angle."""

import numpy as np
import pytest

from closed_forms import oblique_joint
from closed_forms.oblique_joint import energy_flux
from closed_forms.quiet_face import coefficients
from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.plane.waves import cosines, slowness_along

KINDS = pytest.mark.parametrize("kind", ["P", "SV"])
ANGLES = np.radians(np.linspace(-89.9, 89.9, 181))


@KINDS
@pytest.mark.parametrize("dashpots", [(1.0, 1.0), (0.3, 2.0), (1.0, 0.25)])
def test_the_boundary_conditions_agree(referee, rock, kind, dashpots):
    """Two equations for two amplitudes by numpy, with stresses by Hooke's law."""
    system = referee((rock.density, rock.p_speed, rock.s_speed), [], [])
    Z = np.array([rock.p_impedance, rock.s_impedance]) * dashpots
    found = coefficients(kind, ANGLES, rock, dashpots)
    for angle, r in zip(ANGLES, np.transpose(found), strict=True):
        p = float(slowness_along(rock, kind, angle))
        columns = []
        for wave in (("P", p, -1), ("SV", p, -1), (kind, p, 1)):
            _, g, traction = system.wave(0, *wave)
            columns.append(traction / Z + g[::-1])
        expected = np.linalg.solve(np.transpose(columns[:2]), -columns[2])
        np.testing.assert_allclose(r, expected, rtol=0, atol=1e-12)


@KINDS
def test_normal_incidence_is_the_dashpot_of_a_bar(rock, kind):
    """(1 - beta) / (1 + beta) of stress, which is nothing at 1."""
    own, other, sign = (0, 1, -1) if kind == "P" else (1, 0, 1)
    for dashpot in (0.0, 0.25, 1.0, 4.0, np.inf):
        found = coefficients(kind, 0.0, rock, (dashpot, dashpot))
        share = 1 / (1 + dashpot)
        assert found[own] == pytest.approx(sign * (2 * share - 1), abs=1e-15)
        assert found[other] == 0


@KINDS
def test_no_dashpots_are_a_free_face_and_infinite_ones_hold_it(rock, kind):
    free = coefficients(kind, ANGLES, rock, (0.0, 0.0))
    joint = oblique_joint.coefficients(kind, ANGLES, 100.0, rock, Joint(0.0, 0.0))
    np.testing.assert_allclose(free, joint[:2], atol=1e-12)
    held = coefficients(kind, ANGLES, rock, (np.inf, np.inf))
    assert np.abs(energy_flux(kind, ANGLES, rock, held).sum(axis=0) - 1).max() < 1e-12
    p = slowness_along(rock, kind, ANGLES)
    (c, k), a, s = cosines(rock, p), rock.p_speed * p, rock.s_speed * p
    there = (a, c) if kind == "P" else (k, -s)
    assert np.abs(there[0] + held[0] * a + held[1] * k).max() < 1e-12
    assert np.abs(there[1] - held[0] * c + held[1] * s).max() < 1e-12


def test_sixty_degrees_by_hand(rock):
    """nu = 0.25, P at theta = 60 degrees, SV at phi = 30: C = c = X = s = 1/2, k = a' = sqrt(3)/2,
    (b/a) S = 1/2, so r_p = r_s = -(1 - sqrt(3)/2) for both, and twice the square of it, 3.59 % of
    the energy, comes back."""
    expected = 1 - np.sqrt(3) / 2
    for kind, degrees in (("P", 60), ("SV", 30)):
        angle = np.radians(degrees)
        found = coefficients(kind, angle, rock)
        assert np.array(found) == pytest.approx(np.full(2, -expected), rel=1e-12)
        share = energy_flux(kind, angle, rock, found).sum()
        assert share == pytest.approx(2 * expected**2, rel=1e-12)


@KINDS
def test_grazing_waves_come_back(rock, kind):
    """Below 0.1 % within 10 degrees of the normal, nearly all along the face, and the same on both
    sides of the normal."""
    share = energy_flux(kind, ANGLES, rock, coefficients(kind, ANGLES, rock)).sum(axis=0)
    assert share[np.abs(ANGLES) < np.radians(10)].max() < 1e-3
    assert 0.95 < share[0] < 1
    assert share == pytest.approx(share[::-1], rel=1e-12)


def test_dashpots_take_energy_at_every_angle():
    """Random rocks and dashpots, SV beyond the critical angle included."""
    rng = np.random.default_rng(5)
    for _ in range(50):
        b = rng.uniform(500, 3000)
        rock, dashpots = (
            ElasticRock(2500.0, b * rng.uniform(1.1, 5), b),
            tuple(rng.uniform(0.01, 5, 2)),
        )
        for kind in ("P", "SV"):
            found = coefficients(kind, ANGLES, rock, dashpots)
            assert energy_flux(kind, ANGLES, rock, found).sum(axis=0).max() < 1
