"""Forces at a point, of a line and in space: harmonic and static ones, Hooke's law, balance."""

import numpy as np
import pytest
from scipy.special import hankel1

from jointwave.cases.material.rock import ElasticRock
from jointwave.compare.exact.plane import point_force
from jointwave.compare.exact.plane.point_force import motion
from jointwave.results.stress import tensors

ROCK = ElasticRock(2600.0, 5800.0, 3800.0)
PLACES = np.array([[12.0, 5.0], [-3.0, 20.0], [0.5, -0.2], [0.0, -40.0]])
IN_SPACE = np.array([[12.0, 5.0, -4.0], [-3.0, 20.0, 1.0], [0.5, -0.2, 0.1], [0.0, 0.0, -40.0]])
BY_DIMENSION = pytest.mark.parametrize("places", [PLACES, IN_SPACE], ids=["line", "point"])
OBLIQUE = {2: np.array([0.6, 0.8]), 3: np.array([0.48, 0.6, -0.64])}
FREQUENCY, DELAY = 200.0, 0.0145


def gaussian(t):
    """Return a pulse that is below 1e-18 outside 0 to 2 DELAY."""
    return np.exp(-((FREQUENCY * np.pi * (t - DELAY)) ** 2) / 2)


def gaussian_rate(t):
    return -((FREQUENCY * np.pi) ** 2) * (t - DELAY) * gaussian(t)


BREAKS = DELAY * np.linspace(0, 2, 13)


def of_gaussian(direction, places, times):
    return motion(ROCK, direction, gaussian, gaussian_rate, BREAKS, places, times)


def hankel(places, omega):
    """Return the displacement tensor [m, i, j, omega] of the harmonic line force 1 N/m."""
    r = np.hypot(*places.T)[:, None]
    g = places / r
    potentials = []
    for speed in (ROCK.s_speed, ROCK.p_speed):
        k = omega / speed
        value, slope = 0.25j * hankel1(0, k * r), -0.25j * k * hankel1(1, k * r)
        potentials.append((value, slope / r, -(k**2) * value - slope / r))
    (shear, *_), k_b = potentials[0], omega / ROCK.s_speed
    over_r, second = (potentials[0][i] - potentials[1][i] for i in (1, 2))
    gg = np.einsum("mi,mj->mij", g, g)[..., None]
    one = np.eye(2)[None, :, :, None]
    double = gg * second[:, None, None] + (one - gg) * over_r[:, None, None]
    return (one * shear[:, None, None] + double / k_b**2) / ROCK.shear_modulus


def test_hankel_functions_agree():
    """The Green's tensor of frequency domain (Achenbach, 1973), inverted over complex frequencies:
    2^13 steps of 20 us, the pulse a Gaussian, whose transform is known."""
    count, dt = 2**13, 2e-5
    decay = 20 / (count * dt)
    omega = 2 * np.pi * np.fft.rfftfreq(count, dt) + 1j * decay
    times = dt * np.arange(2000)
    width = 1 / (FREQUENCY * np.pi)
    F = width * np.sqrt(2 * np.pi) * np.exp(-((width * omega) ** 2) / 2 + 1j * omega * DELAY)
    spectrum = (hankel(PLACES, omega) * F).conj()
    growth = np.exp(decay * times)
    for j, direction in enumerate(np.eye(2)):
        found = of_gaussian(direction, PLACES, times)
        for values, part in ((found.displacement, 1), (found.velocity, -1j * omega)):
            line = spectrum[:, :, j] * np.conj(part)
            expected = np.fft.irfft(line, count)[..., :2000] / dt * growth
            # The rest is what comes after the window, e^-20 of it.
            assert np.abs(values - expected).max() < 3e-8 * np.abs(expected).max()


STEPS = np.array([-2, -1, 1, 2])
WEIGHTS = np.array([1, -8, 8, -1]) / 12


def around(place, h):
    """Return the places at STEPS of h (m) along each axis, which come last [d steps, d]."""
    return np.array([place + s * h * axis for axis in np.eye(len(place)) for s in STEPS])


@BY_DIMENSION
def test_stress_is_hookes_law_of_the_displacement(places):
    """Gradients by differences of fourth order over 1 cm: (k h)^4 / 30 at the wave fronts, and
    what the place 0.54 m away has beyond it, (h / r)^4."""
    h, times, dim = 0.01, np.linspace(0, 0.04, 301), places.shape[1]
    found = of_gaussian(OBLIQUE[dim], places, times)
    for m, place in enumerate(places):
        u = of_gaussian(OBLIQUE[dim], around(place, h), times).displacement
        gradient = np.einsum("s,ksit->ikt", WEIGHTS / h, u.reshape(dim, 4, dim, -1))
        strain = (gradient + gradient.swapaxes(0, 1)) / 2
        dilation = np.einsum("ij,t->ijt", np.eye(dim), np.trace(strain))
        expected = ROCK.lame * dilation + 2 * ROCK.shear_modulus * strain
        stress = np.moveaxis(tensors(found.stress[m].T), 0, -1)
        assert np.abs(stress - expected).max() < 1e-6 * np.abs(expected).max()


def test_a_harmonic_force_in_space():
    """u = (g I + grad grad (g_b - g_a) / k_b^2) / mu of waves g = exp(i k r) / (4 pi r) (Achenbach,
    1973): from a sine on, once the first waves have passed, the motion is harmonic."""
    omega, late = 2 * np.pi * FREQUENCY, np.linspace(0.05, 0.06, 50)
    k_b, r = omega / ROCK.s_speed, np.linalg.norm(IN_SPACE, axis=1)[:, None]
    waves = []
    for speed in (ROCK.p_speed, ROCK.s_speed):
        k, g = omega / speed, np.exp(1j * omega / speed * r) / (4 * np.pi * r)
        slope = (1j * k - 1 / r) * g
        waves.append((g, slope / r, (1j * k - 1 / r) * slope + g / r**2))
    (_, *fast), (value, *slow) = waves
    over_r, second = ((b - a) / k_b**2 for a, b in zip(fast, slow, strict=True))
    gamma = IN_SPACE / r
    expected = (
        gamma * (gamma @ OBLIQUE[3])[:, None] * (second - over_r) + OBLIQUE[3] * (value + over_r)
    ) / ROCK.shear_modulus
    breaks = np.arange(0, 0.065, 0.0025)
    shapes = (
        (lambda t: np.sin(omega * t) * (t > 0)),
        (lambda t: omega * np.cos(omega * t) * (t > 0)),
    )
    found = motion(ROCK, OBLIQUE[3], *shapes, breaks, IN_SPACE, late).displacement
    harmonic = (expected[..., None] * np.exp(-1j * omega * late)).imag * -1
    assert np.abs(found - harmonic).max() < 1e-12 * np.abs(harmonic).max()


def test_a_force_in_space_that_stays_is_kelvins():
    """u = ((3 - 4 nu) I + gamma gamma) / (16 pi mu (1 - nu) r), at once when S waves have passed;
    the tractions on a sphere then balance it."""
    nu = ROCK.lame / (2 * (ROCK.lame + ROCK.shear_modulus))
    r = np.linalg.norm(IN_SPACE, axis=1)[:, None]
    gamma, f = IN_SPACE / r, OBLIQUE[3]
    kelvin = (3 - 4 * nu) * f + gamma * (gamma @ f)[:, None]
    kelvin /= 16 * np.pi * ROCK.shear_modulus * (1 - nu) * r
    found = motion(ROCK, f, *ramp_of(1e-3), [0.0, 1e-3, np.inf], IN_SPACE, np.array([0.02]))
    assert np.abs(found.displacement[..., 0] - kelvin).max() <= 1e-13 * kelvin.max()
    cosine, weight = np.polynomial.legendre.leggauss(6)
    angle = 2 * np.pi * np.arange(8) / 8
    sine = np.sqrt(1 - cosine**2)[:, None]
    n = np.stack([sine * np.cos(angle), sine * np.sin(angle), np.tile(cosine, (8, 1)).T], axis=-1)
    still = motion(ROCK, f, *ramp_of(1e-3), [0.0, 1e-3, np.inf], 2 * n.reshape(-1, 3), [0.02])
    traction = np.einsum("mij,mj->mi", tensors(still.stress[..., 0]), n.reshape(-1, 3))
    total = np.einsum("m,mi->i", np.repeat(4 * weight, 8), traction) * 2 * np.pi / 8
    np.testing.assert_allclose(total, -f, rtol=0, atol=1e-12)


def ramp_of(duration):
    """Return a force that rises to 1 in a duration (s) and stays, and its rate."""

    def force(t):
        return 0.5 - 0.5 * np.cos(np.pi * np.clip(t, 0, duration) / duration)

    def rate(t):
        inside = (t > 0) & (t < duration)
        return np.where(inside, 0.5 * np.pi / duration * np.sin(np.pi * t / duration), 0.0)

    return force, rate


@BY_DIMENSION
@pytest.mark.parametrize("points", [16, 32])
def test_the_error_is_bounded(monkeypatch, points, places):
    """Twice the points lie within the bound; 64 are at round-off."""
    t, direction = np.linspace(0, 0.05, 200), OBLIQUE[places.shape[1]]
    best = of_gaussian(direction, places, t)
    for error, part in zip(best[3:], best[:3], strict=True):
        assert (error < 1e-11 * np.abs(part).max()).all()
    monkeypatch.setattr(point_force, "POINTS", points)
    found = of_gaussian(direction, places, t)
    for one, exact, error in zip(found[:3], best[:3], found[3:], strict=True):
        assert (np.abs(one - exact).max(axis=-1) <= error).all()
