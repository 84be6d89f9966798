"""Harmonic waves at one joint, at parallel ones and in layers, at any angle: boundary conditions,
energy, the bar."""

from typing import NamedTuple

import numpy as np
import pytest

from closed_forms import parallel_joints as normal_incidence
from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.bar.transfer import Bar, End, RockFrom, transfer
from jointwave.compare.exact.plane import parallel_joints
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.plane.parallel_joints import coefficients
from jointwave.compare.exact.plane.waves import cosines, slowness_along

OMEGA = 2 * np.pi * 100.0
KINDS = pytest.mark.parametrize("kind", ["P", "SV"])
WELDED = Joint(np.inf, np.inf)
SOFT = ElasticRock(2200.0, 3000.0, 1600.0)
HARD = ElasticRock(2700.0, 5200.0, 3000.0)
SLAB = ElasticRock(2500.0, 4000.0, 2200.0)


class Boundaries(NamedTuple):
    """Rock and parallel joints as one linear system of boundary conditions, in plain numbers.

    rock : density, speeds, of all layers or of each. joints : rows K_n, K_s, eta_n, eta_s.
    spacings : between them."""

    rock: tuple[float, float, float] | list[tuple[float, float, float]]
    joints: list[tuple[float, float, float, float]]
    spacings: list[float]

    def wave(self, layer, kind, slowness, way):
        """Return slowness [2], polarisation [2] and the stresses sigma_nn, sigma_tn of 1 m/s."""
        density, a, b = self.rock[layer] if isinstance(self.rock, list) else self.rock
        lame, mu = density * (a**2 - 2 * b**2), density * b**2
        speed = a if kind == "P" else b
        s = np.array([slowness, way * np.sqrt(1 / speed**2 - slowness**2 + 0j)])
        g = s * speed if kind == "P" else way * np.array([s[1], -s[0]]) * speed
        exx, ezz, gxz = -s[0] * g[0], -s[1] * g[1], -s[0] * g[1] - s[1] * g[0]
        return s, g, np.array([(lame + 2 * mu) * ezz + lame * exx, mu * gxz])

    def solve(self, incidence, slowness, omega):
        """Return R_p, R_s, T_p, T_s from 4 N equations for 4 N amplitudes."""
        count = len(self.joints)
        z = np.concatenate([[0.0], np.cumsum(self.spacings)])
        waves = [(0, kind, -1, z[0]) for kind in ("P", "SV")]
        for layer in range(1, count):
            waves += [(layer, kind, 1, z[layer - 1]) for kind in ("P", "SV")]
            waves += [(layer, kind, -1, z[layer]) for kind in ("P", "SV")]
        waves += [(count, kind, 1, z[-1]) for kind in ("P", "SV")]
        matrix = np.zeros((4 * count, 4 * count + 1), dtype=complex)
        for column, (layer, kind, way, start) in enumerate([*waves, (0, incidence, 1, z[0])]):
            s, g, traction = self.wave(layer, kind, slowness, way)
            for j, (K_n, K_s, eta_n, eta_s) in enumerate(self.joints):
                if layer not in (j, j + 1):
                    continue
                side = 1 if layer == j + 1 else -1
                phase = np.exp(1j * omega * s[1] * (z[j] - start))
                jump = side * g[::-1] / (-1j * omega)
                K = np.array([K_n - 1j * omega * eta_n, K_s - 1j * omega * eta_s])
                matrix[4 * j : 4 * j + 2, column] += side * traction * phase
                behind = traction / K if side > 0 else 0
                matrix[4 * j + 2 : 4 * j + 4, column] += (jump - behind) * phase
        scale = np.abs(matrix).max(axis=1, keepdims=True)
        found = np.linalg.solve((matrix / scale)[:, :-1], -(matrix / scale)[:, -1])
        return np.concatenate([found[:2], found[-2:]])


@KINDS
@pytest.mark.parametrize("count", [1, 2, 6])
def test_all_boundary_conditions_at_once_agree(kind, count):
    """4 N equations for 4 N amplitudes by numpy, joints and spacings of each their own, dashpots:
    round-off over the condition of that system, which grows towards grazing incidence."""
    rng = np.random.default_rng(count)
    for _ in range(40):
        b = rng.uniform(500, 4000)
        rock = (rng.uniform(1500, 3500), b * rng.uniform(1.05, 6), b)
        scale = rock[0] * b * np.array([OMEGA, OMEGA, 1, 1])
        joints = [tuple(scale * 10 ** rng.uniform(-1.5, 1.5, 4)) for _ in range(count)]
        spacings = list(rng.uniform(0.02, 0.6, count - 1) * b / 100)
        angle, own = rng.uniform(-1.5, 1.5), ElasticRock(*rock)
        found = coefficients(kind, angle, OMEGA, own, [Joint(*j) for j in joints], spacings)
        slowness = float(slowness_along(own, kind, angle))
        expected = Boundaries(rock, joints, spacings).solve(kind, slowness, OMEGA)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11)


@KINDS
def test_layers_of_unlike_rocks_are_the_system_of_all_conditions(kind):
    """One to three joints, random, with dashpots or welded (Zoeppritz), evanescent waves among
    them, at round-off over their condition."""
    rng, k = np.random.default_rng(1), ["P", "SV"].index(kind)
    for n in range(40):
        count = 1 + n % 3
        rocks = [
            (rng.uniform(1500, 3500), b * rng.uniform(1.5, 3), b)
            for b in rng.uniform(800, 3500, count + 1)
        ]
        laws = [(*10 ** rng.uniform(8, 12, 2), *10 ** rng.uniform(4, 7, 2)) for _ in range(count)]
        laws[0] = laws[0] if n % 4 else (np.inf, np.inf, 0.0, 0.0)
        spacings = list(rng.uniform(2, 20, count - 1))
        p = rng.uniform(-0.95, 0.95) / rocks[0][1 + k]
        own, joints = [ElasticRock(*one) for one in rocks], [Joint(*law) for law in laws]
        down, up = parallel_joints.layers(own, joints, spacings, p, OMEGA, np.eye(2)[k])
        expected = Boundaries(rocks, laws, spacings).solve(kind, p, OMEGA)
        np.testing.assert_allclose(np.append(up[0], down[-1]), expected, rtol=0, atol=1e-10)


@pytest.mark.parametrize("degrees", [0, 20, 80])
def test_sh_in_closed_form(degrees):
    """T = 1 / (1 - i x), x = omega Z_s cos(phi) / 2 K_s with K_s - i omega eta; R = 1 - T."""
    rock, phi = ElasticRock(2600.0, 5000.0, 2900.0), np.radians(degrees)
    omega, K = np.array([10.0, 500.0, 4e3]), 3e9
    for eta in (0.0, 2e6):
        R, T = coefficients("SH", phi, omega, rock, [Joint(1e9, K, 1e5, eta)], [])
        x = omega * rock.s_impedance * np.cos(phi) / (2 * (K - 1j * omega * eta))
        np.testing.assert_allclose(T, 1 / (1 - 1j * x), rtol=1e-13)
        np.testing.assert_allclose(R, 1 - T, rtol=0, atol=1e-13)


@pytest.mark.parametrize("kind, degrees", [("P", 0), ("SV", 0), ("SH", 0), ("SH", 30), ("SH", 70)])
@pytest.mark.parametrize("count", [2, 5, 40])
def test_many_joints_are_the_closed_form(rock, joint, kind, degrees, count):
    """|T| by Chebyshev polynomials at kappa = 1 / cos(phi), spacings over the wavelength across."""
    cos, speed = np.cos(np.radians(degrees)), rock.p_speed if kind == "P" else rock.s_speed
    spacings = [0.1 * speed / 100] * (count - 1)
    found = coefficients(kind, np.radians(degrees), OMEGA, rock, [joint] * count, spacings)
    own = found[{"P": 2, "SV": 3, "SH": 1}[kind]]
    expected = normal_incidence.transmission(count, 1 / cos, 0.1 * cos)
    assert abs(own) == pytest.approx(expected, rel=1e-11)
    assert np.sum(np.abs(found) ** 2) == pytest.approx(1.0, abs=1e-11)


@KINDS
def test_no_joint_and_free_faces(kind):
    """K = inf passes everything; K = 0 is a free face (Aki & Richards, 2002, chapter 5) that passes
    nothing; both are limits."""
    rock, angle = ElasticRock(2600.0, 5000.0, 2900.0), np.radians(np.linspace(-89, 89, 90))

    def at(K):
        return np.array(coefficients(kind, angle, OMEGA, rock, [Joint(K, K)], []))

    assert np.abs(at(np.inf) - np.eye(4)[2 + (kind == "SV")][:, None]).max() < 1e-13
    assert np.abs(at(1e25) - at(np.inf)).max() < 1e-12
    p, (a, b) = slowness_along(rock, kind, angle), (5000.0, 2900.0)
    xi, eta = (x / speed for x, speed in zip(cosines(rock, p), (a, b), strict=True))
    one, two = (1 / b**2 - 2 * p**2) ** 2, 4 * p**2 * xi * eta
    cross = 4 * p * (1 / b**2 - 2 * p**2)
    if kind == "P":
        expected = (two - one) / (two + one), a / b * cross * xi / (two + one)
    else:
        expected = b / a * cross * eta / (two + one), (one - two) / (two + one)
    np.testing.assert_allclose(at(0.0)[:2], expected, atol=1e-13)
    assert np.abs(at(0.0)[2:]).max() < 1e-13
    assert np.abs(at(1e-10) - at(0.0)).max() < 1e-12


def test_joints_far_apart_in_evanescent_waves(rock, joint):
    """P waves decayed by e^-2000 between the joints neither overflow nor matter: two joints of SV
    alone are a Fabry-Perot of their T_s and R_s."""
    angle, d = np.radians(70.0), 1e5 / 3
    _, R_s, _, T_s = coefficients("SV", angle, OMEGA, rock, [joint], [])
    e = np.exp(1j * OMEGA * d * np.cos(angle) / rock.s_speed)
    found = coefficients("SV", angle, OMEGA, rock, [joint] * 2, [d])
    assert found[3] == pytest.approx(T_s * e * T_s / (1 - (R_s * e) ** 2), rel=1e-9)


@pytest.mark.parametrize(("kind", "degrees"), [("P", 0), ("SV", 0), ("SH", 25)])
def test_straight_on_they_are_a_bar_of_segments(kind, degrees):
    """The bar of the P-wave or the shear modulus in the Laplace variable s = -i omega, behind a
    dashpot at both ends: velocity at one place in each layer, at round-off. So are SH waves at a
    slant, with the density rho cos^2(phi) of each layer: rho b cos(phi) and b / cos(phi)."""
    rocks, offsets = [SOFT, HARD, SLAB], np.array([10.0, 25.0])
    joints = [Joint(np.inf, np.inf), Joint(6e9, 3e9)]
    name, stiffness = ("p_speed", 6e9) if kind == "P" else ("s_speed", 3e9)
    omega = OMEGA * np.linspace(0.3, 3, 20) + 30j
    own, speed = np.transpose([(one.density, getattr(one, name)) for one in rocks])
    density = own * (1 - (speed / speed[0] * np.sin(np.radians(degrees))) ** 2)
    moduli, z = own * speed**2, np.sqrt(density * own) * speed
    parts = [RockFrom(*each, 0.0) for each in zip((0.0, 10.0, 25.0), density, moduli, strict=True)]
    joint = offsets[1:], np.array([1 / stiffness]), np.zeros(1)
    bar = Bar(40.0, tuple(parts), *joint, End(z[0]), End(z[-1]))
    places = np.array([4.0, 20.0, 33.0])
    exact = transfer(bar, -1j * omega, places)[1] * 2 * z[0]
    travel, n = np.array([np.sin(np.radians(degrees)), np.cos(np.radians(degrees))]), [0.0, 1.0]
    stack = parallel_joints.stack_of(rocks, joints, kind, travel, np.array(n), offsets)
    down, up = stack.layers(omega)
    k, lead = stack.axes.kinds.index(kind), np.exp(1j * omega * stack.lead)
    found = []
    for layer, y in enumerate(places):
        q = stack.slownesses[layer, k]
        first, last = offsets[max(layer - 1, 0)], offsets[min(layer, 1)]
        sign = -1 if kind == "P" else 1
        there = down[layer, :, k] * np.exp(1j * omega * q * (y - first))
        found.append(lead * (there + sign * up[layer, :, k] * np.exp(1j * omega * q * (last - y))))
    np.testing.assert_allclose(np.array(found), exact, rtol=0, atol=1e-12)


def test_amplitudes_in_layers_repeat_to_the_last_bit():
    """Wherever in memory numpy puts what it multiplies: other arrays come and go in between."""
    rocks, joints, offsets = [SLAB, HARD, SOFT], [WELDED, Joint(8e9, 3e9)], [0.0, 6.0]
    travel, n = ([np.sin(angle), np.cos(angle)] for angle in np.radians([150, -20]))
    stack = parallel_joints.stack_of(rocks, joints, "P", np.array(travel), np.array(n), offsets)
    omega = np.linspace(1.0, 1e5, 1421) + 30j
    expected, random, others = stack.layers(omega), np.random.default_rng(1), []
    for _ in range(60):
        others = [*others[-20:], np.empty(int(random.integers(1, 15_000)))]
        for one, known in zip(stack.layers(omega), expected, strict=True):
            assert (one == known).all()
