"""The theory of the generalised-alpha method against its limits, and against the true oscillator.

The constants are those of Chung & Hulbert's optimum in their own symbols; the engine's are held to
them in tests/continuum.
"""

import numpy as np
import pytest

from closed_forms import generalised_alpha as theory

RADII = [0.0, 0.3, 0.5, 0.8, 0.9, 1.0]


def optimum(rho):
    """Return (alpha_m, alpha_f, beta, gamma) of Chung & Hulbert for a spectral radius."""
    return of_family((2 * rho - 1) / (rho + 1), rho / (rho + 1))


def of_family(alpha_m, alpha_f):
    """Return the second-order scheme of these shares that damps high frequencies most."""
    lead = 1 - alpha_m + alpha_f
    return alpha_m, alpha_f, lead**2 / 4, lead - 0.5


@pytest.mark.parametrize("rho", RADII)
@pytest.mark.parametrize("xi", [0.0, 0.1])
def test_no_step_is_unstable(rho, xi):
    """Unconditional stability: round-off of a double root is its square root, 1e-8."""
    x = np.logspace(-4, 6, 401)
    assert theory.spectral_radius(optimum(rho), x, xi).max() <= 1 + 1e-8


@pytest.mark.parametrize("rho", RADII)
def test_roots_of_infinite_frequency_are_all_minus_rho(rho):
    """det(z L - R) over x^2 at x = infinity is a multiple of (z + rho)^3; the next term of
    the expansion is of order x^-2."""
    found = np.poly(theory.amplification(optimum(rho), 1e7))
    assert found == pytest.approx(np.poly([-rho] * 3), abs=1e-12)


@pytest.mark.parametrize("rho", RADII)
@pytest.mark.parametrize("x", [0.01, 0.3, 2.0, 30.0])
def test_characteristic_polynomial_is_that_of_the_displacements_alone(rho, x):
    """Eliminating velocity and acceleration leaves, by hand,

    (z - 1)^2 (alpha_m + (1 - alpha_m) z)
      + x^2 (beta z^2 + (1/2 - 2 beta + gamma) z + 1/2 + beta - gamma) (alpha_f + (1 - alpha_f) z).
    """
    alpha_m, alpha_f, beta, gamma = optimum(rho)
    newmark = [beta, 0.5 - 2 * beta + gamma, 0.5 + beta - gamma]
    inertia = np.polymul([1, -2, 1], [1 - alpha_m, alpha_m])
    whole = inertia + x**2 * np.polymul(newmark, [1 - alpha_f, alpha_f])
    found = np.poly(theory.amplification(optimum(rho), x))
    # Eigenvalues near a double one are known to the square root of round-off, their sums to it.
    assert found == pytest.approx(whole / whole[0], abs=1e-12)


def test_trapezoidal_rule_damps_nothing():
    """rho = 1: tan(s / 2) = x / 2 exactly, so the period error is (x / 2) / atan(x / 2) - 1."""
    x = np.array([0.01, 0.1, 1.0, 10.0])
    s = theory.frequency(optimum(1.0), x)
    assert s.imag == pytest.approx(2 * np.arctan(x / 2), rel=1e-12)
    assert np.abs(theory.damping_ratio(optimum(1.0), x)).max() < 1e-12
    assert theory.period_error(optimum(1.0), 0.1) == pytest.approx(0.1**2 / 12, rel=1e-3)


@pytest.mark.parametrize("rho", RADII)
def test_small_steps_err_as_their_leading_terms_say(rho):
    """What follows is smaller by x^2; x = 0.01 leaves 1e-12 of round-off in x^3 / 2."""
    x = np.array([0.01, 0.02])
    slow = (11 - 14 * rho + 11 * rho**2) / (1 + rho) ** 2 / 24
    damping = ((1 - rho) / (1 + rho)) ** 3 / 2
    assert theory.period_error(optimum(rho), x) == pytest.approx(slow * x**2, rel=2e-3)
    assert theory.damping_ratio(optimum(rho), x) == pytest.approx(
        damping * x**3, rel=2e-3, abs=1e-12
    )


@pytest.mark.parametrize("rho", [0.6, 0.8])
def test_optimum_damps_low_frequencies_less_than_its_relatives(rho):
    """At the same spectral radius: Hilber, Hughes & Taylor (alpha_m = 0, the optimum itself at
    rho = 1/2) and Wood, Bossak & Zienkiewicz (alpha_f = 0)."""
    lead = (1 - rho) / (1 + rho)
    hht, wbz = of_family(0.0, lead), of_family(-lead, 0.0)
    x = np.array([0.05, 0.2, 0.6])
    best = theory.damping_ratio(optimum(rho), x)
    for other in (hht, wbz):
        assert theory.spectral_radius(other, 1e7) == pytest.approx(rho, abs=1e-6)  # a double root
        assert (theory.damping_ratio(other, x) > 1.05 * best).all()


@pytest.mark.parametrize("rho", RADII)
@pytest.mark.parametrize("xi", [0.0, 0.05])
def test_response_converges_to_the_oscillator_at_order_two(rho, xi):
    """Free motion and a harmonic load from rest, both known in closed form."""
    omega, drive, end = 3.0, 2.0, 4.0
    damped, decay = omega * np.sqrt(1 - xi**2), xi * omega
    push = 1 / (omega**2 - drive**2 + 2j * xi * omega * drive)  # of exp(i drive t)

    def exact(t):
        steady = (push * np.exp(1j * drive * t)).imag
        q0, v0 = 0.2 - push.imag, 1.0 - (1j * drive * push).imag
        swing = q0 * np.cos(damped * t) + (v0 + decay * q0) / damped * np.sin(damped * t)
        return steady + np.exp(-decay * t) * swing

    errors = []
    for steps in (400, 800, 1600):
        t = np.linspace(0, end, steps + 1)
        force = np.sin(drive * t)[None]
        motion = theory.response(
            optimum(rho), np.array([omega]), force, end / steps, xi, (0.2, 1.0)
        )
        errors.append(np.abs(motion.displacement[0] - exact(t)).max())
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([2, 2], abs=0.05)


def test_response_satisfies_the_method_in_every_step():
    """Newmark's formulas and the balance in between, with loads, damping and modes that differ."""
    rng, dt = np.random.default_rng(1), 0.1
    omega, xi = np.array([0.0, 1.0, 40.0]), np.array([0.0, 0.1, 0.02])
    force = rng.standard_normal((3, 200))
    alpha_m, alpha_f, beta, gamma = constants = optimum(0.7)
    q, v, a = theory.response(constants, omega, force, dt, xi, (0.5, -1.0))
    rest = 2 * (xi * omega)[:, None] * v + (omega**2)[:, None] * q - force
    assert (a + rest)[:, 0] == pytest.approx(0, abs=1e-10)

    def between(x, share):
        return (1 - share) * x[:, 1:] + share * x[:, :-1]

    # What each line is summed from is below 1e4 m/s2 and 1e2 m, so round-off is below 1e-10.
    assert np.abs(a).max() < 1e4 and np.abs(q).max() < 1e2
    assert between(a, alpha_m) + between(rest, alpha_f) == pytest.approx(0, abs=1e-10)
    moved = dt * v[:, :-1] + dt**2 * between(a, 1 - 2 * beta) / 2
    assert np.diff(q) == pytest.approx(moved, abs=1e-12)
    assert np.diff(v) == pytest.approx(dt * between(a, 1 - gamma), abs=1e-12)
