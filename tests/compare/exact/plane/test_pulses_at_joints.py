"""Plane pulses at joints in time: equations of the fields, closed forms, and error bounds."""

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss

from jointwave.compare.exact import inversion
from jointwave.compare.exact.plane import layer_pulses, parallel_joints
from jointwave.compare.exact.plane.layer_pulses import fields
from jointwave.compare.exact.plane.oblique_joint import Joint
from jointwave.compare.exact.plane.parallel_joints import coefficients
from jointwave.compare.exact.plane.waves import polarisations

TRAVELS = [("P", 0), ("P", 50), ("P", 130), ("SV", 25), ("SV", -60), ("SV", 200)]

#: Places across the joints: before, between and behind.
PLACES = [(*travel, z) for z in (-11.0, 6.0, 31.0) for travel in TRAVELS]
#: Pulses of SV waves behind a joint have an evanescent part that takes many frequencies.
MANY = [at for at in PLACES if at[0] == "SV" and at[2] > 0 and at != ("SV", -60, 6.0)]
DIP = 0.3


def ricker(t):
    """Return a pulse of 100 Hz and 1 m/s, round-off before 0 s."""
    x = (100 * np.pi * (t - 0.021)) ** 2
    return (1 - 2 * x) * np.exp(-x)


def directed(degrees):
    """Return the direction of travel at an angle from y towards x."""
    return np.array([np.sin(np.radians(degrees)), np.cos(np.radians(degrees))])


def at_joints(rock, joints, wave, pulse, dip, offsets, points, times):
    """Return the fields of a pulse at the origin; wave : its kind and direction."""
    n = turned(dip)[1]
    stack = parallel_joints.stack_of([rock] * (len(joints) + 1), joints, *wave, n, offsets)
    return fields(pulse, stack, np.asarray(points), times)


def at_one_joint(rock, joint, wave, pulse, dip, points, times):
    """Return the fields of a joint through the origin."""
    return at_joints(rock, [joint], wave, pulse, dip, [0.0], points, times)


def differences(values, step, axis=-1):
    """Return the derivative of fourth order, two values shorter at either end."""
    v = np.moveaxis(values, axis, -1)
    slope = (8 * (v[..., 3:-1] - v[..., 1:-3]) - (v[..., 4:] - v[..., :-4])) / (12 * step)
    return np.moveaxis(slope, -1, axis)


def turned(dip):
    """Return the unit vectors along and across a joint."""
    return np.array([[np.cos(dip), np.sin(dip)], [-np.sin(dip), np.cos(dip)]])


@pytest.mark.parametrize("kind, degrees", TRAVELS)
def test_the_joint_holds(rock, kind, degrees):
    """Traction is continuous, and its rate is K [v] + eta [v]', the rates by differences."""
    t, n = turned(DIP)
    joint = Joint(4e9, 2e9, 1e6, 3e6)
    times = np.arange(0, 0.07, 2e-5)
    sides = np.array([7 * t + side * 1e-9 * n for side in (1, -1)])
    found = at_one_joint(rock, joint, (kind, directed(degrees)), ricker, DIP, sides, times)
    xx, yy, xy = np.moveaxis(found.stress, 1, 0)
    traction = np.array([xx * n[0] + xy * n[1], xy * n[0] + yy * n[1]])
    traction = np.einsum("ac,cps->aps", np.array([n, t]), traction)
    jump = np.array([n, t]) @ (found.velocity[0] - found.velocity[1])
    peak = np.abs(traction).max()
    assert np.abs(traction[:, 0] - traction[:, 1]).max() < 1e-8 * peak
    K, eta = np.array([[4e9], [2e9]]), np.array([[1e6], [3e6]])
    off = differences(traction[:, 0], 2e-5) - K * jump[:, 2:-2] - eta * differences(jump, 2e-5)
    assert np.abs(off).max() < 1e-6 * 1000 * peak
    assert np.abs(jump[1]).max() > (0.05 if degrees else -1)


@pytest.mark.parametrize(
    "kind, degrees, z",
    [at if at not in MANY else pytest.param(*at, marks=pytest.mark.slow) for at in PLACES],
)
def test_the_rock_holds(rock, joint, kind, degrees, z):
    """rho v' = div sigma and Hooke's law, derivatives by differences over 0.2 m: (k h)^4 / 30 of
    the shortest waves, in front of, between and behind two joints."""
    t, n = turned(DIP)
    times, h = np.arange(0, 0.05, 4e-5), 0.2
    centre = 4 * t + z * n
    steps = h * np.arange(-2, 3)
    line = [centre + step * axis for axis in np.eye(2) for step in steps]
    joints, wave = [joint, Joint(2e9, 3e9)], (kind, directed(degrees))
    found = at_joints(rock, joints, wave, ricker, DIP, [0.0, 12.0], line, times)
    v, stress = (x.reshape(2, 5, -1, len(times)) for x in (found.velocity, found.stress))
    v_x, v_y = differences(v[0], h, 0)[0], differences(v[1], h, 0)[0]
    s_x, s_y = differences(stress[0], h, 0)[0], differences(stress[1], h, 0)[0]
    force = np.array([s_x[0] + s_y[2], s_x[2] + s_y[1]])
    inertia = rock.density * differences(v[0, 2], 4e-5)
    assert np.abs(force[:, 2:-2] - inertia).max() < 1e-5 * np.abs(inertia).max()
    M, lame = rock.lame + 2 * rock.shear_modulus, rock.lame
    rates = [M * v_x[0] + lame * v_y[1], lame * v_x[0] + M * v_y[1]]
    rates = np.array([*rates, rock.shear_modulus * (v_x[1] + v_y[0])])
    expected = differences(stress[0, 2], 4e-5)
    assert np.abs(rates[:, 2:-2] - expected).max() < 1e-5 * np.abs(expected).max()


@pytest.mark.parametrize("degrees", [25.0, 50.0, 85.0])
@pytest.mark.parametrize("x, y", [(0.0, -10.0), (4.0, 10.0)])
def test_evanescent_waves_by_quadrature(rock, joint, degrees, x, y):
    """A Gaussian SV pulse, whose transform is a Gaussian, summed over real frequencies by 40 times
    50 Gauss points; beyond 35.3 degrees its P waves are evanescent and its tails algebraic."""
    s, t0, times = 1e-3, 0.02, np.linspace(0, 0.04, 201)
    nodes, weights = leggauss(50)
    omega = (112.5 * (nodes + 1 + 2 * np.arange(40)[:, None])).ravel()
    weights = np.tile(112.5 * weights, 40)
    F = s * np.sqrt(2 * np.pi) * np.exp(-((s * omega) ** 2) / 2 + 1j * omega * t0)
    angle = np.radians(degrees)
    p = np.sin(angle) / rock.s_speed
    R_p, R_s, T_p, T_s = coefficients("SV", -angle, omega, rock, [joint], [])
    g = polarisations(rock, -p)
    q_p, q_s = (np.sqrt(1 / c**2 - p**2 + 0j) for c in (rock.p_speed, rock.s_speed))
    fast, slow = (np.exp(1j * omega * (p * x + q * abs(y))) for q in (q_p, q_s))
    if y < 0:
        there = np.exp(1j * omega * (p * x + q_s * y))
        waves = [R_p * fast, R_s * slow, there]
        shapes = [g[1, 0], g[1, 1], g[0, 1]]
    else:
        waves, shapes = [T_p * fast, T_s * slow], [g[0, 0], g[0, 1]]
    spectrum = sum(np.outer(shape, wave) for shape, wave in zip(shapes, waves, strict=True))
    summed = ((spectrum * F * weights) @ np.exp(-1j * np.outer(omega, times))).real / np.pi
    expected = summed * np.array([[-1.0], [1.0]])  # t is -x where n is y

    def gaussian(t):
        return np.exp(-(((t - t0) / s) ** 2) / 2)

    wave = "SV", directed(degrees)
    found = at_one_joint(rock, joint, wave, gaussian, 0.0, [[x, y]], times)
    off = np.abs(found.velocity[0] - expected).max(axis=-1)
    assert (off <= found.velocity_error[0]).all() and off.max() < 1e-9


@pytest.mark.parametrize(
    "kind, degrees", [("P", 40), ("SV", 20), pytest.param("SV", 60, marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("stiffness", [3e7, 3e9])
@pytest.mark.parametrize("shape", ["ricker", "half-sine"])
def test_the_error_is_bounded(monkeypatch, rock, kind, degrees, stiffness, shape):
    """Twice the window and twice the frequencies lie within the bound of the error, 1e-9 of smooth
    pulses. The kinks of half a sine are summed in time but for their evanescent part."""
    times = np.linspace(0, 0.06, 601)
    for module in (inversion, layer_pulses):
        monkeypatch.setattr(module, "STEPS", 1024)

    def half_sine(t):
        return np.sin(np.pi * np.clip(t, 0.0, 0.01) / 0.01)

    pulse, wave = {"ricker": ricker, "half-sine": half_sine}[shape], (kind, directed(degrees))
    joints = [Joint(stiffness, stiffness / 2)] * 2
    points = np.array([[0.0, -7.0], [2.0, 5.0], [-3.0, 30.0]])

    def fields():
        return at_joints(rock, joints, wave, pulse, 0.1, [0.0, 9.0], points, times)

    found = fields()
    monkeypatch.setattr(layer_pulses, "FINE", inversion.Accuracy(8))
    for module in (inversion, layer_pulses):
        monkeypatch.setattr(module, "STEPS", 2048)
    finer = fields()
    for part, error in (("velocity", "velocity_error"), ("stress", "stress_error")):
        off = getattr(found, part) - getattr(finer, part)
        assert (np.sqrt(np.mean(off**2, axis=-1)) <= getattr(found, error)).all()
    assert found.velocity_error.max() < {"ricker": 1e-9, "half-sine": 1e-3}[shape]


def test_incident_alone_without_joints(rock):
    """K = inf: f(t - s.x) along the direction, or turned by a right angle, also ahead of time."""
    times = np.linspace(0, 0.08, 401)
    points = np.array([[9.0, 2.0], [-71.0, -52.0], [-1.0, 28.0]])
    for kind, c in (("P", rock.p_speed), ("SV", rock.s_speed)):
        for degrees in (20, 160, -60):
            d = directed(degrees)
            g = d if kind == "P" else np.array([-d[1], d[0]])
            found = at_one_joint(rock, Joint(np.inf, np.inf), (kind, d), ricker, 0.2, points, times)
            arrival = points @ d / c
            expected = ricker(times - arrival[:, None])[:, None] * g[:, None]
            off = np.abs(found.velocity - expected).max(axis=-1)
            assert (off <= found.velocity_error).all() and off.max() < 1e-9


@pytest.mark.parametrize("kind, degrees", [("P", 40), ("P", -150), ("SV", 10), ("SV", -60)])
def test_many_places_have_the_motion_of_each_to_a_billionth(rock, kind, degrees):
    """In front of, between and behind joints; the last is evanescent, interpolated in its depth."""
    points = np.random.default_rng(1).uniform(-15, 25, (200 if degrees == -60 else 9, 2))
    joints, times = [Joint(4e9, 2e9), Joint(8e9, 2e9, 1e6, 3e6)], np.linspace(0, 0.05, 501)
    wave, n = (kind, directed(degrees)), turned(DIP)[1]
    stack = parallel_joints.stack_of([rock] * 3, joints, *wave, n, [0.0, 6.0])
    every, some = (layer_pulses.motion(ricker, stack, at, times) for at in (points, points[:9:2]))
    for one, other, unit in zip(every, some, (1.0, rock.p_impedance), strict=True):
        assert np.abs(one[:9:2] - other).max() < 2e-9 * unit
        assert np.abs(other).max() > 0.1 * unit
