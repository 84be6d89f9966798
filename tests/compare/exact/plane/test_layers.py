"""Waves through layers of unlike rock, welded or jointed: Zoeppritz, energy, the bar."""

import numpy as np
import pytest

from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.bar.transfer import Bar, End, RockFrom, transfer
from jointwave.compare.exact.plane import parallel_joints
from jointwave.compare.exact.plane.oblique_joint import Joint, scattering
from jointwave.compare.exact.plane.waves import cosines

OMEGA = 2 * np.pi * 100.0
WELDED = Joint(np.inf, np.inf)
SOFT = ElasticRock(2200.0, 3000.0, 1600.0)
HARD = ElasticRock(2700.0, 5200.0, 3000.0)
SLAB = ElasticRock(2500.0, 4000.0, 2200.0)


def plain(rock):
    return rock.density, rock.p_speed, rock.s_speed


@pytest.mark.parametrize("degrees", [0, 10, 25, 34])
def test_a_welded_contact_is_that_of_zoeppritz(degrees):
    """P from above, in the form of Aki & Richards (2002), (5.38) to (5.40), of displacement."""
    one, two, p = SOFT, HARD, np.sin(np.radians(degrees)) / SOFT.p_speed
    (rho1, a1, b1), (rho2, a2, b2) = plain(one), plain(two)
    i1, j1, i2, j2 = (np.sqrt(1 / c**2 - p**2) for c in (a1, b1, a2, b2))
    a = rho2 * (1 - 2 * b2**2 * p**2) - rho1 * (1 - 2 * b1**2 * p**2)
    b = rho2 * (1 - 2 * b2**2 * p**2) + 2 * rho1 * b1**2 * p**2
    c = rho1 * (1 - 2 * b1**2 * p**2) + 2 * rho2 * b2**2 * p**2
    d = 2 * (rho2 * b2**2 - rho1 * b1**2)
    E, F, G, H = b * i1 + c * i2, b * j1 + c * j2, a - d * i1 * j2, a - d * i2 * j1
    D = E * F + G * H * p**2
    expected = [
        ((b * i1 - c * i2) * F - (a + d * i1 * j2) * H * p**2) / D,
        -2 * i1 * (a * b + c * d * i2 * j2) * p * a1 / (b1 * D),
        2 * rho1 * i1 * F * a1 / (a2 * D),
        2 * rho1 * i1 * H * p * a1 / (b2 * D),
    ]
    R, T = scattering(one, WELDED, p, OMEGA, two)
    found = np.concatenate([R[:, 0], T[:, 0]])
    np.testing.assert_allclose(np.abs(found), np.abs(expected), rtol=0, atol=1e-14)


@pytest.mark.parametrize("kind", ["P", "SV"])
def test_the_boundary_conditions_agree(referee, kind):
    """A joint with dashpots between unlike rocks, random, evanescent waves among them: four
    equations for four amplitudes by numpy, at round-off over their condition."""
    rng = np.random.default_rng(1)
    for _ in range(100):
        rocks = [
            (rng.uniform(1500, 3500), b * rng.uniform(1.5, 3), b) for b in rng.uniform(800, 3500, 2)
        ]
        law = 10 ** rng.uniform(8, 12, 2), 10 ** rng.uniform(4, 7, 2)
        slowness = rng.uniform(-0.95, 0.95) / rocks[0][1 if kind == "P" else 2]
        R, T = scattering(
            ElasticRock(*rocks[0]), Joint(*law[0], *law[1]), slowness, OMEGA, ElasticRock(*rocks[1])
        )
        k = ["P", "SV"].index(kind)
        expected = referee(rocks, [(*law[0], *law[1])], []).solve(kind, slowness, OMEGA)
        found = np.concatenate([R[:, k], T[:, k]])
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10)


def test_energy_flux_through_a_joint_sums_to_one():
    """Re Z cos of each wave carries it away: from both sides, from joints soft and stiff."""
    for K in (1e8, 1e10, 1e12, np.inf):
        for one, two in ((SOFT, HARD), (HARD, SOFT)):
            p = 0.9 / HARD.p_speed
            R, T = scattering(one, Joint(K, 0.4 * K), p, OMEGA, two)
            here, there = (
                np.array([rock.p_impedance, rock.s_impedance]) * np.real(cosines(rock, p))
                for rock in (one, two)
            )
            flux = here @ np.abs(R) ** 2 + there @ np.abs(T) ** 2
            np.testing.assert_allclose(flux, here, rtol=1e-13)


def test_it_becomes_the_joint_in_one_rock():
    """A density that differs by 1e-9 takes the way of unlike rocks."""
    nearly, joint = (
        ElasticRock(HARD.density * (1 + 1e-9), HARD.p_speed, HARD.s_speed),
        Joint(1e10, 4e9),
    )
    for found, exact in zip(
        scattering(HARD, joint, 1e-4, OMEGA, nearly),
        scattering(HARD, joint, 1e-4, OMEGA),
        strict=True,
    ):
        np.testing.assert_allclose(found, exact, rtol=0, atol=1e-8)


@pytest.mark.parametrize("kind", ["P", "SV"])
def test_layers_met_at_a_slant_are_the_system_of_all_conditions(referee, kind):
    """Three unlike layers and the rock behind, joints between them that differ."""
    rocks, joints = [SOFT, HARD, SLAB, HARD], [Joint(1e10, 4e9), Joint(1e16, 1e16), Joint(3e9, 2e9)]
    spacings, p, k = [7.0, 11.0], 1.2e-4, ["P", "SV"].index(kind)
    R, Y = parallel_joints.march(rocks, joints, spacings, p, OMEGA)
    T = Y[0]
    for rock, d, y in zip(rocks[1:], spacings, Y[1:], strict=False):
        q = np.array(cosines(rock, p)) / [rock.p_speed, rock.s_speed]
        T = y @ (np.exp(1j * OMEGA * d * q)[:, None] * T)
    laws = [(one.normal_stiffness, one.shear_stiffness, 0.0, 0.0) for one in joints]
    expected = referee([plain(one) for one in rocks], laws, spacings).solve(kind, p, OMEGA)
    np.testing.assert_allclose(np.append(R[0][:, k], T[:, k]), expected, rtol=0, atol=1e-10)


@pytest.mark.parametrize(("kind", "degrees"), [("P", 0), ("SV", 0), ("SH", 0), ("SH", 25)])
def test_straight_on_they_are_a_bar_of_segments(kind, degrees):
    """The bar of the P-wave or the shear modulus in the Laplace variable s = -i omega, behind a
    dashpot at both ends: velocity at one place in each layer, at round-off. So are SH waves at a
    slant, with the density rho cos^2(phi) of each layer: rho b cos(phi) and b / cos(phi)."""
    rocks, offsets = [SOFT, HARD, SLAB], np.array([10.0, 25.0])
    joints = [Joint(np.inf, np.inf), Joint(6e9, 3e9)]
    name, stiffness = ("p_speed", 6e9) if kind == "P" else ("s_speed", 3e9)
    omega = OMEGA * np.linspace(0.3, 3, 20) + 30j
    moduli = [one.density * getattr(one, name) ** 2 for one in rocks]
    sines = [
        getattr(one, name) / getattr(SOFT, name) * np.sin(np.radians(degrees)) for one in rocks
    ]
    density = [one.density * (1 - sine**2) for one, sine in zip(rocks, sines, strict=True)]
    z = [np.sqrt(density[k] * moduli[k]) for k in (0, -1)]
    parts = [RockFrom(*each, 0.0) for each in zip((0.0, 10.0, 25.0), density, moduli, strict=True)]
    joint = offsets[1:], np.array([1 / stiffness]), np.zeros(1)
    bar = Bar(40.0, tuple(parts), *joint, End(z[0]), End(z[1]))
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


def test_amplitudes_in_layers_repeat_to_the_last_bit(directed):
    """Wherever in memory numpy puts what it multiplies: other arrays come and go in between."""
    rocks, joints, offsets = [SLAB, HARD, SOFT], [WELDED, Joint(8e9, 3e9)], [0.0, 6.0]
    stack = parallel_joints.stack_of(rocks, joints, "P", directed(150), directed(-20), offsets)
    omega = np.linspace(1.0, 1e5, 5684) + 30j
    expected, random, others = stack.layers(omega), np.random.default_rng(1), []
    for _ in range(60):
        others = [*others[-20:], np.empty(int(random.integers(1, 60_000)))]
        for one, known in zip(stack.layers(omega), expected, strict=True):
            assert (one == known).all()
