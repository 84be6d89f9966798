"""Joints that slip: three coefficients, energy, an implicit scheme, rate-and-state friction."""

from itertools import product

import numpy as np
import pytest
from scipy.integrate import trapezoid
from scipy.optimize import brentq

from closed_forms.one_joint import slip_coefficients
from jointwave.cases.errors import UnstableError
from jointwave.cases.histories import Recorded, Ricker, Sine, Step
from jointwave.cases.loads import load_history
from jointwave.cases.material.calibrate import calibrate
from jointwave.compare.exact.bar import images
from jointwave.compare.exact.joint import one_joint, sliding_joint
from jointwave.compare.exact.joint.rate_state_joint import RateJoint, RateStateWave
from jointwave.compare.exact.joint.slip_phases import TOLERANCES, Passed, SlipJoint

Z = 2400.0 * 800.0
OMEGA = 2 * np.pi / 0.01
SHEAR = {
    "load": {"direction": [0.6, 0.0, -0.8]},
    "motion": {"rotation": "none"},
    "ends": {"start": "matched", "end": "matched"},
    "time": {"duration": 0.08},
    "record": {"stress": [5.0, 20.0, 41.3], "velocity": [5.0, 20.0, 41.3]},
}
LAYER = {"y": 20.0, "cohesion": 3e5, "friction_angle": 0.0}


def transmitted(joint, load, times):
    """Return the transmitted stress and its impulse at times."""
    return Passed(joint, Z, load, times[-1], TOLERANCES[0])(times)


@pytest.mark.parametrize(
    "a, T, R, A",
    [(0.5, 0.6253, 0.4159, 0.6603), (0.1, 0.1384, 0.8746, 0.4647), (0.02, 0.0282, 0.9746, 0.2221)],
)
def test_a_harmonic_wave_at_a_joint_rigid_before_slip(a, T, R, A):
    """Miller (1978) to the digits given, and the waveform's own mean squares over a cycle: the sum
    over 4000 samples is off by the kinks alone, of the order (2 pi/4000)^2 = 2.5e-6."""
    assert slip_coefficients(a) == pytest.approx((T, R, A), abs=5.1e-5)
    load, times = Sine(1.0, 0.01, cycles=2), np.linspace(0.0, 0.02, 8001)
    s, _ = transmitted(SlipJoint(0.0, 0.0, a), load, times)
    incident, second = load.value(times), times > 0.01 - 1e-9
    means = [np.mean(x[second][:-1] ** 2) for x in (incident, s, s - incident)]
    ratios = np.sqrt(np.divide(means[1:], means[0]))
    assert ratios == pytest.approx(slip_coefficients(a)[:2], abs=2e-6)


@pytest.mark.parametrize("load", [Sine(1.0, 0.01, 2), Ricker(1.0, 0.01), Step(1.0)])
def test_any_strength_is_integrated_to_the_end(load):
    """Also where a phase begins at the strength, or the load rises to it alone: an implicit scheme
    is off by its step."""
    times = np.linspace(0.0, 0.03, 30_001)
    joints = [(3e-3, 1e-5), *product((0.0, 1e-5, 3e-3, 0.5, 1.0), (0.0, 1e-3))]
    tau, relaxation = np.transpose(joints)
    seen, share = [0 * tau], times[1] / (times[1] + relaxation)
    for value in load.value(times[1:]).tolist():
        new = seen[-1] + share * (value - seen[-1])
        seen.append(np.minimum(np.maximum(new, -tau), tau))
    for (strength, time), expected in zip(joints, np.transpose(seen), strict=True):
        s, _ = transmitted(SlipJoint(0.0, 2 * time / Z, strength), load, times)
        assert np.abs(s[1:] - expected[1:]).max() < (0.06 if time else 1e-10)


def test_a_joint_without_compliance_carries_what_is_left_of_its_cohesion_once_it_has_slipped():
    load, times = Sine(1.0, 0.01, 2), np.linspace(0.0, 0.03, 3001)
    s, _ = transmitted(SlipJoint(0.0, 0.0, 0.7, 0.7, lost=0.4), load, times)
    incident = load.value(times)
    first = np.flatnonzero(np.abs(incident) > 0.7)[0]
    assert s[:first] == pytest.approx(incident[:first], abs=1e-12)
    assert s[first + 1 :] == pytest.approx(np.clip(incident[first + 1 :], -0.3, 0.3), abs=1e-10)


@pytest.mark.parametrize("load", [Sine(1.0, 0.01, 2), Ricker(1.0, 0.01), Step(1.0)])
def test_an_unlimited_joint_is_the_linear_one(load, misfit):
    """The same integral by other nodes: round-off, a step's half value at t = 0 left out."""
    times, K = np.linspace(-1e-3, 0.03, 3101), 0.7 * Z * OMEGA
    found = transmitted(SlipJoint(0.0, 1 / K, 1e100), load, times)
    expected = one_joint.transmitted(one_joint.Joint(0.0, K, 0.0), Z, load, times)
    for a, b in zip(found, expected, strict=True):
        assert misfit(a, b) < 1e-12


@pytest.mark.parametrize("tau", [0.0, 0.1, 0.5, 0.9])
@pytest.mark.parametrize("kappa", [0.3, 3.0, np.inf])
def test_energy_is_transmitted_reflected_stored_or_spent_on_friction(tau, kappa):
    """int sigma_I^2/Z = int sigma_T^2/Z + int sigma_R^2/Z + tau int |slip rate| + s^2/2K, by the
    trapezoid. At each of six onsets the slip rate jumps, and half a step h of tau times it counts
    wrong: 6 h tau (1 - tau)/1.5 T of the whole, at most 2.5e-4."""
    load, times = Sine(1.0, 0.01, 3), np.linspace(0.0, 0.05, 20_001)
    compliance = 0.0 if np.isinf(kappa) else 1 / (kappa * Z * OMEGA)
    s, _ = transmitted(SlipJoint(0.0, compliance, tau), load, times)
    incident = load.value(times)
    slides = np.where((np.abs(s) >= tau) & (incident * s >= s * s), 2 * np.abs(incident - s) / Z, 0)
    spent = trapezoid((s**2 + (s - incident) ** 2) / Z + tau * slides, times)
    stored = compliance * s[-1] ** 2 / 2
    whole = trapezoid(incident**2 / Z, times)
    assert abs(spent + stored - whole) < 2.5e-4 * whole


@pytest.mark.parametrize(
    "load", [Sine(1.0, 0.01, 2), Recorded(np.array([1e-3, 3e-3, 8e-3]), np.array([0.5, -1.0, 2.0]))]
)
def test_an_implicit_scheme_converges_to_it_at_order_one(load):
    """s <- clip((s + h/T sigma_I)/(1 + h/T)): halving the step halves the error."""
    relaxation, tau, errors = 1.5e-3, 0.4, []
    joint = SlipJoint(0.0, 2 * relaxation / Z, tau)
    exact, _ = transmitted(joint, load, np.linspace(0.0, 0.025, 2501))
    for refine in (4, 8, 16):
        times = np.linspace(0.0, 0.025, 2500 * refine + 1)
        h, s, seen = times[1] / relaxation, 0.0, [0.0]
        for value in load.value(times[1:] - 1e-12).tolist():
            s = min(max((s + h * value) / (1 + h), -tau), tau)
            seen.append(s)
        errors.append(np.abs(np.array(seen)[::refine] - exact).mean())
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([1, 1], abs=0.1)


@pytest.mark.parametrize("compliance", [0.0, 1e-9])
def test_a_step_weakens_the_joint_in_closed_form(compliance):
    """(Z / 2)(1 - h / K) S' = q - tau + h S from 0: S = (q - tau) (exp(h t / m) - 1) / h up to D, m
    the factor of S'; with 1/K from when s = q (1 - exp(-t 2K/Z)) reaches tau. Then q - tau_d."""
    q, tau, dynamic, distance = 1e6, 4e5, 1e5, 2e-3
    h, joint = (tau - dynamic) / distance, SlipJoint(0.0, compliance, tau, dynamic, distance)
    t, m = np.linspace(1e-6, 0.01, 5001), Z / 2 * (1 - h * compliance)
    onset = -np.log(1 - tau / q) * Z * compliance / 2
    weakest = onset + m / h * np.log(1 + h * distance / (q - tau))
    s = tau - (q - tau) * np.expm1(h * (t - onset) / m)
    s = np.where(t > weakest, dynamic, s)
    if compliance:
        s = np.where(t < onset, -q * np.expm1(-2 * t / (Z * compliance)), s)
    found, _ = Passed(joint, Z, Step(q), t[-1], 1e-11)(t)
    assert np.abs(found - s).max() < 1e-7 * q


def test_a_joint_that_weakens_and_is_lifted_keeps_the_balance_of_energy():
    """int sigma_I^2/Z = int (sigma_T^2 + sigma_R^2)/Z + 2 int p^2/Z_n + int (|s| - (n + p) w') dS +
    n w: what the pressure sends off on both sides, friction, the way against the prestress n."""
    load, times, n, z_n = Sine(1e6, 0.01, 3), np.linspace(0.0, 0.05, 40_001), 1e6, 5.28e6
    joint = SlipJoint(0.0, 0.0, 6e5, 3e5, 4e-3, 0.6, 0.3, 0.25, 3e-3)
    one = Passed(joint, Z, load, times[-1], 1e-11, z_n)
    (s, impulse), (p, sent) = one(times), one.pressure(times)
    incident, slip = load.value(times), 2 * (load.impulse(times) - impulse) / Z
    way, lifted = np.diff(slip), 2 * np.diff(sent) / z_n
    middle = (s[1:] + s[:-1]) / 2, n + (p[1:] + p[:-1]) / 2
    friction = middle[0] * way - middle[1] * lifted
    assert (friction >= -1e-6 * np.abs(friction).max()).all()
    spent = trapezoid((s**2 + (s - incident) ** 2) / Z + 2 * p**2 / z_n, times)
    spent += friction.sum() + n * lifted.sum()
    whole = trapezoid(incident**2 / Z, times)
    assert abs(spent - whole) < 2.5e-4 * whole
    assert sent[-1] == pytest.approx(z_n / 2 * 0.25 * 3e-3 / 2, rel=1e-9)  # all of the lift


def test_a_joint_that_holds_lets_the_shear_wave_pass(scene, misfit):
    """Half the load enters at the matched start and runs at c_s = 800 m/s along its direction."""
    at = scene(**SHEAR, soft_layers=[LAYER | {"cohesion": 6e5}])
    assert sliding_joint.applies(at)
    p, result, load = calibrate(at), sliding_joint.solve(at), load_history(at)
    front = images.Front(50.0, 800.0, p.shear_impedance, 0.0, 0.0, enters=0.5)
    places, along = SHEAR["record"]["stress"], np.array([0.6, 0.0, -0.8])
    waves = front.waves(load, result.time.values, places, places)
    for name, one in zip(("shear", "velocity", "displacement"), waves, strict=True):
        axes = along[[0, 2]] if name == "shear" else along
        assert misfit(result[name], one[..., None] * axes) < 1e-12


def test_behind_a_joint_that_slips_stress_is_cut_off_at_its_strength(scene):
    """Prestress: tau = c + sigma tan(phi); 0.1 MPa + 0.2 MPa here."""
    layer = {"y": 20.0, "cohesion": 1e5, "friction_angle": 45.0}
    at = scene(**SHEAR, soft_layers=[layer], prestress={"normal": 2e5})
    shear = np.linalg.norm(sliding_joint.solve(at).shear, axis=-1)
    assert shear[1:].max() == pytest.approx(3e5, rel=1e-9)
    assert shear[0].max() == pytest.approx(5e5, rel=1e-3)
    assert (sliding_joint.solve(at).stress == 2e5).all()


@pytest.mark.parametrize("interval", [pytest.param(5e-5, marks=pytest.mark.slow), 4e-3])
def test_the_bound_of_its_error_holds_where_samples_are_far_apart_too(scene, interval):
    """By a record eight times as dense, whose crossings of the strength are all found."""
    layer = {"y": 20.0, "cohesion": 2e5, "friction_angle": 0.0, "spacing_stiffness": 4.375e8}
    tables = SHEAR | {"time": {"duration": 0.04}, "soft_layers": [layer]}
    found, dense = (
        sliding_joint.solve(scene(**tables | {"record": SHEAR["record"] | {"interval": h}}))
        for h in (interval, interval / 8)
    )
    for name in ("shear", "velocity", "displacement"):
        exact = dense[name].values[:, ::8]
        error = np.sqrt(((found[name].values - exact) ** 2).mean(axis=1))
        assert (error <= found[f"{name}_error"].values).all()
        if interval < 1e-3:
            assert found[f"{name}_error"].max() < 1e-9 * np.abs(exact).max()


RATED = RateJoint(1e6, 0.6, 0.01, 0.015, 1e-4, 1e-6, 100.0)


@pytest.mark.parametrize("compliance", [0.0, 1e-10])
def test_steady_slip_of_rate_and_state_friction(compliance):
    """2 (sigma_I - s) / Z is the rate in the end, s that of steady friction at it."""
    times, joint = np.linspace(0.0, 0.03, 301), RATED._replace(compliance=compliance)
    stress, impulse = RateStateWave(joint, Z, Step(1e6), 0.03, 1e-10)(times)

    def left(rate):
        return 1e6 - Z * rate / 2 - 1e6 * (0.6 - 0.005 * np.log(rate / 1e-6))

    rate = brentq(left, 1e-3, 1.0)
    assert stress[-1] == pytest.approx(1e6 - Z * rate / 2, rel=1e-7)
    slip = 2 * (1e6 * times - impulse) / Z
    assert np.diff(slip)[-1] / np.diff(times)[-1] == pytest.approx(rate, rel=1e-6)


@pytest.mark.parametrize("share", [0.8, 2.0])
def test_rate_and_state_friction_that_falls_faster_than_the_joint_unloads(share):
    """At rates far above steady state friction falls by b n / D_c per slip, and slip runs away if K
    is less (Rubin & Ampuero 2005). Otherwise the joint carries no more than the wave brings."""
    joint = RATED._replace(evolution=0.025, state=1e4)
    joint = joint._replace(compliance=share * joint.distance / (joint.evolution * joint.pressure))
    times, of = np.linspace(0.0, 0.03, 301), (joint, Z, Sine(2e6, 0.04), 0.03, 1e-11)
    if share > 1:
        with pytest.raises(UnstableError, match="the joint snaps"):
            RateStateWave(*of)
    else:
        assert np.abs(RateStateWave(*of)(times)[0]).max() <= 2e6


def test_the_impulse_of_rate_and_state_friction_is_that_of_its_stress():
    """Two ways to the same number: S is integrated, the stress follows from ln theta only."""
    times = np.linspace(0.0, 0.03, 60_001)
    for compliance in (0.0, 1e-10):
        joint = RATED._replace(compliance=compliance)
        stress, impulse = RateStateWave(joint, Z, Ricker(1e6, 0.01), 0.03, 1e-11)(times)
        sums = np.append(0.0, np.cumsum((stress[1:] + stress[:-1]) / 2 * np.diff(times)))
        np.testing.assert_allclose(impulse, sums, rtol=0, atol=1e-6 * np.abs(impulse).max())


def test_what_rate_and_state_friction_carries_solves_its_equation():
    """From nothing to a hundred times the strength, and its opposite."""
    incident = np.append(0.0, np.geomspace(1e-6, 1e8, 300))
    carries, slides = np.vectorize(RATED.carries), np.vectorize(RATED.slides)
    for log_state in (-20.0, 0.0, 10.0):
        stress = carries(incident, log_state, Z)
        left = stress + Z / 2 * slides(stress, log_state) - incident
        assert np.abs(left).max() <= 1e-11 * 1e8 and (np.diff(stress) > 0).all()
        assert (carries(-incident, log_state, Z) == -stress).all()


@pytest.mark.parametrize("log_state", [-1e5, 1e5])
@pytest.mark.parametrize("incident", [1e-320, 1e8])
def test_what_it_carries_is_finite_where_a_trial_step_is_too_long(incident, log_state):
    """Integration tries states of no meaning: exponentials beyond all numbers."""
    stress = RATED.carries(incident, log_state, Z)
    assert 0 <= stress <= incident and np.isfinite(RATED.slides(stress, log_state))
